"""The wheel and the source distribution hold everything."""

import tarfile

import pytest

import robot
from tests.package.conftest import ROOT, files_of

# All of these on one worker, as each worker would build the packages again.
pytestmark = pytest.mark.xdist_group("package")

PACKAGES = [path.parent.name for path in ROOT.glob("*/py.typed")]
# What lies in the folders of the packages and belongs into the wheel.
WANTED = (
    *(f"{package}/**/*.py" for package in PACKAGES),
    "host/*.md",
    "robot/*.md",
    "robot/service/*",
    "sim_motor/**/*.toml",
    "sim_motor/**/*.xml",
    "sim_motor/**/*.md",
    "*/py.typed",
    "host/deploy.sh",
    "host/deploy/*.sh",
    "host/lab/page/**/*.*",
)


def wanted():
    return {
        str(path.relative_to(ROOT))
        for package in PACKAGES
        for pattern in WANTED
        for path in ROOT.glob(pattern)
        if path.relative_to(ROOT).parts[0] == package and path.is_file()
    }


def test_the_wheel_has_all_files_of_the_packages(wheel):
    assert set(PACKAGES) == {"kickctl", "host", "sim_motor", "robot"}
    content = files_of(wheel)
    assert wanted() - set(content) == set()
    assert {"robot/service/brick.sh", "robot/PROTOCOL.md", "host/py.typed"} <= set(content)
    for name in wanted():
        assert content[name] == (ROOT / name).read_bytes(), name


def test_the_wheel_has_the_script_itself_and_no_tests(wheel):
    content = files_of(wheel)
    assert content["host/deploy.sh"] == (ROOT / "deploy.sh").read_bytes()
    assert content["host/LETTERS.md"] == (ROOT / "docs" / "model.md").read_bytes()
    tops = {name.partition("/")[0] for name in content}
    assert tops == {*PACKAGES, f"kickctl-{robot.__version__}.dist-info"}


def test_the_source_distribution_has_what_make_and_the_tests_need(sdist):
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    top = {"README.md", "CHANGELOG.md", "CITATION.cff", "LICENSE", "Makefile", "pyproject.toml"}
    assert {*top, "deploy.sh", "requirements.lock", ".ci/run", "docs/kick.png"} <= names
    assert wanted() <= names
    assert "tests/package/test_distribution.py" in names


def test_both_ways_lead_to_the_same_wheel(wheel, wheel_of_sdist):
    assert wheel.name == wheel_of_sdist.name
    assert files_of(wheel) == files_of(wheel_of_sdist)


def test_one_version_stands_everywhere(wheel):
    metadata = files_of(wheel)[f"kickctl-{robot.__version__}.dist-info/METADATA"].decode()
    assert f"\nVersion: {robot.__version__}\n" in metadata
    assert f"\nversion: {robot.__version__}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
    assert f"\n## [{robot.__version__}] - 20" in (ROOT / "CHANGELOG.md").read_text("utf-8")
