"""Numbers of summaries are roots, not points of a grid: against other methods."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure
from scipy.optimize import brentq, fsolve

from host.perform.run import perform
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis.hopf import bautin_tau_s
from host.theory.analysis.sure_kicks import sure_ranges
from host.theory.engine.kicked import Continuous
from host.theory.model.turning import constant_velocity
from host.theory.model.wheel import OMEGA, PHI, Wheel
from host.theory.studies import branch
from host.theory.studies.registry import TABLE
from robot.kicks import POSITION
from tests.paper.theory import independent
from tests.paper.theory.table import rows_of

SLOW = Wheel(tau=1.2)


def k_of_cycle(amplitude, wheel, harmonics=16):
    """The k at which a wheel swings as phi = amplitude sin + higher waves, by harmonic balance."""
    count = 4 * harmonics
    phase = 2 * np.pi * np.arange(count) / count
    # By symmetry phi and x2 have odd harmonics, and x1 even ones.
    orders = np.arange(1, harmonics, 2)

    def rebuilt(coefficients):
        return sum(
            c * np.cos(n * phase) + s * np.sin(n * phase)
            for n, c, s in zip(orders, *np.split(coefficients, 2), strict=True)
        )

    def slope(values, frequency):
        spectrum = np.fft.rfft(values) * 1j * np.arange(count // 2 + 1) * frequency
        return np.fft.irfft(spectrum, count)

    def lagged(values, frequency):
        waves = np.fft.rfft(values) / (1 + 1j * np.arange(count // 2 + 1) * frequency * wheel.tau)
        return np.fft.irfft(waves, count)

    def residual(unknowns):
        k, frequency, *rest = unknowns
        cosines, sines = np.split(amplitude * np.array(rest), 2)
        phi = rebuilt(np.concatenate([[0.0], cosines, [amplitude], sines]))
        omega = slope(phi, frequency)
        y = np.array([lagged(np.cos(phi), frequency), lagged(np.sin(phi), frequency), phi, omega])
        off = slope(omega, frequency) - independent.rates(y, wheel._replace(k=k))[3]
        waves = np.fft.rfft(off)[orders] / amplitude
        return np.concatenate([waves.real, waves.imag])

    hopf_k, hopf_omega = independent_hopf(wheel)
    return fsolve(residual, [hopf_k, hopf_omega, *np.zeros(2 * len(orders) - 2)], xtol=1e-12)[0]


def independent_hopf(wheel):
    def growth(k):
        values = np.linalg.eigvals(independent.jacobian([1.0, 0.0, 0.0, 0.0], wheel._replace(k=k)))
        return values.real.max()

    k = brentq(growth, 1e-3, 20.0, xtol=1e-15)
    values = np.linalg.eigvals(independent.jacobian([1.0, 0.0, 0.0, 0.0], wheel._replace(k=k)))
    return k, values.imag.max()


def curvature(tau_s):
    """d2k/dA2 of the cycles at their birth: 0 where l1 is 0."""
    wheel = Wheel(tau=tau_s)
    at_birth = independent_hopf(wheel)[0]
    near, far = ((k_of_cycle(size, wheel) - at_birth) / size**2 for size in (0.05, 0.1))
    return (4 * near - far) / 3


def test_cycles_cease_to_be_born_stable_where_harmonic_balance_says():
    low, high = (curvature(tau_s) for tau_s in (1.42, 1.45))
    assert low > 0.0 > high
    root = brentq(curvature, 1.42, 1.45, xtol=1e-7)
    assert bautin_tau_s(Wheel(), 1.3, 1.5) == pytest.approx(root, abs=2e-5)
    assert bautin_tau_s(Wheel(), 1.3, 1.5) == pytest.approx(1.43435, abs=5e-6)


@pytest.mark.parametrize("tau", [0.25, 0.6])
def test_the_study_names_the_same_root_whatever_its_grid(tau, monkeypatch):
    monkeypatch.setattr("host.figures.theory.hopf.draw", lambda rows, findings: Figure())
    (found,) = perform("hopf", out="here", tau=tau)["numbers"]["l1_changes_sign_at_tau"]
    assert found == pytest.approx(bautin_tau_s(Wheel(), 1.3, 1.5), abs=1e-9)


@pytest.fixture(scope="module")
def slow():
    setting = Setting(1, complete_options("branch", TABLE["branch"], {"tau": 1.2, "to": 6.0}))
    rows = rows_of(branch, setting, ("fixpoints", "merging", "LLM", "turning"))
    return branch.report(rows, setting)


def rotation_by_scipy(k):
    wheel = SLOW._replace(k=k)
    begin = independent.turning(wheel)
    return *independent.rotation(wheel, begin), wheel


def test_the_formula_is_within_5_percent_exactly_where_scipy_says_so(slow):
    def beyond(k):
        _, quarter_s, wheel = rotation_by_scipy(k)
        return constant_velocity(wheel) * quarter_s / (np.pi / 2) - 1.05

    ((low, high),) = slow.numbers["formula_within_5_percent"]
    assert low == pytest.approx(brentq(beyond, 2.3, 2.5, xtol=1e-10), abs=1e-8)
    point = next(
        point for point in slow.numbers["special_points"] if point["type"] == "neimark-sacker"
    )
    assert high == point["k"]


def test_the_stable_part_ends_at_a_neimark_sacker_point_that_is_named(slow):
    ((_, high),) = slow.numbers["formula_within_5_percent"]
    assert high == pytest.approx(4.64741, abs=5e-6)
    state, quarter_s, wheel = rotation_by_scipy(high)
    pair = independent.multipliers(state, quarter_s, wheel)[:2]
    assert abs(pair) == pytest.approx(1.0, abs=1e-7)
    assert abs(pair.imag).min() > 0.1
    m6 = next(claim for claim in slow.claims if claim.id == "M6")
    assert "the end of its stable part, at a Neimark-Sacker point" in m6.note


def test_branches_end_at_the_merging_itself(slow):
    merging = slow.numbers["k_merge"]
    ends = {end["way"]: end for end in slow.numbers["ends"] if end["branch"] == "LLM"}
    assert (ends["down"]["end"], ends["down"]["k"]) == ("merging", merging)
    assert ends["up"]["k"] == pytest.approx(6.0, rel=1e-12)


def reverse(states, length_s, wheel):
    """Which wheels with inverted positions for some seconds roll backward in the end, (wheels,)."""

    def free(y):
        return independent.rates(y.reshape(states.shape), wheel).ravel()

    def kicked(y):
        rate, phi = free(y).reshape(states.shape), y.reshape(states.shape)[PHI]
        rate[:2] -= 2 * np.array([np.cos(phi), np.sin(phi)]) / wheel.tau
        return rate.ravel()

    after = independent.end_of(kicked, states.ravel(), length_s, 1e-10, 1e-11)
    return independent.end_of(free, after, 4.0, 1e-8, 1e-13).reshape(states.shape)[OMEGA] < 0.0


def test_the_shortest_sure_kick_is_at_the_edge_that_scipy_finds():
    """At the worst phase a kick that is shorter by some microseconds does not reverse."""
    wheel = Wheel(k=8.0)
    found = sure_ranges(Continuous(), wheel, POSITION, 0, [0.0, 0.135, 0.145, 0.15], 60)
    ((shortest_s, longest_s),) = found
    assert longest_s == 0.15
    begin = independent.turning(wheel)
    state, quarter_s = independent.rotation(wheel, begin)
    later_s = np.linspace(0.0, quarter_s, 60, endpoint=False)
    states = independent.follow(state, wheel, quarter_s, t_eval=later_s).y
    assert reverse(states, shortest_s + 1e-5, wheel).all()
    assert not reverse(states, shortest_s - 3e-5, wheel).all()
