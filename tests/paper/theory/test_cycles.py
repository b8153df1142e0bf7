"""Cycles of the analytic model by continuation.

Exact limits, symmetry, scaling, another integrator, and what is not to be found.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from host.errors import NotDone, WrongUse
from host.theory.analysis.bifurcations import (
    FOLD,
    LOST,
    MERGING,
    NEIMARK_SACKER,
    PITCHFORK,
    RANGE,
    follow,
)
from host.theory.analysis.branches import hopf_values, rotation, rotations, swings, turning_state
from host.theory.analysis.continuation import Curve, Point
from host.theory.analysis.cycles import FORTH_AND_BACK, ROTATION, Family, Shooting
from host.theory.analysis.hopf import hopf
from host.theory.analysis.merging import course, merging, mergings, neutral_tau_s, passes
from host.theory.model.turning import constant_velocity, driven, potentials
from host.theory.model.wheel import OMEGA, PHI, Wheel, rates

PAPER = Wheel()


def types(branch):
    return [found.type for way in branch.ways for found in way.bifurcations]


def rolls_by_scipy(wheel):
    start = course(wheel, near=1e-6)[1][:, 0]

    def turned_back(_, state):
        return state[OMEGA]

    def passed(_, state):
        return state[PHI] - np.pi / 2

    turned_back.terminal = passed.terminal = True
    turned_back.direction = -1
    run = solve_ivp(
        lambda _, y: rates(*y.tolist(), *wheel),
        (0.0, 60.0),
        start,
        "DOP853",
        events=(turned_back, passed),
        rtol=1e-12,
        atol=1e-14,
    )
    return len(run.t_events[1]) > 0


@pytest.fixture(scope="module")
def k_merge():
    """Where swinging and rolling merge at the paper's constants."""
    return merging(PAPER).k


@pytest.fixture(scope="module")
def swinging():
    return swings(PAPER, "k", 0.02, 20.0)[0]


@pytest.fixture(scope="module")
def rolling_8():
    wheel = PAPER._replace(k=8.0)
    return rotation(wheel, turning_state(wheel)).unknowns


# The global bifurcation


def test_another_integrator_finds_the_merging_between_the_same_wheels(k_merge):
    assert [rolls_by_scipy(PAPER._replace(k=k_merge * (1 + off))) for off in (-1e-9, 1e-9)] == [
        False,
        True,
    ]


def test_the_merging_lies_between_the_papers_portraits_and_does_not_depend_on_how_it_is_sought(
    k_merge,
):
    assert hopf(PAPER).k < 1.65 < k_merge < 1.85
    for how in ({"near": 1e-5}, {"near": 1e-7}, {"fineness": 5.0}):
        (found,) = mergings(PAPER, 1.7, 1.9, points=2, **how)
        assert found.k == pytest.approx(k_merge, rel=1e-13)


def test_slower_wheels_and_stronger_forces_merge_at_the_same_place_in_their_own_units(k_merge):
    slower = merging(PAPER._replace(tau=3 * 0.25, I=9 * 0.05, f=3 * 0.5))
    stronger = merging(PAPER._replace(I=7 * 0.05, f=7 * 0.5))
    assert slower.k == pytest.approx(k_merge, rel=1e-12)
    assert 3 * slower.saddle_quantity == pytest.approx(merging(PAPER).saddle_quantity, rel=1e-9)
    assert stronger.k == pytest.approx(7 * k_merge, rel=1e-12)


def test_the_saddles_eigenvalues_add_up_to_the_divergence_and_one_is_that_of_the_decoupled_sum():
    eigenvalues = merging(PAPER).eigenvalues
    assert eigenvalues.sum() == pytest.approx(-2 / 0.25 - 0.5 / 0.05)
    assert np.abs(eigenvalues + 1 / 0.25).min() < 1e-9


def test_along_friction_wheels_roll_below_the_merging_and_it_is_the_same_one(k_merge):
    (found,) = mergings(PAPER._replace(k=k_merge), 0.3, 0.9, "f", points=4)
    assert found.wheel.f == pytest.approx(0.5, rel=1e-12)
    assert not found.passes_above


