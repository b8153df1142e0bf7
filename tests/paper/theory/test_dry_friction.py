"""Dry friction opposes motion in either direction, and holds a wheel at rest: against scipy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.theory.analysis import outcomes
from host.theory.analysis.attractors import REST, watch
from host.theory.analysis.tangent import growth
from host.theory.analysis.trajectories import trajectory
from host.theory.engine import sampled
from host.theory.engine.ensemble import advance, averages
from host.theory.engine.kicked import Continuous
from host.theory.engine.sampled import Clock
from host.theory.model.turning import turning
from host.theory.model.wheel import OMEGA, PHI, Wheel, resting
from tests.paper.theory import independent

MIRROR = np.array([1.0, -1.0, -1.0, -1.0])[:, None]
SWINGING = Wheel(k=8.0, tau=1.0, dry_friction=0.3)


def by_scipy(start, wheel, seconds):
    """A wheel's course in pieces between its stops, and how often it stopped."""
    y, now, stops = np.array(start), 0.0, 0
    while now < seconds:
        at_rest = independent.rates([*y[:3], 0.0], wheel)[3] * wheel.I
        way = np.sign(y[3]) or (
            np.sign(at_rest) if abs(at_rest) > wheel.dry_friction - 1e-9 else 0.0
        )

        def rates(_, y, way=way):
            found = independent.rates(y, wheel)
            found[3] = (found[3] - way * wheel.dry_friction / wheel.I) if way else 0.0
            return found

        def changes(t, y, way=way):
            if way:
                return y[3] * way if t > 1e-9 else 1.0
            return wheel.dry_friction - abs(independent.rates(y, wheel)[3] * wheel.I)

        changes.terminal, changes.direction = True, -1
        run = solve_ivp(
            rates, (0.0, seconds - now), y, "DOP853", events=changes, rtol=1e-11, atol=1e-12
        )
        y, now = run.y[:, -1], now + run.t[-1]
        if now < seconds:
            y[3], stops = 0.0, stops + 1
    return y, stops


@pytest.mark.parametrize(("k", "dry"), [(4.0, 0.3), (6.5, 0.8)])
def test_a_wheel_is_slowed_alike_in_both_directions(k, dry):
    wheel = Wheel(k=k, dry_friction=dry)
    starts = turning(np.zeros(2), np.array([6.0, -6.0]), wheel)
    forward, backward = averages(starts, wheel.columns(2), 40.0, 40.0).omega_mean
    assert forward == pytest.approx(-backward, rel=1e-9)
    settled, _ = by_scipy(starts[:, 0], wheel, 40.0)
    ended, _ = by_scipy(settled, wheel, 40.0)
    assert forward == pytest.approx((ended[2] - settled[2]) / 40.0, rel=1e-6)
    assert forward < averages(starts, Wheel(k=k).columns(2), 40.0, 40.0).omega_mean[0]


@pytest.mark.parametrize("start", [(0.3, -0.2, 0.6, 0.0), (0.9, 0.1, -0.5, 4.0)])
def test_a_wheel_that_stops_and_goes_on_moves_as_scipy_moves_it(start):
    states = np.array(start)[:, None]
    expected, stops = by_scipy(start, SWINGING, 6.0)
    assert stops >= 4
    ended = advance(states, SWINGING.columns(1), 6.0)
    assert ended[:, 0] == pytest.approx(expected, abs=1e-8)
    assert trajectory(states[:, 0], SWINGING, 6.0)[-1] == pytest.approx(expected, abs=1e-8)
    assert advance(MIRROR * states, SWINGING.columns(1), 6.0) == pytest.approx(
        MIRROR * ended, abs=1e-9
    )


def test_a_wheel_rests_wherever_its_friction_holds_it():
    wheel = Wheel(k=1.0, dry_friction=0.08)
    starts = resting(np.linspace(-np.pi, np.pi, 41))
    torque = np.array([independent.rates(y, wheel)[3] * wheel.I for y in starts.T])
    held = np.abs(torque) <= wheel.dry_friction
    assert held.any()
    assert not held.all()
    ended = advance(starts, wheel.columns(41), 30.0)
    moved = np.abs(ended[PHI] - starts[PHI])
    assert (moved[held] == 0.0).all()
    assert (moved[~held] > 0.01).all()
    assert (ended[OMEGA] == 0.0).all()
    assert (watch(starts, wheel.columns(41), 20.0).kinds()[held] == REST).all()


@pytest.mark.parametrize(
    ("k", "dry", "expected"),
    [
        (2.0, 0.3, [outcomes.REST] * 6),  # above k_c, but held
        (8.0, 0.3, [outcomes.REST] * 2 + [outcomes.BACKWARD] * 2 + [outcomes.FORWARD] * 2),
        (1.72, 0.001, [outcomes.BACK] * 6),  # too little to hold a swing
    ],
)
def test_wheels_that_friction_holds_rest_though_they_would_swing_without_it(k, dry, expected):
    wheel = Wheel(k=k, dry_friction=dry)
    starts = outcomes.starting_states(np.array([0.01, 0.02, 0.3, 0.5, -0.3, -0.5]), np.zeros(6))
    names = outcomes.settle_and_classify(Continuous(), starts, wheel)[0]
    assert names.tolist() == expected
    later = advance(advance(starts, wheel.columns(6), 200.0), wheel.columns(6), 1.0)
    assert ((later[OMEGA] == 0.0) == (names == outcomes.REST)).all()


def test_without_a_way_to_follow_dry_friction_a_wheel_is_refused():
    state, parameters = resting(np.zeros(1)), SWINGING.columns(1)
    with pytest.raises(WrongUse, match="dry friction"):
        growth(state, parameters, 1.0)
    with pytest.raises(WrongUse, match="dry friction"):
        sampled.advance(sampled.unforced(state), parameters, Clock(), 1)
