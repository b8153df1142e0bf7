"""Noise on a wheel, against laws that are known exactly, and against steps in numpy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, trapezoid

from host.errors import WrongUse
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis.escape_times import arrhenius, levels, stay
from host.theory.engine.noise import FAR, NEVER, WELL, Noise, escapes, seeds_of
from host.theory.model.wheel import OMEGA, PHI, Wheel, resting
from host.theory.studies import escape
from host.theory.studies.registry import TABLE
from tests.paper.theory import independent
from tests.paper.theory.table import rows_of

FREE = Wheel(k=0.0)
SMALL = complete_options("escape", TABLE["escape"], {"wheels": 8, "seconds": 20.0, "noise": 0.2})


def seeds(count, seed=5):
    return seeds_of(np.random.default_rng(seed), count)


def at_rest(count):
    return resting(np.zeros(count))


def test_without_rods_the_speed_is_an_ornstein_uhlenbeck_process():
    """Its variance is D_M^2 / (2 f I), less what is missing after a short time."""
    count, noise = 4000, Noise(0.3, 0.2)
    memory_s = FREE.I / FREE.f
    for seconds in (memory_s / 2, 10 * memory_s):
        found = escapes(at_rest(count), FREE.columns(count), noise, seconds, seeds(count), NEVER)
        expected = 0.3**2 / (2 * FREE.f * FREE.I) * (1 - np.exp(-2 * seconds / memory_s))
        assert found.states[OMEGA].var() == pytest.approx(expected, rel=4 * (2 / count) ** 0.5)
        assert abs(found.states[OMEGA].mean()) < 4 * (expected / count) ** 0.5
        assert not found.ended.any()


def test_an_angle_that_diffuses_leaves_after_its_exact_mean_time():
    """L^2 / D_phi^2, from the middle of an interval of half length L."""
    count, noise = 2000, Noise(0.0, 0.5)
    found = escapes(at_rest(count), FREE.columns(count), noise, 300.0, seeds(count), WELL)
    own = stay(found.time_s, found.ended)
    assert own.escapes == count
    # Times are less spread than exponential ones: sqrt(2/3) of the mean.
    assert own.mean_s == pytest.approx(FAR**2 / 0.5**2, rel=4 * (2 / 3 / count) ** 0.5)


def test_escapes_from_a_potential_take_the_time_of_kramers():
    """Fast neurons and a light wheel: the angle diffuses in the potential of the rods.

    The mean time to leave an interval is then a double integral.
    """
    wheel, noise, count = Wheel(k=1.0, tau=3e-3, I=5e-3), Noise(0.2), 150
    phi = np.linspace(0.0, FAR, 1001)
    force = np.array(
        [independent.rates([np.cos(at), np.sin(at), at, 0.0], wheel)[3] * wheel.I for at in phi]
    )
    potential = -cumulative_trapezoid(force, phi, initial=0.0)
    warmth = noise.torque**2 / (2 * wheel.f)
    inner = cumulative_trapezoid(np.exp(-potential / warmth), phi, initial=0.0)
    exact_s = trapezoid(np.exp(potential / warmth) * inner, phi) * wheel.f / warmth
    found = escapes(at_rest(count), wheel.columns(count), noise, 500.0, seeds(count), WELL)
    own = stay(found.time_s, found.ended)
    assert own.low_s < exact_s < own.high_s


def test_wheels_escape_as_steps_in_numpy_have_it():
    """Euler and Maruyama's method, written for the test, with steps of a tenth."""
    wheel, count, step_s = Wheel(k=1.65), 400, 1e-3
    rng, y, left = np.random.default_rng(2), at_rest(count), np.full(count, np.nan)
    for step in range(20_000):
        y = y + step_s * independent.rates(y, wheel)
        y[OMEGA] += 0.2 / wheel.I * step_s**0.5 * rng.normal(size=count)
        left[np.isnan(left) & (abs(y[PHI]) > FAR)] = step * step_s
        if not np.isnan(left).any():
            break
    found = escapes(at_rest(count), wheel.columns(count), Noise(0.2), 100.0, seeds(count), WELL)
    error = (left.var() / count + found.time_s.var() / count) ** 0.5
    assert found.ended.all()
    assert abs(found.time_s.mean() - left.mean()) < 3 * error


def test_the_same_seeds_give_the_same_numbers_in_any_company():
    all_seeds = seeds(6)
    parameters = Wheel(k=1.65).columns(6)
    whole = escapes(at_rest(6), parameters, Noise(0.2, 0.1), 5.0, all_seeds, WELL)
    part = escapes(at_rest(2), parameters[:, 4:], Noise(0.2, 0.1), 5.0, all_seeds[4:], WELL)
    assert np.array_equal(whole.states[:, 4:], part.states)
    assert len(set(whole.states[PHI].tolist())) == 6


def test_an_interval_holds_the_rate_of_exponential_times_as_often_as_it_says():
    rng = np.random.default_rng(3)
    hits = 0
    for _ in range(300):
        times = rng.exponential(10.0, 20)
        own = stay(np.minimum(times, 15.0), times < 15.0)
        hits += own.low_s < 10.0 < own.high_s
    assert 0.91 < hits / 300 < 0.985
    assert stay(np.full(4, 5.0), np.zeros(4, dtype=bool))[:2] == (0, None)


def test_the_law_is_recovered_from_times_that_follow_it():
    strengths = np.array([noise.torque for noise in levels(Noise(0.2), 5, 3.0)])
    stays = [
        stay(np.full(50, 7.0 * np.exp(0.04 / own**2)), np.ones(50, dtype=bool)) for own in strengths
    ]
    fit = arrhenius(strengths, stays)
    assert (fit.barrier, fit.prefactor_s) == pytest.approx((0.04, 7.0))
    assert fit.misfit == pytest.approx(0.0, abs=1e-12)
    assert arrhenius(strengths[:1], stays[:1]) is None


def test_the_study_measures_how_long_a_wheel_rolls_one_way_and_says_its_seed():
    setting = Setting(7, SMALL | {"start": "roll", "k": 1.9})
    rows = rows_of(escape, setting)
    numbers = escape.report(rows, setting).numbers
    assert numbers["seed"] == 7
    assert [level["wheels"] for level in numbers["levels"]] == [8] * escape.LEVELS
    first = numbers["levels"][0]
    assert first["low_s"] < first["mean_s"] < first["high_s"]
    shown = escape.report(rows, setting).answers[0]
    assert shown.error == pytest.approx((first["high_s"] - first["low_s"]) / (2 * 1.96), rel=1e-4)
    assert "standard errors" in TABLE["escape"].help
    cell = escape.cells(setting.options)[0]
    assert escape.simulate(cell, setting) == escape.simulate(cell, setting)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"noise": 0.0}, "without noise no wheel escapes"),
        ({"start": "roll"}, "does not go on rolling"),
        ({"k": 8.0}, "rolls away"),
        ({"k": 15.0, "tau": 1.0}, "chaotic"),
        ({"I": 1e-9}, "steps"),
    ],
)
def test_what_has_no_escape_is_refused_before_work_begins(changed, words):
    with pytest.raises(WrongUse, match=words):
        escape.cells(SMALL | {"k": 1.4} | changed)
