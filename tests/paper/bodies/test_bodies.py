"""The experiments on simulated cars and trains: what their numbers mean, on made-up motions.

And short runs of the real ones.
"""

import importlib
import json
import operator
import os
import sys
import time
from math import pi
from multiprocessing import active_children

import numpy as np
import pytest

from host.errors import NotDone, WrongUse
from host.experiments.bodies import (
    car_route,
    train_fault,
    train_kick,
    train_start,
    train_wall,
    train_wiggle,
)
from host.experiments.bodies.simulation import BodyRun, build_pushed_train
from host.experiments.registry import BODIES, TABLE
from host.perform import reproduce
from host.perform.run import perform
from host.runs import processes
from host.runs.claims import Claim
from host.runs.contract import Setting
from host.util.installation import install_command
from sim_motor.bodies.measures import Course
from sim_motor.bodies.presets import preset

SHORT = {"seconds": 3.0, "seeds": 2, "trials": 1, "goals": 1, "preset": "paper"}


def setting(name, seed=1, **options):
    return Setting(
        seed,
        {
            option.name: options.get(option.name, SHORT[option.name])
            for option in TABLE[name].options
        },
    )


def module(name):
    return importlib.import_module("host.experiments.bodies." + name.replace("-", "_"))


def plain(data):
    return json.loads(json.dumps(data, allow_nan=False))


# All.


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 1})


@pytest.mark.parametrize("name", BODIES)
def test_cells_are_plain_data_and_no_two_are_the_same(name):
    cells = module(name).cells(setting(name).options, batch=True)
    assert plain(cells) == cells
    assert len({json.dumps(cell, sort_keys=True) for cell in cells}) == len(cells)


# What a train learns takes longer: tests/sim/test_environment.py.
@pytest.mark.parametrize("name", [name for name in BODIES if name != "train-goal"])
def test_a_short_run_ends_in_numbers_and_a_figure(name, monkeypatch):
    """One cell of each kind of row is run, and stands for all others."""
    monkeypatch.setattr(train_kick, "START_S", 0.5)
    monkeypatch.setattr(train_kick, "WATCH_S", 0.5)
    experiment, chosen = module(name), setting(name)
    cells = experiment.cells(chosen.options, batch=True)
    fields = dict.fromkeys(tuple(sorted(cell)) + (cell.get("part"),) for cell in cells)
    shown = getattr(experiment, "SHOWN", ())
    rows = []
    for kind in fields:
        of_kind = [cell for cell in cells if (*sorted(cell), cell.get("part")) == kind]
        first = next(
            (
                cell
                for cell in of_kind
                if {key: cell.get(key) for key in (shown[0] if shown else ())} in shown
            ),
            of_kind[0],
        )
        made_rows = experiment.simulate(first, chosen)
        assert plain(made_rows) == made_rows
        rows += [{**cell, **row} for cell in of_kind for row in made_rows]
    findings = experiment.report(rows, chosen)
    assert [claim.id for claim in findings.claims] == list(TABLE[name].claims)
    assert plain(findings.numbers) == findings.numbers
    figure = importlib.import_module("host.figures.bodies." + name.replace("-", "_")).draw(
        rows, findings
    )
    figure.canvas.draw()
    assert all(axes.has_data() for axes in figure.axes)


def test_the_same_seed_is_the_same_train_bit_for_bit():
    cell = {"preset": "paper", "number": 3}
    first = train_start.simulate(cell, setting("train-start"))
    assert train_start.simulate(cell, setting("train-start")) == first
    assert train_start.simulate(cell, setting("train-start", seed=2)) != first


@pytest.mark.parametrize("name", ["car-slope", "train-kick"])
def test_a_robot_is_refused_in_words_before_anything_runs(name, tmp_path):
    with pytest.raises(WrongUse, match="simulated cars"):
        perform(name, "tcp://127.0.0.1:1", out=tmp_path)
    assert list(tmp_path.glob("*-*")) == []


