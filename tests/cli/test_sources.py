"""Changed code computes its results again; the same code resumes."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOPF = ("theory", "hopf")


@pytest.fixture
def copy(tmp_path):
    """A function that runs kickctl from a copy of the sources, and the copy's folder."""
    folder = tmp_path / "copy"
    for name in ("robot", "sim_motor", "host"):
        shutil.copytree(ROOT / name, folder / name)
    # A run is done without its figure, which takes most of the time.
    (folder / "host" / "figures" / "__init__.py").write_text("raise ImportError\n")

    def kickctl(*arguments):
        done = subprocess.run(
            [sys.executable, "-m", "host", *arguments],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(folder)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stderr

    return kickctl, folder


def change(path, old, new):
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    before_ns = path.stat().st_mtime_ns
    path.write_text(text.replace(old, new), encoding="utf-8")
    # Python takes its byte code for that of a file of the same size and the same second.
    os.utime(path, ns=(before_ns, before_ns + 2 * 10**9))


def test_changed_code_computes_again_and_the_same_code_resumes(copy):
    kickctl, folder = copy
    assert "0 of 3 cells complete" in kickctl(*HOPF)
    with (folder / "host" / "figures" / "style.py").open("a", encoding="utf-8") as file:
        file.write("# A figure's look changes no number.\n")
    assert "3 of 3 cells complete" in kickctl(*HOPF)
    shift = (folder / "robot" / "kicks.py", "DEFAULT_SHIFT_RAD = 3 * pi / 4\n")
    change(*shift, "DEFAULT_SHIFT_RAD = 3 * pi / 5\n")
    assert "0 of 3 cells complete" in kickctl(*HOPF)
    change(shift[0], "DEFAULT_SHIFT_RAD = 3 * pi / 5\n", shift[1])
    assert "3 of 3 cells complete" in kickctl(*HOPF)