def test_a_wheel_that_creeps_from_the_saddle_does_not_pass_and_takes_no_integration():
    slow = PAPER._replace(k=8.0, a=0.155)
    assert not passes(slow)
    with pytest.raises(WrongUse, match="steps"):
        course(slow)
    assert passes(slow._replace(a=0.6))


def test_the_saddle_quantity_changes_its_sign_between_the_time_constants_without_and_with_folds():
    tau_s = neutral_tau_s(PAPER, 0.4, 0.43)
    assert abs(merging(PAPER._replace(tau=tau_s)).saddle_quantity) < 1e-8
    assert neutral_tau_s(PAPER, 0.25, 0.3) is None
    assert merging(PAPER).saddle_quantity < 0.0 < merging(PAPER._replace(tau=1.0)).saddle_quantity


def test_too_little_k_does_not_pass_and_wheels_without_friction_or_springs_are_refused():
    assert not passes(PAPER._replace(k=1e-6))
    for nothing in ({"f": 0.0}, {"a": 0.0}):
        with pytest.raises(WrongUse):
            passes(PAPER._replace(**nothing))
    with pytest.raises(WrongUse, match="steps"):
        merging(PAPER._replace(I=1e-9))


# Cycles and their multipliers


@pytest.mark.parametrize("family", [FORTH_AND_BACK, ROTATION], ids=lambda family: family.name)
@pytest.mark.parametrize("along", ["k", "tau"])
def test_shooting_knows_its_derivatives(family, along):
    shooting = Shooting(PAPER._replace(k=2.0), family, along)
    unknowns = np.array([0.6, -0.4, 2.0, 0.7, getattr(shooting.wheel, along)])
    for column in range(5):
        step = np.zeros(5)
        step[column] = 1e-5
        difference = (shooting(unknowns + step)[0] - shooting(unknowns - step)[0]) / 2e-5
        assert shooting(unknowns)[1][:, column] == pytest.approx(difference, abs=1e-7)


def test_multipliers_of_the_whole_period_are_powers_of_those_of_the_piece_that_symmetry_repeats(
    swinging, rolling_8
):
    cycle = next(point.unknowns for point in swinging.ways[0].points if point.unknowns[4] > 1.7)
    for shooting, unknowns in ((swinging.shooting, cycle), (Shooting(PAPER, ROTATION), rolling_8)):
        family = shooting.family
        whole = Family("whole", np.eye(4), family.power * family.turn, 1.0)
        period = unknowns * [1.0, 1.0, 1.0, family.power, 1.0]
        assert np.abs(Shooting(PAPER, whole)(period)[0]).max() < 1e-9
        found = Shooting(PAPER, whole).multipliers(period)
        assert np.sort_complex(found) == pytest.approx(
            np.sort_complex(shooting.multipliers(unknowns) ** family.power), abs=1e-9
        )


def test_the_product_of_multipliers_is_that_of_the_constant_divergence(rolling_8):
    product = np.prod(Shooting(PAPER, ROTATION).multipliers(rolling_8))
    assert product == pytest.approx(np.exp(-(2 / 0.25 + 0.5 / 0.05) * rolling_8[3]), rel=1e-10)


def test_scipy_brings_a_rotation_back_after_a_turn(rolling_8):
    x1, x2, omega, quarter_s, k = rolling_8
    wheel = PAPER._replace(k=k)
    end = solve_ivp(
        lambda _, y: rates(*y.tolist(), *wheel),
        (0.0, 4 * quarter_s),
        [x1, x2, 0.0, omega],
        "DOP853",
        rtol=1e-12,
        atol=1e-13,
    ).y[:, -1]
    assert end == pytest.approx([x1, x2, 2 * np.pi, omega], abs=1e-9)


def test_the_mirror_image_of_a_rotation_is_one_backward(rolling_8):
    x1, x2, omega, quarter_s, k = rolling_8
    backward = Family("backward", ROTATION.back.T, -np.pi / 2, 4.0)
    assert (
        np.abs(Shooting(PAPER, backward)(np.array([x1, -x2, -omega, quarter_s, k]))[0]).max()
        < 1e-11
    )


