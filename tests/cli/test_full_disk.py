"""A disk that is full before a log has begun: the log is named, and nothing is left of it."""

import json
import resource
from pathlib import Path

import pytest


@pytest.fixture
def full_disk():
    """No room for a byte, or for some: a limit on the size of files stands in for it."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)

    def run(kickctl, *arguments, room=0):
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, before[1]))
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


def test_no_ticks_are_promised_that_the_full_disk_did_not_take(kickctl, full_disk):
    record = ("record", "9", "--out", "a.mcap", "--seed", "1")
    status, _, err = full_disk(kickctl, *record, room=60_000)
    assert (status, kickctl("log", "list", ".")[0]) == (1, 0)
    assert "what was recorded until then, to a second, is in a.mcap" in err


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
