"""The fingerprint of the sources that can change a result: which changes count."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

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


def test_what_does_not_count_exists_or_is_planned():
    assert {name for name in SHOWS_ONLY if not (ROOT / "host" / name).exists()} <= {"lab"}