def test_without_mujoco_its_extra_is_named_before_anything_runs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(WrongUse) as refused:
        perform("train-start", out=tmp_path)
    assert install_command("bodies") in refused.value.hint
    assert list(tmp_path.glob("*-*")) == []


def test_the_claims_come_after_those_of_robot_and_model():
    known = reproduce.known()
    assert known[-3:] == ["B1", "B2", "B3"]
    assert known[0] == "R1"


@pytest.mark.parametrize(
    ("uri", "library", "reason"),
    [("tcp://robot:5425", True, "by name"), ("sim://", False, "mujoco")],
)
def test_reproduce_skips_the_bodies_on_a_robot_and_without_mujoco(
    monkeypatch, tmp_path, uri, library, reason
):
    def perform(name, *_, **__):
        assert name not in BODIES
        claims = [
            Claim(number, "", "", 1.0, "1", None, holds=True).as_dict()
            for number in known
            if number in entry(name).claims
        ]
        return {"claims": claims, "seed": 1, "version": ""}

    def entry(name):
        return {**TABLE, **reproduce.STUDIES}[name]

    known = reproduce.known()
    monkeypatch.setattr(reproduce, "find_spec", lambda module: library or None)
    monkeypatch.setattr(reproduce, "perform", perform)
    monkeypatch.setattr(reproduce.report, "write", lambda path, *_: path)
    done = reproduce.reproduce(uri, out=tmp_path)
    assert all(reason in done.skipped[number] for number in ("B1", "B2", "B3"))


# Processes.


def test_cells_side_by_side_come_to_the_same_as_one_by_one():
    found = dict(processes.side_by_side(operator.call, [abs, float, str], -3))
    assert found == {abs: 3, float: -3.0, str: "-3"}
    assert dict(processes.side_by_side(operator.call, [abs], -3)) == {abs: 3}


def test_work_that_is_broken_off_leaves_no_process_behind():
    """What sleeps for an hour is not waited for."""
    work = processes.side_by_side(operator.call, [float, time.sleep], 3600.0)
    assert next(work) == (float, 3600.0)
    left = active_children()
    work.close()
    for process in left:
        process.join(30)
    assert [process.is_alive() for process in left] == [False] * 2


def test_a_process_that_dies_is_told_in_words():
    with pytest.raises(NotDone, match="ended from outside"):
        list(processes.side_by_side(operator.call, [os._exit, float], 3))


def test_an_error_in_a_cell_is_that_error_here():
    with pytest.raises(ZeroDivisionError):
        list(processes.side_by_side(operator.truediv, [1, 2], 0))


# What is measured.


def ran(omega, x=0.0, y=0.0, dt_s=0.005):
    """A run whose wheels turned at omega (times, wheels), and whose middle was at x, y."""
    omega = np.asarray(omega, dtype=float)
    t = np.arange(len(omega)) * dt_s
    centre = np.stack(
        [np.broadcast_to(x, t.shape), np.broadcast_to(y, t.shape), np.zeros_like(t)], axis=1
    )
    return BodyRun(Course(t, omega, centre, np.zeros_like(t)), np.zeros((len(t), 8)), centre, None)


def shuttling(reversals, leg=600, wheels=10):
    ways = np.repeat((-1.0) ** np.arange(reversals + 1), leg)
    return np.repeat(40.0 * ways[:, None], wheels, axis=1)


def test_a_train_that_shuttles_is_told_from_one_that_is_stuck():
    omega = shuttling(3)
    away = np.cumsum(omega[:, 0]) * 0.005 * 0.04
    row = train_wall.summarize_run(ran(omega, x=away))
    assert row["reversals_s"] == pytest.approx([3.0, 6.0, 9.0], abs=0.01)
    assert (row["whole"], row["ended"]) == (3, train_wall.RUNS)
    still = train_wall.summarize_run(
        ran(np.full((2400, 10), 40.0), x=3.8)
    )  # its wheels slip at the wall
    assert (still["reversals_s"], still["ended"]) == ([], train_wall.STUCK)


