"""Heading, settled and settling time of known motions, read in the encoder's whole degrees."""

from math import log as ln
from math import pi, radians

import numpy as np
import pytest

from host.logs.log import Log
from host.logs.motion import directions, heading, heading_of, settled, settling_of, settling_s
from robot.kicks import DIRECTION_TICKS, WHEELS, direction
from sim_motor.settling import COUNT_RAD
from tests.fakes import Rig

TICK_S = 0.03


def ticks(seconds, jitter_s=0.0, seed=1):
    """Times of ticks, each late by up to jitter_s."""
    grid = np.arange(0.0, seconds, TICK_S)
    return (
        grid + np.random.default_rng(seed).uniform(0.0, jitter_s, len(grid)) if jitter_s else grid
    )


def encoder(phi):
    """Angles as the encoder reads them."""
    return np.floor(phi / COUNT_RAD) * COUNT_RAD


def integral(speed, t):
    """Angles at times t of a wheel that turns at speed(t)."""
    fine = np.linspace(0.0, t[-1], 100 * len(t))
    return np.interp(
        t,
        fine,
        np.concatenate([[0.0], np.cumsum(speed((fine[1:] + fine[:-1]) / 2) * np.diff(fine))]),
    )


def test_a_heading_is_what_the_robot_takes_for_the_sign_of_a_phase_kick():
    rig = Rig()
    rig.run(9)
    rig.loop.start()
    kicks = []
    for pause in (1, 6, 9, 60, 61, 62, 7, 6, 5, 8, 70):
        rig.run(pause)
        kicks.append(rig.kick("phase", ticks=4))
        rig.run(4)
    log = rig.log()
    seen = set()
    for begin, (_, kick) in zip(kicks, log.kicks(), strict=True):
        for value, side in zip(kick["values"], WHEELS, strict=True):
            word = heading(log, side, begin - 1)
            assert (value < 0) == (word == "backward")
            seen.add(word)
    assert seen == {"forward", "backward", "stopped"}


@pytest.mark.parametrize(
    ("degrees", "word"),
    [
        ([5], "stopped"),
        ([0, 2], "stopped"),
        ([0, 4], "forward"),
        ([4, 0], "backward"),
        ([0, 0, 0, 0, 0, 0, 0, 0, 2], "stopped"),
        ([0, 0, 0, 0, 0, 0, 0, 0, 4], "forward"),
        ([0, 4, 4, 4, 4, 4, 4, 4, 4, 4], "stopped"),
        ([90, 50, 40, 30, 20, 10, 20, 30, 40, 60], "forward"),
    ],
)
def test_a_heading_is_the_travel_over_eight_ticks(degrees, word):
    assert heading_of([radians(value) for value in degrees]) == word


def test_the_directions_of_a_series_are_the_robots_own_of_each_travel():
    phi = encoder(np.cumsum(np.random.default_rng(1).normal(0.0, 0.02, (500, 2)), axis=0))
    travels = phi[DIRECTION_TICKS:] - phi[:-DIRECTION_TICKS]
    assert not directions(phi)[:DIRECTION_TICKS].any()
    assert not directions(phi[:3]).any()
    assert directions(phi)[DIRECTION_TICKS:].tolist() == [
        [direction(travel) for travel in row] for row in travels.tolist()
    ]


def test_a_heading_needs_angles_and_a_tick_that_is_there():
    with pytest.raises(ValueError, match="at least one"):
        heading_of([])
    rig = Rig()
    rig.run(3)
    with pytest.raises(ValueError, match="tick 3 is not"):
        heading(rig.log(), "left", 3)


def test_a_heading_looks_neither_across_a_restart_nor_back_before_a_gap():
    rig = Rig()
    rig.loop.start()
    rig.run(40)
    whole = rig.log()
    log = Log()
    log.take_records(whole.records[:38])
    log.take_event({"event": "restart", "tick": 0, "boot": "b"})
    log.take_records([record._replace(left_phi_rad=-50.0) for record in whole.records[:2]])
    assert heading(log, "left", 1) == "stopped"
    log = Log()
    log.take_records([record._replace(left_phi_rad=-50.0) for record in whole.records[:20]])
    log.take_records([record._replace(left_phi_rad=7.0) for record in whole.records[29:]])
    assert heading(log, "left", 36) == "stopped"
    assert heading(whole, "left", 36) == heading(whole, "left", 35) != "stopped"


