"""A log grows while an experiment looks at it: then all its columns fit together."""

import numpy as np
import pytest

from host.experiments.robot import calibrate, primitives, timeline
from host.experiments.robot.wall_hits import motion_since
from host.figures.robot.kick import draw
from kickctl import connect


@pytest.fixture(scope="module")
def recorded():
    """A log of a robot that is kicked, and the tick of its kick."""
    with connect("sim://", seed=1) as robot, robot.recording() as log:
        robot.wait(4)
        tick = robot.kick_and_watch("phase", ticks=4).applied_tick
        robot.wait(2)
    return log, tick


@pytest.fixture
def growing(recorded, monkeypatch):
    """The same log. It has grown whenever somebody has taken a column."""
    log = recorded[0].until_now()
    column = log.column

    def look(name):
        found = column(name)
        for _ in range(30):
            last = log.records[-1]
            log.take_records([last._replace(tick=last.tick + 1, t_s=last.t_s + last.dt_s)])
        return found

    monkeypatch.setattr(log, "column", look)
    return log


def looks(log, tick):
    """What experiments find in a log, by their names."""
    motion = motion_since(log, tick)
    return {
        "slip": timeline._slip(log, tick),
        "ticks": timeline._ticks(log, "phase", [timeline._row_of(log, tick)] * 2),
        "samples": primitives._samples(log)[:5],
        "calibrate": calibrate._ticks(log, [(0, "steps")], log.info["params"], 8.0, "")[:50],
        "wall": np.column_stack([motion.t, motion.phi, motion.torque])[:50].tolist(),
    }


def test_what_an_experiment_finds_is_not_disturbed(recorded, growing):
    log, tick = recorded
    assert looks(growing, tick) == looks(log, tick)
    assert len(growing) > len(log)


def test_its_figure_is_drawn(growing, tmp_path):
    assert draw(growing, tmp_path / "kick.png", "a kick").stat().st_size > 0