def test_cycles_are_born_at_the_exact_hopf_bifurcation_and_grow_as_the_square_root(swinging):
    assert hopf_values(PAPER, "k", 0.02, 20.0) == pytest.approx([hopf(PAPER).k], rel=1e-12)
    small = swinging.ways[0].points[:12]
    size = np.array(
        [np.abs(swinging.shooting.path(point.unknowns)[:, PHI, 0]).max() for point in small]
    )
    beyond = np.array([point.unknowns[4] for point in small]) - hopf(PAPER).k
    assert np.log(beyond[-1] / beyond[0]) / np.log(size[-1] / size[0]) == pytest.approx(
        2.0, abs=0.02
    )
    assert np.pi / small[0].unknowns[3] == pytest.approx(hopf(PAPER).omega, rel=1e-3)


def test_both_branches_end_at_the_merging_from_their_own_side_without_bifurcations(
    swinging, k_merge
):
    branch = rotations(PAPER, "k", 1.0, 4.0)[0]
    assert types(swinging) == types(branch) == []
    assert [way.end for way in branch.ways] == [MERGING, RANGE]
    swing, roll = (
        swinging.ways[0].points[-1].unknowns[4] / k_merge - 1,
        branch.ways[0].points[-1].unknowns[4] / k_merge - 1,
    )
    assert -1e-7 < swing < 0.0 < roll < 1e-7
    assert branch.ways[1].points[-1].unknowns[4] == pytest.approx(4.0, rel=1e-12)


def test_at_tau_of_a_second_there_are_folds_on_both_sides_and_a_neimark_sacker_point():
    wheel = PAPER._replace(tau=1.0)
    (swing,), (roll,) = swings(wheel, "k", 0.1, 6.0), rotations(wheel, "k", 0.3, 6.0)
    assert (types(swing), types(roll)) == ([FOLD], [FOLD, NEIMARK_SACKER])
    # AUTO-07p's value.
    assert swing.ways[0].bifurcations[0].point.unknowns[4] == pytest.approx(0.475056, abs=1e-6)
    pair = roll.shooting.multipliers(roll.ways[1].bifurcations[0].point.unknowns)[:2]
    assert np.abs(pair) == pytest.approx(1.0, abs=1e-9)


def test_dry_friction_makes_the_rotations_end_in_a_fold_above_a_homoclinic_end(k_merge):
    dry = PAPER._replace(dry_friction=0.1)
    (branch,), (end,) = rotations(dry, "k", 1.0, 4.0), mergings(dry, 1.0, 4.0)
    down = branch.ways[0]
    (fold,) = down.bifurcations
    assert (fold.type, down.end) == (FOLD, MERGING)
    assert k_merge < fold.point.unknowns[4] < end.k
    assert down.points[-1].unknowns[4] == pytest.approx(end.k, rel=1e-6)
    assert all(
        branch.shooting.path(point.unknowns)[:, OMEGA, 0].min() > 0.0 for point in down.points
    )
    # Below the fold nothing goes on rolling, above it does.
    for factor, goes_on in ((0.999, False), (1.001, True)):
        wheel = dry._replace(k=float(factor * fold.point.unknowns[4]))
        x1, x2, omega = fold.point.unknowns[:3]
        try:
            rotation(wheel, np.array([x1, x2, 0.0, 1.02 * omega]))
        except NotDone:
            assert not goes_on
        else:
            assert goes_on


# Continuation itself


def test_a_circle_is_followed_around_and_its_folds_are_located():
    def circle(unknowns):
        return np.array([unknowns @ unknowns - 1.0]), 2 * unknowns[None, :]

    curve = Curve(circle, np.ones(2))
    points = []
    for point in curve.follow(Point(np.array([0.0, -1.0]), np.array([1.0, 0.0])), 1e-4, 0.2):
        if points and points[-1].tangent[1] * point.tangent[1] < 0.0:
            fold = curve.locate(points[-1], point, lambda at: at.tangent[1])
            assert abs(fold.unknowns[1]) == pytest.approx(1.0, abs=1e-12)
            break
        points.append(point)
    assert max(point.unknowns[0] for point in points) > 0.99