@pytest.mark.parametrize("jitter_s", [0.0, 0.008])
@pytest.mark.parametrize("speed", [0.0, 0.03, 0.07, 0.2, 0.5, 1.0, 3.0, 12.6, 18.0])
def test_steady_motion_is_settled_at_any_speed(speed, jitter_s):
    t = ticks(8.0, jitter_s)
    for phi in (encoder(speed * t), encoder(-speed * t)):
        assert all(settled(phi[end - 45 : end], t[end - 45 : end]) for end in range(45, len(t)))


def test_windows_may_begin_between_ticks():
    """A window of 0.5 s has 6.25 ticks of 80 ms: whole ticks alone would differ by a seventh."""
    times = (0.08 * np.arange(20)).tolist()
    assert settled([12.0 * time for time in times], times)


def test_a_wheel_at_rest_may_flicker_by_one_count():
    t = ticks(2.0)
    rest = np.full(len(t), radians(40.0))
    rest[5::7] += COUNT_RAD
    assert settled(rest, t)
    rest[10] += COUNT_RAD
    rest[40:] -= COUNT_RAD
    assert not settled(rest, t)


def test_less_than_two_windows_are_never_settled():
    t = ticks(0.99)
    assert not settled(12.0 * t, t)
    assert not settled(0.0 * t, t)
    assert not settled([], [])
    t = ticks(1.05)
    assert settled(12.0 * t, t)


@pytest.mark.parametrize("tau_s", [0.1, 0.2, 0.4])
def test_a_reversing_wheel_is_not_settled_until_it_has_reversed(tau_s):
    t = ticks(6.0, 0.004)
    phi = encoder(
        integral(lambda t: np.where(t < 2.0, 12.0, 12.0 * (2 * np.exp(-(t - 2.0) / tau_s) - 1)), t)
    )
    answers = np.array([settled(phi[:end], t[:end]) for end in range(1, len(t) + 1)])
    assert answers[(t > 1.1) & (t < 2.0)].all()
    # Within two windows after the turn, the wheel has turned back in them. The turn shows only
    # after a tick or two.
    turned = 2.0 + tau_s * ln(2)
    assert not answers[(t > turned + 0.1) & (t < turned + 0.95)].any()
    assert answers[t > turned + 1.1 + 3 * tau_s].all()


def test_a_wheel_that_speeds_up_or_runs_down_is_not_settled():
    t = ticks(6.0)
    for motion in (1.5 * t**2, -1.5 * t**2, 4.0 * (1 - np.exp(-t / 1.0))):
        phi = encoder(motion)
        assert not any(settled(phi[:end], t[:end]) for end in range(40, 100))
    assert settled(encoder(integral(lambda t: np.maximum(0.0, 4.0 - 2 * t), t)), t)


def test_windows_that_agree_by_chance_are_not_settled():
    t = ticks(1.1)
    swing = 0.4 * np.sin(2 * pi * t / 0.5) + 0.5 * t
    assert not settled(encoder(swing), t)
    assert settled(encoder(0.5 * t), t)


def test_irregular_switching_is_never_settled_while_a_switch_is_in_sight():
    dice = np.random.default_rng(7)
    edges = np.cumsum(dice.uniform(0.15, 0.95, 200))
    t = ticks(100.0, 0.004)
    t = t[t < edges[-1]]
    target = np.where(np.searchsorted(edges, t) % 2, 12.0, -12.0)
    speed = np.zeros(len(t))
    for i in range(1, len(t)):
        speed[i] = speed[i - 1] + (target[i] - speed[i - 1]) * (t[i] - t[i - 1]) / 0.1
    phi = encoder(np.concatenate([[0.0], np.cumsum(speed[1:] * np.diff(t))]))
    assert not any(settled(phi[end - 60 : end], t[end - 60 : end]) for end in range(60, len(t)))


def reversal(tau_s, t, begin_s, speed=12.6):
    """A wheel that reverses from begin_s on; it enters the band of 10 % after tau_s ln 20."""
    return integral(
        lambda t: speed * np.where(t < begin_s, 1.0, 2 * np.exp(-(t - begin_s) / tau_s) - 1), t
    )


