"""M1 to M3: the resting wheel, and where it begins to swing."""

from __future__ import annotations

from math import inf, pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.errors import WrongUse
from host.theory.analysis.fixpoints import ANGLES, fixpoint, fixpoints, growth_by_time_course
from host.theory.analysis.hopf import adaptive_friction, by_eigenvalues, critical_k, estimate, hopf
from host.theory.analysis.trajectories import limit_cycle, phase_of_cycle
from host.theory.model.symbolic import jacobian_at, jacobian_by_differences
from host.theory.model.wheel import OMEGA, PHI, Wheel, numpy_rates, rates, resting
from robot.controller import target_position

WHEELS = st.builds(
    Wheel,
    a=st.floats(0.5, 12.0),
    tau=st.floats(0.01, 3.0),
    k=st.floats(0.05, 20.0),
    I=st.floats(0.005, 1.0),
    f=st.floats(0.02, 3.0),
    dry_friction=st.just(0.0),
    bounded=st.just(inf),
    rods=st.just(2.0),
    own=st.just(0.0),
)


@given(WHEELS)
def test_all_eight_are_at_rest_and_there_are_no_others(wheel):
    for phi in ANGLES:
        assert np.abs(rates(*resting(np.array([phi]))[:, 0], *wheel)).max() < 1e-12 / wheel.I
    angles = (np.arange(4000) + 0.5) * 2 * pi / 4000
    force = numpy_rates(*resting(angles), *wheel)[OMEGA]
    assert np.count_nonzero(np.sign(force) != np.sign(np.roll(force, 1))) == 8


@given(WHEELS)
def test_even_ones_have_the_polynomial_that_can_be_derived_by_hand(wheel):
    """I tau l^3 + (I + f tau) l^2 + (f - k S tau) l + k (a/2 - S), and -1/tau."""
    a, tau, k, inertia, friction, *_ = wheel
    saturation = target_position(1.0, a)
    by_hand = np.roots(
        [
            inertia * tau,
            inertia + friction * tau,
            friction - k * saturation * tau,
            k * (a / 2 - saturation),
        ]
    )
    expected = np.sort_complex(np.append(by_hand, -1 / tau))
    scale = np.abs(expected).max()
    for n in (0, 2, 4, 6):
        found = np.sort_complex(fixpoint(ANGLES[n], wheel).eigenvalues)
        assert np.poly(found) == pytest.approx(np.poly(expected), rel=1e-8, abs=1e-9 * scale**4)


@given(WHEELS)
def test_odd_ones_are_saddles_and_even_ones_stable_just_below_the_hopf_line(wheel):
    found = fixpoints(wheel)
    for point in found[1::2]:
        assert point.kind == "saddle"
        assert np.count_nonzero(point.eigenvalues.real > 0) == 1
    for factor, stable in ((0.99, True), (1.01, False)):
        near = wheel._replace(k=factor * critical_k(wheel))
        assert [point.stable for point in fixpoints(near)[::2]] == [stable] * 4


@pytest.mark.parametrize(
    ("k", "tau", "even"),
    [
        (1.4, 0.25, "stable focus"),
        (2.0, 0.25, "unstable focus"),
        (15.0, 1.0, "unstable node"),
        (0.01, 0.25, "stable node"),
    ],
)
def test_a_saddle_grows_in_one_direction_and_an_unstable_node_in_two(k, tau, even):
    found = fixpoints(Wheel(k=k, tau=tau))
    assert [point.kind for point in found] == 4 * [even, "saddle"]


@given(WHEELS)
@settings(max_examples=30)
def test_the_jacobian_is_that_of_the_rates_anywhere(wheel):
    state = (0.3, -0.7, 1.1, 2.3)
    exact = jacobian_at(state, wheel)
    assert exact == pytest.approx(
        jacobian_by_differences(state, wheel), rel=1e-5, abs=1e-6 * np.abs(exact).max()
    )


