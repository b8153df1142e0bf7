"""kickctl run in this process or as one of its own, in an empty folder."""

import os
import subprocess
import sys
from contextlib import contextmanager

import pytest
from matplotlib.figure import Figure

from host.cli import main
from tests.lint.sources import ROOT
from tests.small_figures import small_figures

DRAW = Figure.draw


@contextmanager
def empty_figures():
    """Figures are small and empty within the context.

    A verb answers whether or not its figure can be drawn, so most tests would not notice.
    """
    with small_figures(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "draw", lambda figure, renderer: None)
        yield


@pytest.fixture
def figures():
    """Figures are small and empty: a module whose subject they are has a `figures` too."""
    with empty_figures():
        yield


@pytest.fixture
def drawn(figures):
    """Figures are not empty: for tests that fail where nothing can be drawn."""
    # Undone before `figures`, which `monkeypatch` would not be.
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Figure, "draw", DRAW)
        yield


@pytest.fixture
def kickctl(capsys, tmp_path, monkeypatch, figures):
    """Run kickctl in an empty folder: (exit status, standard output, standard error)."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    monkeypatch.delenv("KICK_BRICK", raising=False)

    def run(*arguments):
        try:
            status = main(arguments)
        except SystemExit as leaving:
            status = leaving.code
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    run.folder = tmp_path
    return run


KICKCTL = f"{sys.executable} -m host"


@pytest.fixture
def shell(tmp_path):
    """Run a line of shell with kickctl in it: (exit status, standard output, standard error)."""

    def run(line, **environment):
        done = subprocess.run(
            ["sh", "-c", line.replace("kickctl", KICKCTL)],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        assert "Traceback" not in done.stdout + done.stderr
        return done.returncode, done.stdout, done.stderr

    return run
