"""What kickctl needs comes from its metadata; hints fit the way it was installed."""

import sys
from pathlib import Path

import pytest

from host.commands import doctor
from host.util import installation, requirements

KICKCTL = """\
Metadata-Version: 2.4
Name: kickctl
Version: 1
Provides-Extra: bodies
Requires-Dist: present>=1.0
Requires-Dist: absent
Requires-Dist: elsewhere; sys_platform == "plan9"
Requires-Dist: engine[pictures]>=4; extra == "bodies"
"""


def describe(folder, name, text):
    """Have importlib.metadata find a package of this name."""
    info = folder / f"{name}-1.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(text, encoding="utf-8")


@pytest.fixture
def packages(tmp_path, monkeypatch):
    """A folder that is searched for packages first."""
    monkeypatch.setattr(sys, "path", [str(tmp_path), *sys.path])
    describe(tmp_path, "kickctl", KICKCTL)
    return tmp_path


def package(name, version, *requires):
    lines = ["Metadata-Version: 2.4", f"Name: {name}", f"Version: {version}"]
    return "\n".join([*lines, *(f"Requires-Dist: {text}" for text in requires), ""])


def test_what_is_not_installed_is_missing_and_markers_count(packages):
    assert requirements.missing()[""] == ["absent", "present>=1.0"]
    describe(packages, "present", package("present", "1.2"))
    assert requirements.missing()[""] == ["absent"]


def test_a_version_that_is_too_old_is_missing(packages):
    describe(packages, "present", package("present", "0.9"))
    assert "present>=1.0" in requirements.missing()[""]


def test_an_extra_lacks_its_own_requirements_and_theirs(packages):
    assert requirements.extras() == ["bodies"]
    assert requirements.missing()["bodies"] == ["engine>=4"]
    describe(packages, "engine", package("engine", "4.1", 'drawing; extra == "pictures"'))
    assert requirements.missing()["bodies"] == ["drawing"]
    describe(packages, "drawing", package("drawing", "1", "engine"))  # a circle ends
    assert requirements.missing()["bodies"] == []


def test_every_library_of_this_environment_is_there():
    assert requirements.missing()[""] == []
    assert {"bodies", "cluster", "gym"} <= set(requirements.extras())


def test_in_a_checkout_make_and_the_script_are_named(monkeypatch):
    assert installation.is_checkout()
    assert installation.deploy_command() == str(installation.ROOT / "deploy.sh")
    monkeypatch.chdir(installation.ROOT)
    assert installation.deploy_command() == "./deploy.sh"
    assert installation.install_command("bodies") == "make setup"


def test_installed_the_verb_and_pip_are_named(monkeypatch, tmp_path):
    monkeypatch.setattr(installation, "ROOT", tmp_path)
    monkeypatch.setattr(installation.shutil, "which", lambda name: None)
    monkeypatch.setattr(sys, "argv", ["/some where/kickctl"])
    assert installation.deploy_command() == "'/some where/kickctl' deploy"
    monkeypatch.setattr(sys, "argv", ["/some where/host/__main__.py"])
    assert installation.deploy_command() == f"{sys.executable} -m kickctl deploy"
    monkeypatch.setattr(installation.shutil, "which", lambda name: f"/usr/bin/{name}")
    assert installation.deploy_command() == "kickctl deploy"
    assert installation.install_command("gym") == f"{sys.executable} -m pip install 'kickctl[gym]'"


def test_the_script_is_there_and_is_the_one_at_the_top():
    script = Path(installation.ROOT, "deploy.sh")
    assert installation.DEPLOY_SCRIPT.read_bytes() == script.read_bytes()


def libraries():
    """What doctor finds about libraries: (found, remedy) by name."""
    return {finding.what: (finding.found, finding.remedy) for finding in doctor._libraries()}


def test_doctor_names_what_is_missing_and_how_to_get_it(packages):
    install = installation.install_command()
    found = libraries()
    assert found["libraries"] == ("missing: absent, present>=1.0", f"install them: {install}")
    words, remedy = found["extra bodies"]
    assert "engine>=4" in words
    assert installation.install_command("bodies") in words
    assert remedy == ""  # nobody has to have an extra


def test_doctor_of_a_folder_that_was_never_installed_says_so(monkeypatch):
    monkeypatch.setattr(requirements, "PACKAGE", "of-this-name-there-is-none")
    ((what, (found, remedy)),) = libraries().items()
    assert what == "libraries"
    assert "without being installed" in found
    assert installation.install_command() in remedy
