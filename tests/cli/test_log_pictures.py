"""kickctl log plot and film: pictures of what was logged."""

import json
from pathlib import Path

import pytest
from PIL import Image

from host.client.robot import connect
from host.kicking.outcome import kick_and_watch, wait_settled
from host.logs.log import Log


@pytest.fixture
def figures():
    """They are as users see them."""


def files():
    return sorted(path for path in Path().rglob("*") if path.parts[0] != "cache")


@pytest.fixture
def log(kickctl):
    """The log of a kick."""
    with connect("sim://", 1) as robot, robot.recording() as log:
        wait_settled(robot)
        kick_and_watch(robot, log, "phase", ticks=4)
    return log.save("kick.mcap")


def test_a_plot_is_beside_its_log_and_as_large_as_a_projector_wants(kickctl, log):
    status, answer, _ = kickctl("log", "plot", str(log), "--json")
    facts = json.loads(answer)
    assert (status, facts["kicks"], facts["stops"]) == (0, 1, 0)
    assert facts["figure"] == str(log.with_name(log.stem + "-plot.png"))
    with Image.open(facts["figure"]) as picture:
        assert picture.width == 1920
    assert kickctl("log", "plot", str(log), "--out", "a.svg")[0] == 0
    assert "<svg" in Path("a.svg").read_text()


def test_a_film_lasts_as_long_as_the_log_and_its_pictures_differ(kickctl, log):
    line = ("log", "film", str(log), "--begin", "1", "--seconds", "0.2")
    status, answer, _ = kickctl(*line, "--slower", "2", "--out", "a.gif", "--json")
    assert (status, json.loads(answer)["seconds"]) == (0, pytest.approx(0.4))
    with Image.open("a.gif") as film:
        assert film.n_frames == 10
        first = film.convert("RGB").tobytes()
        film.seek(film.n_frames - 1)
        assert film.convert("RGB").tobytes() != first


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("plot", "--out", "a.txt"), ".png, .svg or .pdf"),
        (("film", "--out", "a.avi"), ".mp4 or .gif"),
        (("film", "--seconds", "nan"), "seconds cannot be nan"),
        (("film", "--slower", "0"), "slower cannot be 0"),
        (("film", "--slower", "1000"), "--seconds"),
        (("film", "--begin", "1e5"), "nothing to film"),
    ],
)
def test_pictures_that_cannot_be_are_refused_and_leave_nothing(kickctl, log, words, reason):
    before = files()
    status, answer, err = kickctl("log", words[0], str(log), *words[1:])
    assert (status in (1, 2), answer) == (True, "")
    assert reason in err
    assert files() == before


def test_a_log_without_ticks_has_no_picture(kickctl):
    path = Log().save("empty.mcap")
    for action in ("plot", "film"):
        status, _, err = kickctl("log", action, str(path))
        assert status == 1
        assert "holds no ticks" in err