@pytest.mark.parametrize("jitter_s", [0.0, 0.006])
@pytest.mark.parametrize("tau_s", [0.08, 0.15, 0.3, 0.6])
def test_settling_time_of_an_exponential_reversal(tau_s, jitter_s):
    t = ticks(9.0, jitter_s)
    phi = encoder(reversal(tau_s, t, 2.0))
    # One tick of resolution, one of smoothing, and one count in a span of 0.12 s against the slope
    # at the band's edge.
    tolerance = 2 * TICK_S + tau_s * (COUNT_RAD / 0.12) / 1.26
    assert settling_of(phi, t, 2.0) == pytest.approx(tau_s * ln(20), abs=tolerance)
    assert settling_of(-phi, t, 2.0) == settling_of(-phi, t, 2.0)


def test_a_kick_without_effect_settles_at_once():
    t = ticks(5.0)
    assert settling_of(encoder(12.6 * t), t, 2.0) == 0.0
    assert settling_of(np.zeros(len(t)), t, 2.0) == 0.0


def test_a_wheel_that_is_brought_to_rest_settles():
    t = ticks(5.0)
    phi = encoder(
        integral(lambda t: 12.6 * np.where(t < 2.0, 1.0, np.maximum(0.0, 1 - (t - 2.0) / 0.4)), t)
    )
    assert settling_of(phi, t, 2.0) == pytest.approx(0.4, abs=2.5 * TICK_S)


def test_what_comes_before_the_kick_does_not_count():
    t = ticks(6.0)
    phi = encoder(integral(lambda t: np.where(t < 1.0, -12.6, 12.6), t))
    assert settling_of(phi, t, 3.0) == 0.0
    assert settling_of(phi, t, 0.9) == pytest.approx(0.1, abs=3 * TICK_S)


def test_a_late_wobble_makes_settling_late():
    t = ticks(9.0)
    phi = encoder(
        integral(lambda t: np.where(t < 2.0, -12.6, np.where((t > 4.0) & (t < 4.3), 9.0, 12.6)), t)
    )
    assert settling_of(phi, t, 2.0) == pytest.approx(2.3, abs=3 * TICK_S)


def test_the_steps_of_the_encoder_do_not_keep_a_slow_wheel_from_settling():
    t = ticks(9.0, 0.004)
    phi = encoder(reversal(0.15, t, 2.0, speed=0.5))
    assert 0.1 < settling_of(phi, t, 2.0) < 0.15 * ln(20)


def test_what_has_not_settled_by_the_end_is_reported():
    t = ticks(6.0)
    at_last = encoder(
        integral(lambda t: np.where(t < 2.0, -12.6, np.where(t < 5.6, 10.3, 12.6)), t)
    )
    assert settling_of(at_last, t, 2.0) is None
    assert settling_of(encoder(integral(lambda t: 12.6 * np.sin(4 * t), t)), t, 2.0) is None
    assert (
        settling_of(encoder(10.0 * np.maximum(0.0, t - 2.0) ** 2)[t < 3.5], t[t < 3.5], 2.0) is None
    )
    early = t < 2.6
    assert settling_of(encoder(reversal(0.3, t, 2.0))[early], t[early], 2.0) is None
    assert settling_of(encoder(12.6 * t), t, 5.8) is None
    assert settling_of([], [], 0.0) is None


def test_the_settling_time_in_a_log_is_that_of_its_columns():
    rig = Rig(lateness=(0.0, 0.001))
    rig.loop.start()
    rig.run(80)
    begin = rig.kick("membrane", wheel="left")
    rig.run(80)
    log = rig.log(tick=20)
    t, phi = log.column("t_s"), log.column("left_phi_rad")
    begin_s = next(record.t_s for record in log.records if record.tick == begin)
    assert settling_s(log, "left", begin) == settling_of(phi, t, begin_s)
    assert 0.1 < settling_s(log, "left", begin) < 1.5
    assert heading(log, "left", begin) != heading(log, "left", log.records[-1].tick) != "stopped"
    assert settling_s(log, "right", begin) == 0.0
    with pytest.raises(ValueError, match="tick 5 is not"):
        settling_s(log, "left", 5)