def test_a_reversal_of_some_wheels_is_not_one_of_the_whole_train():
    omega = shuttling(1)
    omega[600:, :2] *= -1
    row = train_wall.summarize_run(ran(omega, x=np.linspace(0, 5, 1200)))
    assert (len(row["reversals_s"]), row["whole"]) == (1, 0)


def test_a_wave_that_travels_has_its_frequency_its_lag_and_its_amplitudes():
    t = np.arange(6000) * 0.005
    waves = np.stack(
        [
            amplitude * np.cos(2 * pi * 3.8 * t - joint * 2.2)
            for joint, amplitude in enumerate((5, 10, 15, 20))
        ],
        axis=1,
    )
    rows = train_wiggle.measure_wiggling(waves, 0.005)
    assert [row["std_deg"] for row in rows] == pytest.approx(
        np.array((5, 10, 15, 20)) / np.sqrt(2), rel=0.01
    )
    assert [row["lag_deg"] for row in rows[1:]] == pytest.approx([-np.degrees(2.2)] * 3, abs=1.0)
    assert rows[0]["lag_deg"] is None
    assert [row["hz"] for row in rows] == pytest.approx([3.8] * 4, abs=0.05)
    assert train_wiggle.measure_wiggling(0.001 * waves, 0.005)[-1]["hz"] is None


def turning(*speeds):
    return np.repeat(np.array([speeds], dtype=float), 1000, axis=0)


def test_a_cars_motion_has_one_name():
    t = np.arange(1000) * 0.005
    swing = np.stack([5 * np.cos(3 * t), 0 * t], axis=1)
    found = [
        car_route.classify_motion(omega, 0.005)
        for omega in (turning(0, 0), swing, turning(9, -9), turning(9, 8), turning(-9, -8))
    ]
    assert found == [
        car_route.REST,
        car_route.SWING,
        car_route.SPIN,
        car_route.ROLL,
        car_route.ROLL,
    ]


def test_the_formula_gives_the_speed_of_the_car_of_2019_and_none_below_its_onset():
    assert car_route.rolling_rad_s(preset("snake2019")) == pytest.approx(98.0, abs=0.1)
    assert car_route.rolling_rad_s(preset("snake2019")._replace(k=0.07)) is None


@pytest.mark.parametrize(
    ("after", "outcome"),
    [
        (-40.0, train_kick.REVERSED),
        (40.0, train_kick.GOES_ON),
        (1.0, train_kick.STOPS),
        (np.array([40.0] * 5 + [-40.0] * 5), train_kick.MIXED),
    ],
)
def test_a_kicks_outcome_is_told_by_all_wheels(after, outcome):
    assert train_kick.classify_outcome(np.full(10, 50.0), np.broadcast_to(after, (10,))) == outcome


def test_a_kick_takes_the_wheels_it_names_only():
    body = build_pushed_train(preset("paper"), seed=1)
    body.run(0.2)
    before = body.neurons.x1.copy()
    body.kick(
        train_kick.build_kick(
            {"mode": "membrane", "wheels": 1, "seconds": None}, ["car1_left"], body
        )
    )
    body.run(0.001)
    signs = np.sign(body.neurons.x1 * before)
    assert signs.tolist() == [1, 1, -1, *[1] * 7]


def test_a_wheel_is_as_large_and_as_weak_as_the_fault_has_it():
    radii = np.linspace(0.95, 1.05, 10)
    body = build_pushed_train(preset("paper"), seed=1, edit=train_fault.scale_wheels(radii))
    sizes = [body.model.geom(name + "_wheel").size[0] for name in body.wheels]
    assert sizes == pytest.approx(0.03 * radii)
    dead = train_fault.simulate(
        {"part": "weaker", "wheel": train_fault.WEAK, "percent": -100, "number": 1},
        setting("train-fault"),
    )
    whole = train_fault.simulate(
        {"part": "weaker", "wheel": train_fault.WEAK, "percent": 0, "number": 1},
        setting("train-fault"),
    )
    assert dead[0]["speed_m_s"] < whole[0]["speed_m_s"]
