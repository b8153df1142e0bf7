"""Modes of the paper's robot: there from any primitive, and back with its own parameters."""

from contextlib import contextmanager

import pytest

from host.client.robot import connect
from host.errors import KickctlError
from host.kicking import modes
from host.kicking.modes import CHAOS, MODES, WALL_TURNER, enter, leave
from host.kicking.primitives import drive
from host.logs.log import Log
from robot.params import Params
from robot.record import STATES

OWN = {"k": 6.0, "tau_s": 0.3}


@contextmanager
def running(seed, **params):
    """A robot on a body that runs, and a log that records it."""
    with connect("sim://?grip=1.7", seed) as robot:
        if params:
            robot.set(**params)
        log = Log(robot.info())
        robot.add_tap(log)
        yield robot, log


def in_force(robot):
    return {name: robot.status()["params"][name] for name in MODES[CHAOS].params}


@pytest.mark.parametrize("primitive", ["backward", "spin-left", "stopped"])
def test_it_goes_into_chaos_from_any_primitive_and_back_by_forward(primitive):
    with running(3, **OWN) as (robot, log):
        assert drive(robot, log, primitive, planned=False)["reached"]
        k = in_force(robot)["k"]  # lower, where only that kept it at rest
        found = enter(robot, log, CHAOS)
        assert found["reached"]
        assert found["own"] == {"k": k, "tau_s": 0.3, "rod_lag_s": 0.0}
        assert in_force(robot) == found["params"] == MODES[CHAOS].params
        assert leave(robot) == (found["own"], True)
        assert drive(robot, log, "forward", planned=False)["reached"]
        assert leave(robot) == ({}, False)


def test_from_mode_to_mode_its_own_parameters_are_not_forgotten():
    with running(5, **OWN) as (robot, log):
        enter(robot, log, CHAOS)
        found = enter(robot, log, WALL_TURNER)
        assert (found["reached"], found["k"], found["k_before"]) == (True, 2.0, 15.0)
        assert set(found["after"].values()) == {"forward"}
        assert found["own"] == {**OWN, "rod_lag_s": 0.0}
        assert in_force(robot) == {**OWN, "rod_lag_s": 0.0, "k": 2.0}
        assert leave(robot) == ({"k": OWN["k"]}, True)
        assert in_force(robot) == {**OWN, "rod_lag_s": 0.0}


def test_where_nobody_knows_what_a_robot_had_it_gets_the_defaults():
    with running(5, **OWN) as (robot, _):
        robot.set(**MODES[CHAOS].params)
        defaults = {name: Params().values()[name] for name in MODES[CHAOS].params}
        assert leave(robot) == (defaults, False)
        robot.set(k=2.0)
        assert leave(robot) == ({}, False)  # that was on purpose


def test_what_was_set_since_stays_and_an_old_file_brings_nothing_back():
    with running(5, **OWN) as (robot, log):
        enter(robot, log, CHAOS)
        robot.set(k=14.0)
        assert leave(robot) == ({"tau_s": OWN["tau_s"], "rod_lag_s": 0.0}, True)
        robot.set(**MODES[WALL_TURNER].params)
        assert leave(robot) == ({}, False)


def test_parameters_that_are_lost_on_the_way_are_no_success(monkeypatch):
    """As after a restart of the robot's program."""

    def lose(robot, _):
        robot.set(k=5.0)
        return {"reached": True}

    monkeypatch.setattr(modes, "_into_chaos", lose)
    with running(5) as (robot, log), pytest.raises(KickctlError, match="lost the parameters"):
        enter(robot, log, CHAOS)


def test_where_no_file_can_be_kept_it_says_so(monkeypatch, tmp_path):
    (tmp_path / "cache").write_text("a file where the folder would be")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(modes, "_into_chaos", lambda *_: {"reached": True})
    with running(5) as (robot, log):
        assert enter(robot, log, CHAOS)["kept"] is False


@pytest.mark.parametrize("error", [KeyboardInterrupt(), KickctlError("no link")])
def test_an_interrupted_way_there_gives_its_own_parameters_back(monkeypatch, error):
    def fail(*_):
        raise error

    monkeypatch.setattr(modes, "_into_chaos", fail)
    with running(5, **OWN) as (robot, log):
        with pytest.raises(type(error)):
            enter(robot, log, CHAOS)
        assert in_force(robot) == {**OWN, "rod_lag_s": 0.0}
        assert STATES[robot.newest.state] == "running"


@pytest.mark.parametrize("text", ["", "[]", "{", '{"mode": "chaos", "own": {"wind": 3}}'])
def test_a_kept_file_that_is_damaged_is_as_none(text):
    with running(5) as (robot, log):
        enter(robot, log, CHAOS)
        place = modes._place(robot)
        place.write_text(text)
        assert leave(robot) == ({"k": 8.0, "tau_s": 0.25, "rod_lag_s": 0.0}, False)
        assert not place.exists()


def test_few_files_are_kept(monkeypatch):
    monkeypatch.setattr(modes, "_KEPT", 2)
    for seed in range(3):
        with running(seed) as (robot, _):
            assert modes._keep(robot, CHAOS, {"k": 3.0})
            folder = modes._place(robot).parent
    assert len(list(folder.iterdir())) == 2
