"""The engine for many wheels of the analytic model.

Its mathematics against `math`, its numbers against exact solutions and scipy.
"""

import math
from contextlib import nullcontext
from functools import partial

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.theory.engine import elementary, series
from host.theory.engine.ensemble import LANES, advance, averages, rate_per_s
from host.theory.model.wheel import OMEGA, PHI, Wheel, rates
from sim_motor.compiled import on_one_core

# At rest, forth and back, rolling slowly and fast, and with a short memory.
WHEELS = [Wheel(k=1.4), Wheel(k=1.65), Wheel(k=1.85), Wheel(k=14.0), Wheel(tau=0.03, k=12.0)]
START = np.array([1.0, 0.0, 0.3, 1.0])


def columns(wheels):
    """Parameters (6, wheels)."""
    return np.array(list(wheels), dtype=float).T


def starts(count, start=START):
    """States (4, wheels), all the same."""
    return np.repeat(np.asarray(start, dtype=float)[:, None], count, axis=1)


def off(got, exact):
    """By how many units in the last place."""
    return abs(got - exact) / math.ulp(exact)


@settings(deadline=None, max_examples=500)
@given(st.floats(-700, 700))
@example(0.0)
@example(-1e-300)
def test_exp_is_that_of_math(x):
    assert off(elementary.exp(x), math.exp(x)) <= 2


@settings(deadline=None, max_examples=500)
@given(st.floats(-1e6, 1e6))
@example(0.0)
@example(355.0)
@example(103993.0)
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_sin_and_cos_are_those_of_math(name, x):
    got, exact = getattr(elementary, name)(x), getattr(math, name)(x)
    assert abs(got - exact) <= 2 * math.ulp(exact) + 1e-20


@settings(deadline=None, max_examples=200)
@given(st.integers(-600_000, 600_000))
@pytest.mark.parametrize("name", ["sin", "cos"])
def test_sin_and_cos_at_the_octants_edges(name, quarters):
    for x in (quarters * math.pi / 2, (quarters + 0.5) * math.pi / 2):
        got, exact = getattr(elementary, name)(x), getattr(math, name)(x)
        assert abs(got - exact) <= 2 * math.ulp(exact) + 1e-20


@pytest.mark.parametrize("wheel", [Wheel(k=14.0), Wheel(tau=0.03, k=12.0)])
def test_halving_the_step_gains_eight_binary_digits(wheel):
    after = partial(advance, starts(1), columns([wheel]), 20.0)
    exact = after(4.0)
    coarse, fine = (np.abs(after(fineness) - exact).max() for fineness in (0.5, 1.0))
    assert 7.5 < math.log2(coarse / fine) < 9.0


def test_states_agree_with_scipy():
    seconds = 1.0
    found = advance(starts(len(WHEELS)), columns(WHEELS), seconds, 4.0)
    for i, wheel in enumerate(WHEELS):
        theirs = solve_ivp(
            lambda _, y, wheel=wheel: rates(*y.tolist(), *wheel),
            (0.0, seconds),
            START,
            "DOP853",
            rtol=3e-14,
            atol=1e-14,
        )
        assert found[:, i] == pytest.approx(theirs.y[:, -1], rel=1e-12, abs=1e-12), wheel


def test_averages_agree_with_scipy():
    """With the textbook's integral of omega^2, which ours is not."""
    found = averages(starts(len(WHEELS)), columns(WHEELS), 2.0, 5.0, 2.0)
    for i, wheel in enumerate(WHEELS):

        def field(_, y, wheel=wheel):
            return *rates(*y[:4].tolist(), *wheel), y[3] ** 2

        theirs = solve_ivp(
            field, (0.0, 7.0), [*START, 0.0], "DOP853", [2.0, 7.0], rtol=3e-14, atol=1e-14
        )
        gained = (theirs.y[:, 1] - theirs.y[:, 0]) / 5.0
        assert found.omega_mean[i] == pytest.approx(gained[PHI], abs=1e-11)
        assert found.omega_std[i] == pytest.approx(
            math.sqrt(gained[4] - gained[PHI] ** 2), abs=1e-10
        )


