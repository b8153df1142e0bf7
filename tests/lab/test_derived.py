"""Derived channels are what the robot's own functions say of a log."""

from math import atan2, cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.client.robot import connect
from host.lab import derived
from robot.controller import rod_force, tangential_force, target_position
from robot.kicks import WHEELS
from robot.record import Record

NAMES = [channel.name for channel in derived.CHANNELS]


class Derived:
    """A tap that derives, and keeps what belongs to each record."""

    def __init__(self):
        self.follower = derived.Follower()
        self.rows = []

    def take_records(self, records):
        for record in records:
            values = self.follower.derive(record)
            if values is not None:
                self.rows.append((record, dict(zip(NAMES, values, strict=True))))

    def take_event(self, event):
        self.follower.take_event(event)


@pytest.fixture(scope="module")
def log():
    with connect("sim://?seed=3") as robot, robot.recording() as log:
        robot.wait(1.0)
        robot.kick("phase", ticks=4, wheel="left")
        robot.wait(0.5)
        robot.kick("position", ticks=3, shape="smooth")
        robot.wait(0.5)
        robot.kick("pulse", param="a", value=1.0, ticks=5)
        robot.wait(0.5)
        robot.set(a=2.0)
        robot.wait(0.5)
    return log


@pytest.fixture(scope="module")
def rows(log):
    tap = Derived()
    log.play(tap)
    assert len(tap.rows) == len(log) - 1
    return tap.rows


def column(rows, name):
    return np.array([values[name] for _, values in rows])


@pytest.mark.parametrize("side", WHEELS)
def test_the_speed_is_that_of_a_log(log, rows, side):
    assert np.array_equal(column(rows, side + "_omega_rad_s"), log.omega(side)[1:])


@pytest.mark.parametrize("side", WHEELS)
def test_targets_follow_the_gain_in_force(rows, side):
    gains = set()
    for record, values in rows:
        x1 = getattr(record, side + "_x1")
        gain = next(
            (a for a in (4.0, 2.0, 1.0) if values[side + "_target1"] == target_position(x1, a)),
            None,
        )
        assert gain is not None
        gains.add(gain)
    assert gains == {4.0, 2.0, 1.0}


def test_only_a_quenched_kick_changes_what_the_neurons_see(rows):
    shifted = {side: {} for side in WHEELS}
    for record, values in rows:
        for side in WHEELS:
            phi = getattr(record, side + "_phi_rad")
            seen = values[side + "_seen1"], values[side + "_seen2"]
            if seen != (cos(phi), sin(phi)):
                assert record.kick
                scale = np.hypot(*seen)
                angle = derived.wrapped(atan2(seen[1], seen[0]) - phi)
                shifted[side].setdefault(record.kick, []).append((scale, angle))
    phase, position = 3, 2
    assert len(shifted["left"][phase]) == 4
    assert all(abs(abs(angle) - 3 * pi / 4) < 1e-9 for _, angle in shifted["left"][phase])
    assert phase not in shifted["right"]
    # sin^2 of 30, 90 and 150 degrees: beta is 0.25, 1 and 0.25.
    scales = [scale for scale, _ in shifted["right"][position]]
    assert scales == pytest.approx([0.5, 1.0, 0.5])


def test_the_lag_is_how_far_the_memory_lies_behind(rows):
    for record, values in rows:
        remembered = record.left_phi_rad - values["left_lag_rad"]
        assert cos(remembered - atan2(record.left_x2, record.left_x1)) == pytest.approx(1.0)


@given(st.floats(-1e4, 1e4))
def test_an_angle_is_wrapped_into_one_turn(angle):
    assert -pi < derived.wrapped(angle) <= pi + 1e-9
    assert cos(derived.wrapped(angle)) == pytest.approx(cos(angle), abs=1e-6)


def rolled(*turns):
    """Where the robot is after its wheels have turned by these angles (rad), left and right."""
    follower, values = derived.Follower(), dict.fromkeys(NAMES, 0.0)
    left = right = 0.0
    blank = Record(*([0] * len(Record._fields)))
    follower.derive(blank)
    for number, (turn_left, turn_right) in enumerate(turns, 1):
        left, right = left + turn_left, right + turn_right
        record = blank._replace(
            tick=number, t_s=0.03 * number, left_phi_rad=left, right_phi_rad=right
        )
        values = dict(zip(NAMES, follower.derive(record), strict=True))
    return values["x_m"], values["y_m"], values["heading_rad"]


def test_odometry_rolls_straight_turns_on_the_spot_and_closes_a_circle():
    radius, track = derived.body().wheel_radius_m, derived.body().track_m
    assert rolled((2.0, 2.0), (1.0, 1.0)) == pytest.approx((3.0 * radius, 0.0, 0.0))
    quarter = pi / 4 * track / radius
    assert rolled((-quarter, quarter)) == pytest.approx((0.0, 0.0, pi / 2))
    assert rolled((-quarter, quarter), (1.0, 1.0)) == pytest.approx((0.0, radius, pi / 2))
    # One wheel rests: the other one rolls around it.
    steps = 1000
    turn = 2 * pi * track / radius / steps
    x_m, y_m, heading_rad = rolled(*[(0.0, turn)] * steps)
    assert (x_m, y_m) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert heading_rad == pytest.approx(2 * pi)


def test_a_restart_begins_anew_where_the_robot_is():
    follower = derived.Follower()
    blank = Record(*([0] * len(Record._fields)))
    follower.derive(blank)
    here = follower.derive(blank._replace(t_s=1.0, left_phi_rad=1.0, right_phi_rad=1.0))[-3:]
    follower.take_event({"event": "restart", "tick": 0})
    assert follower.derive(blank._replace(left_phi_rad=-50.0)) is None
    assert follower.derive(blank._replace(left_phi_rad=-50.0, t_s=1.0))[-3:] == here


@given(*[st.floats(-1, 1)] * 2, st.floats(-pi, pi))
def test_springs_as_drawn_would_pull_the_pin_the_other_way(target1, target2, phi):
    """As docs/lab.md and the key beside the wheels say of the arrow."""
    pin = np.array([cos(phi), sin(phi)])
    pull = [rod_force(target1, pin[0], 8.0), rod_force(target2, pin[1], 8.0)]
    along_rim = pin[0] * pull[1] - pin[1] * pull[0]  # positive: counterclockwise, forward
    assert tangential_force(*pull, *pin) == pytest.approx(-along_rim, abs=1e-12)
