"""A disk that is full before a log has begun: the log is named, and nothing is left of it."""

import json
import resource
from pathlib import Path

import pytest


@pytest.fixture
def full_disk():
    """No room for a byte: a limit on the size of files stands in for it."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)

    def run(kickctl, *arguments):
        resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
        try:
            return kickctl(*arguments)
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)

    return run


@pytest.mark.parametrize(
    "line", ["kick --mode phase", "drive forward", "demo", "record 1", "log pull"]
)
def test_the_log_is_named_and_not_left_empty(kickctl, full_disk, line):
    (kickctl.folder / "token").write_text("0" * 32)
    status, out, err = full_disk(kickctl, *line.split(), "--seed", "1", "--json")
    error = json.loads(out)["error"]
    assert status == error["status"] == 1
    assert error["message"].startswith("logs/")
    assert "cannot be written" in error["message"]
    assert "see `ulimit -f`" in err
    assert ("no kick was sent" in err) is (line.split()[0] in ("kick", "drive", "demo"))
    assert list(Path("logs").iterdir()) == []


@pytest.mark.parametrize("link", [False, True])
def test_a_file_in_the_place_of_the_folder_of_logs_is_named(kickctl, link):
    if link:
        Path("logs").symlink_to("nowhere")
    else:
        Path("logs").touch()
    status, _, err = kickctl("kick", "--mode", "phase", "--seed", "1")
    assert status == 2
    assert ("logs is a link that leads nowhere here" in err) is link
    assert ("logs is a file here" in err) is not link
    assert "rename or remove it" in err
    assert "no kick was sent" in err