@pytest.mark.parametrize("k", [1.4, 1.85, 8.0])
def test_disturbances_grow_in_time_as_the_eigenvalues_say(k):
    wheel = Wheel(k=k)
    for phi in ANGLES[:2]:
        found = fixpoint(phi, wheel)
        assert growth_by_time_course(found, wheel) == pytest.approx(
            found.eigenvalues[0].real, abs=1e-6
        )


@given(WHEELS)
@settings(max_examples=30)
def test_the_closed_form_is_where_eigenvalues_cross_the_axis(wheel):
    assert by_eigenvalues(wheel) == pytest.approx(hopf(wheel).k, rel=1e-9)
    crossing = fixpoint(0.0, wheel._replace(k=hopf(wheel).k)).eigenvalues
    assert np.abs(crossing.imag).max() == pytest.approx(hopf(wheel).omega, rel=1e-7)


def test_the_papers_estimate_is_the_limit_of_little_friction_or_fast_neurons():
    ratios = [
        estimate(wheel) / hopf(wheel).k
        for wheel in (Wheel(tau=tau_s) for tau_s in (1e-4, 1e-3, 1e-2, 0.25))
    ]
    assert ratios == sorted(ratios, reverse=True)
    assert ratios[0] == pytest.approx(1.0, abs=1e-3)
    # f / I = 10/s: at the paper's tau the estimate is far off.
    assert ratios[-1] == pytest.approx(0.63, abs=0.005)


def test_the_expansions_friction_changes_sign_at_the_estimate():
    wheel = Wheel()
    for factor, sign in ((0.999, -1), (1.001, 1)):
        own = wheel._replace(k=factor * estimate(wheel))
        greatest = max(adaptive_friction(phi, own) for phi in np.linspace(0, 2 * pi, 721))
        assert np.sign(greatest) == sign
        assert greatest == adaptive_friction(0.0, own)


def test_a_cycle_just_above_is_as_large_as_the_lyapunov_coefficient_says():
    """It converges slowly there: exp(-2 mu t), with mu = 0.005/s times the part of k beyond."""
    found = hopf(Wheel())
    near = Wheel(k=1.01 * found.k)
    point = fixpoint(0.0, near)
    critical = fixpoint(0.0, near._replace(k=found.k))
    share = abs(critical.eigenvectors[PHI, 0]) / np.linalg.norm(critical.eigenvectors[:, 0])
    predicted = 2 * share * np.sqrt(point.eigenvalues[0].real / (-found.l1 * found.omega))
    swing = limit_cycle(near)
    assert phase_of_cycle(swing) == "FB"
    assert np.ptp(swing[:, PHI]) / 2 == pytest.approx(predicted, rel=0.03)


def test_slow_neurons_bear_unstable_cycles_so_that_a_wheel_jumps_away():
    below, above = hopf(Wheel(tau=1.0)), hopf(Wheel(tau=3.0))
    assert below.l1 < 0.0 < above.l1
    swing = limit_cycle(Wheel(tau=3.0, k=1.005 * above.k))
    assert phase_of_cycle(swing) != "FB" or np.ptp(swing[:, PHI]) > 1.0


@pytest.mark.parametrize(("change", "letter"), [({"k": 0.0}, "k = 0"), ({"a": 0.0}, "a = 0")])
def test_a_wheel_that_nothing_pulls_has_no_fixpoints_of_its_own(change, letter):
    with pytest.raises(WrongUse, match=letter):
        fixpoints(Wheel()._replace(**change))


@pytest.mark.parametrize("change", [{"f": 0.0}, {"a": 0.0}])
def test_where_there_is_no_hopf_bifurcation_one_is_told_so(change):
    with pytest.raises(WrongUse, match="no Hopf"):
        hopf(Wheel()._replace(**change))


@pytest.mark.parametrize(
    "change",
    [
        {"tau": 0.0},
        {"I": -1.0},
        {"k": float("nan")},
        {"a": 1e4},
        {"f": float("inf")},
    ],
)
def test_constants_of_no_wheel_are_refused_by_name(change):
    with pytest.raises(WrongUse, match=next(iter(change))):
        Wheel()._replace(**change).checked()