@pytest.mark.parametrize("change", [{}, {"rods": 1.0, "bounded": 1.0}])
def test_series_and_runge_kutta_agree(change):
    """Also where fast neurons, a light wheel or much friction make the steps of both short."""
    parameters = columns(
        wheel._replace(**change)
        for wheel in (
            *WHEELS,
            Wheel(tau=1e-3, k=20.0),
            Wheel(tau=1e-3, k=0.0),
            Wheel(tau=1.5, k=1000.0, f=30.0),
            Wheel(I=1e-4, k=0.5),
            Wheel(a=100.0, tau=0.01, k=0.2),
            Wheel(a=0.0, k=20.0),
            Wheel(f=50.0, k=5.0),
        )
    )
    begin = starts(parameters.shape[1])
    by_series = averages(begin, parameters, 0.0, 3.0).states
    assert by_series == pytest.approx(advance(begin, parameters, 3.0, 3.0), rel=1e-8, abs=1e-8)


def test_more_wheels_than_one_instruction_does_do_not_disturb_each_other():
    """One takes the place of another that has come to its end."""
    parameters = random_wheels(3 * series.LANES + 1)
    together = averages(starts(parameters.shape[1]), parameters, 0.0, 2.0)
    for wheel in (0, *range(2 * series.LANES, parameters.shape[1])):
        alone = averages(starts(1), parameters[:, [wheel]], 0.0, 2.0)
        assert np.array_equal(together.states[:, [wheel]], alone.states)
        assert together.omega_std[wheel] == alone.omega_std[0]


def test_a_wheel_without_springs_runs_down_as_the_formula_says():
    """omega = omega_0 exp(-t/T), T = I/f: mean and variance over a time are elementary."""
    wheel = Wheel(k=0.0, I=0.5, f=0.25)
    seconds, decay_s, first = 3.0, 2.0, 7.0
    found = averages(starts(1, (0.0, 0.0, 0.0, first)), columns([wheel]), 0.0, seconds)
    mean = first * decay_s / seconds * (1 - math.exp(-seconds / decay_s))
    square = first**2 * decay_s / (2 * seconds) * (1 - math.exp(-2 * seconds / decay_s))
    assert found.omega_mean[0] == pytest.approx(mean, rel=1e-10)
    assert found.omega_std[0] == pytest.approx(math.sqrt(square - mean**2), rel=1e-10)


def test_a_wheel_that_nothing_acts_on_keeps_its_speed_for_long():
    """And has no standard deviation.

    Not even that of rounding, which the difference of two squares would have.
    """
    found = averages(starts(1, (0.0, 0.0, 0.0, 30.0)), columns([Wheel(k=0.0, f=0.0)]), 100.0, 100.0)
    assert found.omega_mean[0] == pytest.approx(30.0, rel=1e-14)
    assert found.omega_std[0] == 0.0
    assert found.states[PHI, 0] == pytest.approx(6000.0, rel=1e-14)


def test_a_fixpoint_stays_and_a_stable_one_draws():
    parameters = columns([Wheel(k=0.5)])
    rest = np.array([[math.cos(0.0)], [math.sin(0.0)], [0.0], [0.0]])
    assert np.array_equal(advance(rest, parameters, 50.0), rest)
    found = averages(starts(1), parameters, 100.0, 100.0)
    assert abs(found.omega_mean[0]) < 1e-12
    assert found.omega_std[0] < 1e-12
    assert np.abs(found.states[:, 0] - [1.0, 0.0, 0.0, 0.0]).max() < 1e-12


@pytest.mark.parametrize("quarters", [1, 2, 3])
def test_a_wheel_turned_by_quarters_stays_so(quarters):
    turned = START.copy()
    for _ in range(quarters):
        turned = np.array([-turned[1], turned[0], turned[PHI] + math.pi / 2, turned[OMEGA]])
    here, there = (
        advance(starts(len(WHEELS), start), columns(WHEELS), 5.0) for start in (START, turned)
    )
    for _ in range(quarters):
        here = np.array([-here[1], here[0], here[PHI] + math.pi / 2, here[OMEGA]])
    assert np.abs(here - there).max() < 1e-10