def test_a_curve_that_ceases_to_exist_is_said_to_be_lost():
    def half(unknowns):
        if unknowns[1] > 1.0:
            raise NotDone("there is nothing", "")
        return unknowns[:1].copy(), np.array([[1.0, 0.0]])

    with pytest.raises(NotDone, match="followed"):
        for point in Curve(half, np.ones(2)).follow(
            Point(np.zeros(2), np.array([0.0, 1.0])), 1e-6, 0.1
        ):
            assert point.unknowns[1] <= 1.0


def test_a_search_that_comes_to_potentials_beyond_all_numbers_finds_no_cycle():
    far = np.array([-1000.0, 0.0, 10.0, 0.001, 4.0])
    with pytest.raises(NotDone, match="exponential"):
        Shooting(Wheel(k=3.0), ROTATION, "a")(far)


class Flipping(Shooting):
    """A straight branch, one of whose multipliers is minus its k; it ceases to exist at k = 2."""

    def __call__(self, unknowns):
        if unknowns[4] > 2.0:
            raise NotDone("there is nothing", "")
        return unknowns[:4] - [1.0, 0.0, 1.0, 0.1], np.eye(4, 5)

    def map_derivative(self, unknowns):
        return np.diag([-unknowns[4], 0.1, 0.01])


def test_a_multiplier_minus_one_of_the_reduced_map_is_a_pitchfork():
    flipping = Flipping(PAPER, FORTH_AND_BACK)
    found = follow(
        flipping,
        Curve(flipping, np.ones(5)),
        Point(np.array([1.0, 0.0, 1.0, 0.1, 0.5]), np.array([0.0, 0.0, 0.0, 0.0, 1.0])),
        0.1,
        20.0,
    )
    (bifurcation,) = found.bifurcations
    assert (bifurcation.type, found.end) == (PITCHFORK, LOST)
    assert bifurcation.point.unknowns[4] == pytest.approx(1.0, abs=1e-12)


# The constantly turning wheel


def test_a_wheel_that_is_turned_has_the_papers_potentials_in_either_direction():
    phi = np.linspace(0.0, 2 * np.pi, 9)
    for omega, tau_s in ((9.8, 0.25), (0.3, 1.0)):
        assert driven(phi, omega, tau_s) == pytest.approx(
            np.array(potentials(phi, omega, tau_s)), abs=1e-9
        )
        assert np.array(potentials(-phi, -omega, tau_s)) == pytest.approx(
            np.array(potentials(phi, omega, tau_s)) * [[1], [-1]]
        )


def test_the_constant_velocity_formula_balances_the_papers_force_and_begins_at_its_k_c():
    wheel = PAPER._replace(k=8.0)
    lag = constant_velocity(wheel) * wheel.tau
    assert wheel.a * wheel.k * wheel.tau / 2 / (1 + lag**2) == pytest.approx(wheel.f)
    assert constant_velocity(PAPER._replace(k=1.0)) is None
    assert constant_velocity(PAPER._replace(k=1.0 + 1e-9)) < 1e-3
    assert constant_velocity(PAPER._replace(f=0.0)) is None


def test_rotations_approach_the_formula_as_k_grows():
    off = []
    for k in (4.0, 8.0, 40.0):
        wheel = PAPER._replace(k=k)
        off.append(
            constant_velocity(wheel)
            / (np.pi / 2 / rotation(wheel, turning_state(wheel)).unknowns[3])
            - 1
        )
    assert off[0] > off[1] > 0.05 > off[2] > 0.0


def test_a_wheel_below_the_merging_does_not_go_on_rolling():
    with pytest.raises(NotDone, match="rolling"):
        rotation(PAPER._replace(k=1.7), turning_state(PAPER))
