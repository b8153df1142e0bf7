"""kickctl run in this process, in an empty folder."""

import pytest

from host.cli import main


@pytest.fixture
def kickctl(capsys, tmp_path, monkeypatch):
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
