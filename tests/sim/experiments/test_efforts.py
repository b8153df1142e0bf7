"""How long experiments take on a robot: the estimates beside the simulated robot's own time."""

from collections import Counter

import pytest

from host.client.robot import connect
from host.errors import WrongUse
from host.experiments.efforts import EFFORTS, QUICK_MINUTES, in_words, quick_minutes, size
from host.experiments.registry import ROBOT
from host.logs.log import Log
from host.perform import robots
from host.perform.catalogue import find
from host.runs.contract import Setting
from host.runs.registry import complete_options

# A size at which each takes a short time to compute.
SMALL = {
    "primitives": 1,
    "timeline": 1,
    "reliability": 1,
    "kick-map": 36,
    "bifurcation": 5,
    "wall": 4,
    "chaos": 1.0,
    "starts": 4,
    "predictions": 5,
    "calibrate": 60.0,
}


def seconds_of(experiment, cell, setting, name):
    """How much of the robot's time a cell takes, s."""
    uri = "sim://?walls=2.0" if name == "wall" else "sim://"
    with connect(uri, setting.seed_of(cell)) as robot:
        before = robot.link.now()
        robots._set(robot, robots.PAPER)
        log = Log(robot.info())
        robot.add_tap(log)
        experiment.trial(cell, robot, log, setting)
        return robot.link.now() - before


def kind_of(cell):
    return cell.get("part")


def test_each_experiment_on_a_robot_has_an_effort():
    assert set(EFFORTS) == set(ROBOT) == set(SMALL)
    for name, effort in EFFORTS.items():
        assert effort.option in [option.name for option in ROBOT[name].options]


@pytest.mark.parametrize("name", sorted(SMALL))
def test_the_estimate_is_what_the_run_takes(name):
    """Up to two cells of each part are done, and stand for all of their part."""
    found = find(name)
    options = complete_options(name, found.entry, {EFFORTS[name].option: SMALL[name]})
    setting = Setting(1, options)
    cells = found.work.cells(options, batch=False)
    total = 0.0
    for kind, number in Counter(map(kind_of, cells)).items():
        own = [cell for cell in cells if kind_of(cell) == kind]
        tried = own[:: -(-len(own) // 2)]
        times = [seconds_of(found.work, cell, setting, name) for cell in tried]
        total += sum(times) / len(times) * number
    assert total == pytest.approx(EFFORTS[name].seconds(options), rel=0.3)


@pytest.mark.parametrize("name", sorted(EFFORTS))
def test_what_is_sized_to_a_time_fits_into_it_and_one_more_would_not(name):
    effort, entry = EFFORTS[name], ROBOT[name]
    minutes = quick_minutes(name, entry) + 10
    sized = size(name, entry, minutes)
    options = complete_options(name, entry, sized)
    assert effort.seconds(options) <= 60 * minutes + 1e-6
    assert (
        effort.seconds({**options, effort.option: options[effort.option] + effort.round})
        > 60 * minutes
    )


def test_a_quick_run_takes_some_minutes_or_as_long_as_it_must():
    assert quick_minutes("starts", ROBOT["starts"]) == QUICK_MINUTES
    assert size("starts", ROBOT["starts"], QUICK_MINUTES) == {"starts": 90}
    shortest = quick_minutes("bifurcation", ROBOT["bifurcation"])
    assert 7 < shortest < 9
    assert size("bifurcation", ROBOT["bifurcation"], shortest)["points"] == 5


def test_a_time_that_is_too_short_for_all_repetitions_leaves_some_out():
    entry = ROBOT["bifurcation"]
    assert size("bifurcation", entry, 60.0) == {"points": 49}
    assert size("bifurcation", entry, 10.0) == {"points": 20, "rounds": 1, "branch": 0}
    wished = {"branch": 2}
    assert size("bifurcation", entry, 15.0, wished) == {"points": 33, "rounds": 1}
    assert quick_minutes("bifurcation", entry, wished) > quick_minutes("bifurcation", entry)


def test_what_cannot_be_as_short_is_refused_with_the_time_that_it_takes():
    with pytest.raises(WrongUse, match="points = 5 takes 7 minutes on a robot"):
        size("bifurcation", ROBOT["bifurcation"], 7.0)


def test_more_time_than_an_option_can_take_gives_the_most():
    assert size("calibrate", ROBOT["calibrate"], 10_000.0) == {"seconds": 3600.0}


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (1.0, "5 s"),
        (61.0, "60 s"),
        (100.0, "2 minutes"),
        (4550.0, "76 minutes"),
        (580_000.0, "7 days"),
        (36_000.0, "10 hours"),
    ],
)
def test_an_estimate_in_words(seconds, words):
    assert in_words(seconds) == words
