"""Exponents with errors: how often intervals hold what is known, and what they say of a wheel."""

from __future__ import annotations

import numpy as np
import pytest

from host.theory.analysis.attractors import random_starts, settle
from host.theory.analysis.spectrum import exponents, mean, quantile
from host.theory.model.wheel import Wheel
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_report import spectrum, verdict_of
from tests.paper.theory import independent


def covered(values, truth, wheels):
    """The share of runs, (runs, wheels, blocks), whose 95 % interval holds the truth."""
    found = [mean(run) for run in values]
    return np.mean([abs(one.value - truth) < quantile(wheels, 0.95) * one.error for one in found])


@pytest.mark.parametrize("memory", [0.0, 0.9, -0.45])
def test_intervals_hold_the_truth_as_often_as_they_say(memory):
    """Noise, noise that remembers, and the difference of a quantity that stays bounded."""
    rng = np.random.default_rng(5)
    noise = rng.normal(size=(400, 16, 60))
    if memory < 0.0:
        noise = np.diff(noise, axis=2)
    elif memory:
        for step in range(1, 60):
            noise[:, :, step] += memory * noise[:, :, step - 1]
    assert 0.92 < covered(noise + 0.3, 0.3, 16) < 0.975


def test_the_exponent_along_the_flow_is_0_within_its_error():
    """Of chaotic wheels it is known: 24 runs of 8 wheels each."""
    wheel, runs, own = Wheel(k=15.0, tau=1.0), 24, 8
    parameters = wheel.columns(runs * own)
    begin = settle(random_starts(runs * own, np.random.default_rng(4)), parameters, 100.0)
    every = np.ones(runs * own, dtype=bool)
    found = exponents(begin, parameters, 5.0, 30.0, 3, every, ~every).blocks
    along = found[:, 0].T.reshape(runs, own, 3)
    share = covered(along, 0.0, own)
    assert share >= 20 / 24
    scores = np.array([one.value / one.error for one in map(mean, along)])
    assert 0.6 < np.sqrt(np.mean(scores**2)) < 1.7
    assert found.sum(axis=1).mean() == pytest.approx(-12.0, abs=1e-4)


def point_of(k, tau_s, seconds):
    wheel = Wheel(k=k, tau=tau_s)
    found = pieces.spectrum_in_blocks(wheel, seconds, np.random.default_rng(1))
    return spectrum([{"batch": 0, "seconds": seconds, **row} for row in found], wheel)


@pytest.fixture(scope="module")
def point():
    return point_of(12.0, 0.6, 150.0)


def test_two_positive_exponents_are_called_hyperchaotic(point):
    assert verdict_of(point) == "hyperchaotic"
    assert point["exponents"][1] == pytest.approx(0.06, abs=0.03)
    assert abs(point["along_flow"]) < 5 * point["along_flow_error"]
    # The third is the one along the flow.
    assert point["exponents"][2] == point["along_flow"]


def test_the_first_two_exponents_are_those_that_scipy_finds(point):
    """The area that two vectors span grows with their sum, in whatever directions they are."""
    wheel = Wheel(k=12.0, tau=0.6)
    rng = np.random.default_rng(8)
    rates = []
    for _ in range(3):
        y = independent.last(rng.normal(size=4), wheel, 30.0, rtol=1e-8)
        rates.append(independent.growth_of_area(y, wheel, 25.0, rng))
    first = sum(point["exponents"][:2])
    assert np.mean(rates) == pytest.approx(first, abs=0.2)


@pytest.mark.parametrize(
    ("k", "verdict"), [(1.4, "at rest"), (1.65, "forth-and-back"), (8.0, "rolling")]
)
def test_exponents_of_regular_wheels_are_those_of_their_eigenvalues_and_multipliers(
    monkeypatch, k, verdict
):
    monkeypatch.setattr(pieces, "WHEELS", 4)
    point = point_of(k, 0.25, 100.0)
    assert verdict_of(point) == verdict
    if verdict == "at rest":
        values = np.linalg.eigvals(independent.jacobian([1.0, 0.0, 0.0, 0.0], Wheel(k=k)))
        assert point["exponents"] == pytest.approx(sorted(values.real, reverse=True), abs=2e-3)
    else:
        assert point["exponents"][0] == pytest.approx(0.0, abs=1e-6)
    if verdict == "rolling":
        state, quarter_s = independent.rotation(Wheel(k=k), independent.turning(Wheel(k=k)))
        rates = np.log(abs(independent.multipliers(state, quarter_s, Wheel(k=k)))) / quarter_s
        assert point["exponents"][1:] == pytest.approx(rates, abs=1e-3)
