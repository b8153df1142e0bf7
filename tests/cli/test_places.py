"""Places that cannot be written are refused before anything is done, with exit status 2."""

from pathlib import Path

import pytest

WRITERS = (
    "record 1 --out {}.mcap",
    "log pull --out {}.mcap",
    "log plot log.mcap --out {}.png",
    "log film log.mcap --out {}.gif",
    "log export log.mcap --out {}.csv",
    "log recover log.mcap --out {}.mcap",
    "body car --time 0.1 --model {}.xml",
)


@pytest.mark.parametrize("line", WRITERS)
def test_a_folder_that_is_not_there_is_wrong_use(kickctl, line):
    kickctl("record", "0.5", "--seed", "1", "--out", "log.mcap")
    status, _, err = kickctl(*line.format("nowhere/it").split())
    assert status == 2
    assert "folder" in err
    assert [path.name for path in Path().iterdir() if path.name != "token"] == ["log.mcap"]


@pytest.mark.parametrize("line", WRITERS)
def test_a_name_is_not_empty(kickctl, line):
    words = ["" if "{}" in word else word for word in line.split()]
    status, _, err = kickctl(*words)
    assert status == 2
    assert "cannot be empty" in err


@pytest.mark.parametrize(
    "line",
    [
        *(line.partition("{}")[0] + "{}" for line in WRITERS),
        "body car --out {}",
        "theory hopf --out {}",
        "experiment starts --out {}",
        "body car --film {}",
        "rods --out {}",
        "reproduce --out {}",
        "foxglove --layout {}",
    ],
)
def test_a_dash_is_no_name(kickctl, line):
    """Who types it means standard output, and found a file named '-'."""
    status, answer, err = kickctl(*line.format("-").split())
    assert (status, answer) == (2, "")
    assert "cannot be '-', which would be a file of that name" in err
    assert not Path("-").exists()


def test_a_scheduler_that_is_none_is_refused_before_the_run_has_a_folder(kickctl):
    status, _, err = kickctl("theory", "hopf", "--scheduler", "nonsense")
    assert status == 2
    assert "'nonsense' is no address of a Dask scheduler" in err
    assert not Path("results").exists()
