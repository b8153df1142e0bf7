"""The fingerprint of the sources that can change a result: which changes count."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from host.util import provenance
from host.util.provenance import SHOWS_ONLY, sources

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """A copy of the three packages, far from any checkout."""
    folder = tmp_path_factory.mktemp("copy")
    for name in ("robot", "sim_motor", "host"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


def sources_of(folder, meanwhile="pass"):
    """The fingerprint that a process has which imports the packages in this folder."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    script = f"from host.util.provenance import sources; {meanwhile}; print(sources())"
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_a_copy_elsewhere_has_the_same(copy):
    assert sources_of(copy) == sources()
    assert len(sources()) == 16


@pytest.mark.parametrize(
    ("file", "counts"),
    [
        ("robot/kicks.py", True),
        ("sim_motor/motors.toml", True),
        ("sim_motor/bodies/scenes/box.xml", True),
        ("host/errors.py", True),
        ("host/runs/folder.py", True),
        ("host/new_package/__init__.py", True),
        ("host/new_module.py", True),
        ("host/__main__.py", False),
        ("host/cli.py", False),
        ("host/commands/kick.py", False),
        ("host/figures/style.py", False),
        ("host/films/movie.py", False),
        ("host/lab/server.py", False),
        ("host/.ipynb_checkpoints/errors-checkpoint.py", False),
        ("robot/README.md", False),
    ],
)
def test_what_computes_counts_and_what_only_shows_does_not(copy, file, counts):
    path = copy / file
    before = path.read_bytes() if path.exists() else None
    path.parent.mkdir(exist_ok=True)
    with path.open("a", encoding="utf-8") as out:
        out.write("\n# changed\n")
    try:
        assert (sources_of(copy) != sources()) is counts
    finally:
        path.unlink() if before is None else path.write_bytes(before)


def test_sources_that_change_later_are_not_those_of_what_was_loaded(copy):
    path = copy / "robot" / "kicks.py"
    before = path.read_bytes()
    assert sources_of(copy, f"open({str(path)!r}, 'a').write('# changed')") == sources()
    path.write_bytes(before)


def test_sources_are_unchanged_until_what_they_say_is_another(copy):
    path = copy / "robot" / "kicks.py"
    before = path.read_bytes()
    steps = [
        "",
        "os.utime(path)",
        "open(path, 'a').write('# changed')",
        f"open(path, 'wb').write({before!r})",
        "open(path + '.py', 'w').close()",
        "os.remove(path + '.py')",
    ]
    asked = "\n".join(f"{step}\nanswers.append(provenance.unchanged())" for step in steps)
    script = f"""
import os
from host.util import provenance
path, answers = {str(path)!r}, []
{asked}
print(answers)
"""
    environment = {**os.environ, "PYTHONPATH": str(copy)}
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=True
    )
    assert done.stdout == "[True, True, False, True, False, True]\n"


def test_the_commit_is_found_without_a_lock_on_the_users_index(tmp_path, monkeypatch):
    """A killed kickctl would leave the lock, and git would refuse every commit."""

    def git(*words):
        subprocess.run(["git", "-C", tmp_path, *words], check=True, capture_output=True)

    source = tmp_path / "source.py"
    source.write_text("x = 1\n")
    git("init")
    git("add", "source.py")
    git("-c", "user.name=anna", "-c", "user.email=anna@lab", "commit", "-m", "first")
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "host" / "util" / "provenance.py"))
    os.utime(source, (1, 1))  # the index would have to be written to know that nothing has changed
    index = (tmp_path / ".git" / "index").read_bytes()
    clean = provenance.commit.__wrapped__()
    source.write_text("x = 2\n")
    assert provenance.commit.__wrapped__() == clean + "+" != "+"
    assert (tmp_path / ".git" / "index").read_bytes() == index


def test_what_does_not_count_exists_or_is_planned():
    assert {name for name in SHOWS_ONLY if not (ROOT / "host" / name).exists()} <= {"lab"}
