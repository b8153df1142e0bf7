"""The car between slopes: a drive in parts is the whole drive."""

import json

import numpy as np
import pytest

from host.experiments.bodies import car_slope
from host.experiments.bodies.simulation import run_body
from host.runs.contract import Part
from sim_motor.bodies.measures import FALLEN_RAD, reversals_s
from tests.paper.bodies.short_runs import plain, setting

CELL = {"angle": 0.37, "number": 1}


@pytest.fixture
def short(monkeypatch):
    """Parts of 3 s; a car that reverses at once has reversed, and travels in half a second."""
    monkeypatch.setattr(car_slope, "PART_S", 3.0)
    monkeypatch.setattr(car_slope, "MEAN_S", 0.5)
    return setting("car-slope", seconds=20.5)


def test_a_drive_is_the_same_in_parts_and_if_it_is_resumed(short):
    parts = list(car_slope.parts(CELL, short, None))
    assert [part.share for part in parts] == pytest.approx(
        [3 / 20.5 * n for n in range(1, 7)] + [1]
    )
    begun = Part(**plain(parts[1]._asdict()))
    assert list(car_slope.parts(CELL, short, begun)) == parts[2:]
    rows = car_slope.simulate(CELL, short)
    assert rows == [row for part in parts for row in part.rows]
    *places, drive = rows
    # Against all of its states at once.
    course = run_body(car_slope._build(CELL, short), 20.5).course
    t, centre = course.t_s, course.centre_m
    travels = np.linalg.norm(centre[100:] - centre[:-100], axis=1) > 0.05
    assert [(row["t_s"], row["x_m"], row["y_m"]) for row in places] == [
        (float(t[at]), float(centre[at, 0]), float(centre[at, 1])) for at in range(0, len(t), 40)
    ]
    assert drive == {
        "inside": True,
        "flipped": bool((course.lean_rad > FALLEN_RAD).any()),
        "reach_m": np.abs(centre[:, :2]).max(),
        "lean_rad": course.lean_rad.max(),
        "reversals": len(reversals_s(course)),
        "path_m": pytest.approx(np.linalg.norm(np.diff(centre, axis=0), axis=1).sum(), rel=1e-12),
        "travelled": travels.mean(),
        "spun": (course.omega.prod(axis=1) < -0.25).mean(),
        "last_s": t[100:][travels][-1],
        "squares": len(np.unique(np.floor(centre[:, :2] / 0.5), axis=0)),
    }
    assert drive["reversals"] > 0
    assert json.dumps(parts[0].state)
