"""The film of a wheel's rods, and where its numbers come from."""

import json
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from PIL import Image

from host.cli import main
from host.errors import NotDone
from host.figures.robot import rods as figure
from host.films.rod_course import WINDOW_S, course
from host.logs.log import Log
from robot.controller import motor_torque, rod_force, tangential_force


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The log of `kickctl rods`, and its film."""
    folder = tmp_path_factory.mktemp("rods")
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(StringIO()) as answer:
        patch.chdir(folder)
        patch.setenv("KICK_TOKEN", str(folder / "token"))
        patch.delenv("KICK_BRICK", raising=False)
        assert main(["rods", "--out", "rods.gif", "--seed", "1", "--json"]) == 0
    result = json.loads(answer.getvalue())
    assert result["reversed"]
    return Log.load(folder / result["log"]), folder / result["film"]


def test_the_film_of_the_rods_plays_and_is_small(log):
    with Image.open(log[1]) as gif:
        assert gif.size == figure.SIZE
        assert 5.0 < gif.n_frames * gif.info["duration"] / 1000 < 7.0
    assert log[1].stat().st_size < 2_000_000


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_rods_that_are_shown_make_the_robots_torque(log, side):
    robot, tick_s = log[0], 0.03
    k, zero_s = robot.info["params"]["k"], robot.records[robot.kicks()[0][0]].t_s
    inside = [
        record
        for record in robot.records
        if WINDOW_S[0] < record.t_s - zero_s < WINDOW_S[1] - tick_s
    ]
    assert len(inside) > 30
    for record in inside:
        at_s = record.t_s - zero_s
        shown = course(robot, side, (max(WINDOW_S[0], at_s), at_s + 1e-3), 1e-3)
        forces = [
            rod_force(target, actual, k)
            for target, actual in zip(shown.targets[:, 0], shown.actual[:, 0], strict=True)
        ]
        torque = motor_torque(tangential_force(*forces, *shown.actual[:, 0]))
        assert torque == pytest.approx(getattr(record, side + "_torque"), abs=1e-9)
        assert shown.torque[0] == getattr(record, side + "_torque")


def test_a_kick_shows_the_neurons_another_place_only_while_it_acts(log):
    shown = course(log[0], "left", WINDOW_S, 0.01)
    altered = ~np.isnan(shown.seen[0])
    assert np.array_equal(altered, (shown.t_s > -1e-9) & (shown.t_s < shown.kick_s - 1e-9))
    turned = np.arctan2(shown.seen[1], shown.seen[0])[altered] - shown.phi[altered]
    assert np.cos(turned) == pytest.approx(np.cos(3 * np.pi / 4))
    assert (
        shown.phi[0] < shown.phi[np.searchsorted(shown.t_s, 0.0)] > shown.phi[-1]
    )  # forward, then backward


def test_pictures_of_the_rods_change_with_the_wheel_and_repeat_to_the_pixel(log):
    shown = course(log[0], "left", (-0.1, 0.2), 0.1)
    first, again = (np.array(list(figure.pictures(shown, 4.0))) for _ in range(2))
    assert first.shape == (3, figure.SIZE[1], figure.SIZE[0], 3)
    assert np.array_equal(first, again)
    machine = first[:, :, : figure.SIZE[0] // 2].astype(int)
    assert (np.abs(np.diff(machine, axis=0)).max(axis=3) > 50).sum(axis=(1, 2)).min() > 500


def test_a_log_without_a_kick_or_too_short_is_refused(log):
    with pytest.raises(NotDone, match="too little"):
        course(log[0], "left", (-1000.0, 1.0), 0.01)
    with pytest.raises(NotDone, match="no kick"):
        course(Log(), "left", WINDOW_S, 0.01)