def test_a_mirrored_wheel_stays_so():
    mirror = np.array([1.0, -1.0, -1.0, -1.0])
    here, there = (
        advance(starts(len(WHEELS), start), columns(WHEELS), 5.0)
        for start in (START, mirror * START)
    )
    assert np.abs(mirror[:, None] * here - there).max() < 1e-11


def random_wheels(count):
    """Parameters (6, count) from all over the phase diagram."""
    chance = np.random.default_rng(5)
    return columns(
        [Wheel(tau=chance.uniform(0.02, 1.5), k=chance.uniform(0, 20)) for _ in range(count)]
    )


def test_the_same_bits_on_any_number_of_cores():
    parameters = random_wheels(5 * LANES + 3)
    found = []
    for cores in (on_one_core(), nullcontext()):
        with cores:
            found.append(np.vstack(averages(starts(parameters.shape[1]), parameters, 2.0, 2.0)))
    assert np.array_equal(*found)


def test_neighbours_matter_through_the_step_only():
    """The fastest wheel of a block sets its step: its result depends on no other wheel."""
    parameters = random_wheels(LANES)
    fastest = int(np.argmax(rate_per_s(parameters)))
    together = advance(starts(LANES), parameters, 3.0)
    alone = advance(starts(1), parameters[:, [fastest]], 3.0)
    backward = advance(starts(LANES), parameters[:, ::-1], 3.0)[:, ::-1]
    assert np.abs(together[:, [fastest]] - alone).max() < 1e-12
    assert np.abs(together - backward).max() < 1e-12


def test_the_default_steps_give_nine_digits_all_over_the_phase_diagram():
    """Wheels that rest, swing and roll.

    From one k and tau to the next the error stays about the same.
    """
    parameters = columns(
        [
            Wheel(tau=tau_s, k=k)
            for tau_s in (0.03, 0.1, 0.25, 0.5)
            for k in (0.5, 2.0, 5.0, 10.0, 20.0)
            if k * tau_s < 4
        ]
    )
    coarse, fine = (
        averages(starts(parameters.shape[1]), parameters, 50.0, 50.0, fineness)
        for fineness in (1.0, 2.0)
    )
    assert np.abs(np.abs(coarse.omega_mean) - np.abs(fine.omega_mean)).max() < 5e-9
    assert np.abs(coarse.omega_std - fine.omega_std).max() < 5e-9


def test_a_wheel_without_friction_is_followed_though_it_gets_ever_faster():
    parameters = columns([Wheel(k=5.0, f=0.0)])
    coarse, fine = (averages(starts(1), parameters, 0.0, 30.0, fineness) for fineness in (1.0, 2.0))
    assert abs(coarse.states[OMEGA, 0]) > 20.0
    assert coarse.omega_mean[0] == pytest.approx(fine.omega_mean[0], abs=1e-7)


def test_no_wheels_are_no_trouble():
    assert advance(np.empty((4, 0)), np.empty((6, 0)), 1.0).shape == (4, 0)


@pytest.mark.parametrize("wheel", [Wheel(tau=1e-7), Wheel(I=1e-9), Wheel(k=math.nan)])
def test_a_stiff_wheel_is_refused_by_name(wheel):
    parameters = columns([Wheel(), wheel])
    with pytest.raises(
        WrongUse, match=rf"tau = {wheel.tau:g}, k = {wheel.k:g}, I = {wheel.I:g}"
    ) as refusal:
        averages(starts(2), parameters, 10.0, 10.0)
    assert "larger tau" in refusal.value.hint


def test_a_wheel_that_runs_away_is_refused():
    with pytest.raises(WrongUse, match="ran away"):
        averages(starts(1, (1.0, 0.0, 0.0, 1e300)), columns([Wheel()]), 0.0, 1.0)
    with pytest.raises(WrongUse, match="ran away"):
        advance(starts(1, (1.0, 0.0, math.nan, 1.0)), columns([Wheel()]), 1.0)


def test_states_that_are_none_of_these_wheels_are_refused():
    for states in (starts(2), starts(1)[:3], starts(1, (1.0, 0.0, 0.0, math.inf))):
        with pytest.raises(WrongUse, match=r"shapes|finite"):
            averages(states, columns([Wheel()]), 0.0, 1.0)
