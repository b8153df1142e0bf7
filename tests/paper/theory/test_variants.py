"""Other wheels than the paper's: one rod, a bounded torque, and functions of the user."""

from __future__ import annotations

import re
from math import acos, exp, inf, pi, tanh

import numpy as np
import pytest
from scipy.optimize import brentq

from host.errors import WrongUse
from host.perform.catalogue import find
from host.runs.registry import complete_options
from host.theory.analysis.branches import rotation, turning_state
from host.theory.analysis.cycles import ROTATION, Shooting
from host.theory.analysis.fixpoints import fixpoints
from host.theory.analysis.hopf import by_eigenvalues, critical_k, hopf
from host.theory.analysis.outcomes import settle_and_classify, starting_states
from host.theory.analysis.tangent import growth, smooth_mean
from host.theory.analysis.trajectories import trajectory
from host.theory.engine import sampled
from host.theory.engine.crossings import crossings
from host.theory.engine.ensemble import advance
from host.theory.engine.kicked import Continuous, seen_in
from host.theory.engine.sampled import Clock
from host.theory.model.laws import has_symmetries, require_friction
from host.theory.model.symbolic import jacobian_at
from host.theory.model.wheel import PHI, Wheel
from host.theory.studies.registry import TABLE
from robot.kicks import POSITION
from tests.lint.sources import ROOT
from tests.paper.theory import independent

ONE_ROD, BOUNDED = Wheel(k=8.0, rods=1), Wheel(k=8.0, bounded=1.0)
START = np.array([0.3, -0.7, 0.4, 5.0])


def logistic(x, a):
    return 2.0 / (1.0 + exp(-a * x)) - 1.0


def papers_mechanics(torque, omega, inertia, friction, dry_friction):
    return (torque - friction * omega) / inertia


def lopsided(x, a):
    return exp(-a * x)


def drag(torque, omega, inertia, friction, dry_friction):
    """The drag of air."""
    return (torque - friction * omega * (omega * omega + 1.0) ** 0.5) / inertia


@pytest.fixture(scope="module")
def papers():
    """The paper's wheel, written by its user: all derivatives of it are by differences."""
    return Wheel(k=8.0).with_functions(logistic, papers_mechanics)


@pytest.mark.parametrize("wheel", [ONE_ROD, BOUNDED])
def test_a_wheel_moves_as_scipy_solves_its_equations(wheel):
    exact = independent.last(START, wheel, 2.0)
    assert trajectory(START, wheel, 2.0)[-1] == pytest.approx(exact, abs=1e-8)
    many = advance(np.tile(START[:, None], 20), wheel.columns(20), 2.0)
    assert many == pytest.approx(np.tile(exact[:, None], 20), abs=1e-7)
    differences = [
        (
            independent.rates(START + 1e-6 * unit, wheel)
            - independent.rates(START - 1e-6 * unit, wheel)
        )
        / 2e-6
        for unit in np.eye(4)
    ]
    assert pytest.approx(np.array(differences), abs=1e-5) == jacobian_at(START.tolist(), wheel).T


def test_one_rod_rests_where_it_pulls_at_a_right_angle_or_not_at_all():
    """sin phi = 0, cos phi = 0, or x_t(cos phi) = cos phi: tanh(a u / 2) = u."""
    u = brentq(lambda u: tanh(2.0 * u) - u, 0.5, 1.0, xtol=1e-15)
    expected = [0.0, acos(u), pi / 2, acos(-u), pi, pi + acos(u), 1.5 * pi, 2 * pi - acos(u)]
    found = fixpoints(Wheel(k=1.4, rods=1))
    assert [point.phi for point in found] == pytest.approx(expected, abs=1e-12)
    kinds = 2 * ["stable node", "saddle", "stable focus", "saddle"]
    assert [point.kind for point in found] == kinds
    assert len(fixpoints(Wheel(k=1.4, a=1.9, rods=1))) == 4


def test_one_rod_lets_go_of_a_wheel_at_a_right_angle():
    """Against eigenvalues of the equations as they are written for the test."""
    found, rest = hopf(ONE_ROD), np.array([0.0, 1.0, pi / 2, 0.0])

    def leading(k):
        wheel = ONE_ROD._replace(k=k)
        columns = [
            (
                independent.rates(rest + 1e-5 * unit, wheel)
                - independent.rates(rest - 1e-5 * unit, wheel)
            )
            / 2e-5
            for unit in np.eye(4)
        ]
        values = np.linalg.eigvals(np.array(columns).T)
        return values[values.imag > 0].max()

    k = brentq(lambda k: leading(k).real, 1.0, 3.0, xtol=1e-13)
    assert (found.k, found.omega, found.phi) == pytest.approx(
        (k, leading(k).imag, pi / 2), rel=1e-8
    )
    assert by_eigenvalues(ONE_ROD) == pytest.approx(found.k, rel=1e-12)
    assert critical_k(ONE_ROD._replace(a=2.0)) == inf
    with pytest.raises(WrongUse, match="single rod"):
        hopf(ONE_ROD._replace(a=2.0))


def test_a_bound_leaves_the_line_of_rest_and_makes_birth_softer():
    """To third order a bound takes F^3 / (3 M_max^2) off: l1 is linear in 1 / M_max^2."""
    paper, one, two = (hopf(Wheel(bounded=most)) for most in (inf, 1.0, 2.0))
    assert (one.k, one.omega) == (paper.k, paper.omega)
    assert one.l1 < two.l1 < paper.l1 < 0.0
    assert (one.l1 - paper.l1) / (two.l1 - paper.l1) == pytest.approx(4.0, rel=1e-9)


def test_a_bounded_wheel_rolls_as_scipy_finds_it():
    guess = trajectory(turning_state(BOUNDED), BOUNDED, 20.0)[-1]
    found = rotation(BOUNDED, turning_state(BOUNDED)).unknowns
    turned = guess[:2] @ np.array(
        [[np.cos(guess[2]), -np.sin(guess[2])], [np.sin(guess[2]), np.cos(guess[2])]]
    )
    state, seconds = independent.rotation(BOUNDED, np.array([*turned, 0.0, guess[3]]))
    assert found[[0, 1, 2, 3]] == pytest.approx([*state[[0, 1, 3]], seconds], rel=1e-8)
    assert found[2] < 1.0 / BOUNDED.f


def test_the_papers_wheel_written_by_a_user_gives_the_papers_numbers(papers):
    paper = Wheel(k=8.0)
    assert trajectory(START, papers, 2.0)[-1] == pytest.approx(
        trajectory(START, paper, 2.0)[-1], abs=1e-9
    )
    exact = jacobian_at(START.tolist(), paper)
    assert jacobian_at(START.tolist(), papers) == pytest.approx(exact, abs=1e-9)
    found, expected = hopf(papers), hopf(paper)
    assert found[:2] == pytest.approx(expected[:2], rel=1e-10)
    assert found.l1 == pytest.approx(expected.l1, rel=1e-4)
    assert [point.kind for point in fixpoints(papers)] == [point.kind for point in fixpoints(paper)]
    rolling = rotation(paper, turning_state(paper)).unknowns
    assert rotation(papers, turning_state(papers)).unknowns == pytest.approx(rolling, rel=1e-9)
    multipliers = [Shooting(wheel, ROTATION).multipliers(rolling) for wheel in (papers, paper)]
    assert multipliers[0] == pytest.approx(multipliers[1], abs=1e-9)
    starts = starting_states(np.array([0.1, 1.5, 3.0]), np.array([0.0, 9.0, -20.0]))
    names = [settle_and_classify(Continuous(), starts, wheel)[0] for wheel in (papers, paper)]
    assert names[0].tolist() == names[1].tolist()
    exponents = [
        smooth_mean(growth(START[:, None], wheel.columns(1), 20.0, 4).rates)
        for wheel in (papers, paper)
    ]
    assert exponents[0] == pytest.approx(exponents[1], abs=1e-7)


def test_a_wheel_needs_friction_of_some_kind():
    free = Wheel(f=0.0)
    for braked in (Wheel(), Wheel(f=0.0, dry_friction=0.1), free.with_functions(mechanics=drag)):
        require_friction(braked)
    for unbraked in (free, free.with_functions(logistic)):
        with pytest.raises(WrongUse, match="without friction"):
            require_friction(unbraked)


def test_a_user_s_mechanics_move_the_wheel_and_its_kicks():
    """Against scipy. A position kick shows the neurons the opposite of the rods' positions."""
    wheel = Wheel(k=8.0).with_functions(mechanics=drag)

    def course(sign, seconds):
        def own(_, y):
            pull = independent.rates(y, wheel._replace(own=0.0, f=0.0))[3] * wheel.I
            seen = sign * np.array([np.cos(y[2]), np.sin(y[2])])
            return [*(seen - y[:2]) / wheel.tau, y[3], drag(pull, y[3], wheel.I, wheel.f, 0.0)]

        run = independent.solve_ivp(own, (0.0, seconds), START, "DOP853", rtol=1e-11, atol=1e-12)
        return run.y[:, -1]

    assert trajectory(START, wheel, 2.0)[-1] == pytest.approx(course(1, 2.0), abs=1e-7)
    pushed = Continuous().kicked(START[:, None], wheel.columns(1), 0.4, seen_in(POSITION, 0))
    assert pushed[:, 0] == pytest.approx(course(-1, 0.4), abs=1e-7)


def test_the_page_has_a_wheel_that_begins_to_swing_where_theory_says():
    """docs/theory.md: the block runs as it is written. To first order x_t has the slope 0.4 a."""
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    names = {"__name__": "page"}
    exec(re.findall(r"```python\n(.*?)```", page, re.DOTALL)[0], names)  # noqa: S102
    a, tau, _, inertia, f, *_ = wheel = names["wheel"]
    pull = tau * (tanh(0.4 * a) * f * tau + inertia * 0.4 * a)
    assert hopf(wheel).k == pytest.approx(f * (inertia + f * tau) / pull, rel=1e-9)
    assert has_symmetries(wheel)
    assert not has_symmetries(ONE_ROD)
    assert not has_symmetries(Wheel().with_functions(transfer=lopsided))


@pytest.mark.parametrize("wheel", [ONE_ROD, BOUNDED])
def test_by_ticks_a_wheel_moves_as_the_robots_own(wheel):
    clock = Clock(latency_s=0.01)
    state = np.array([*START, 0.2])
    steps = sampled.as_robot(state.tolist(), wheel, clock, 41)
    found = sampled.advance(state[:, None], wheel.columns(1), clock, 40)
    assert found[PHI:4, 0] == pytest.approx(steps[:, -1], abs=1e-10)


def _outside():
    factor = 3.0

    def closed(x, a):
        return factor * x

    return closed


def no_number(x, a):
    return [x]


def infinite(x, a):
    return 1e308 * 10.0


def texts(x, a):
    return {"x": x}["x"] + open("file")  # noqa: PTH123


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (_outside(), "factor of the function around it"),
        (no_number, "return one finite number"),
        (infinite, "return one finite number"),
        (texts, f"the function texts, line {texts.__code__.co_firstlineno + 1} of"),
        (lambda x: x, "does not compile"),
        (abs, "plain Python function"),
    ],
)
def test_a_function_that_cannot_be_used_is_refused_in_words(function, words):
    with pytest.raises(WrongUse) as refused:
        Wheel().with_functions(transfer=function)
    assert words in f"{refused.value} {refused.value.hint}"


def test_what_a_law_cannot_do_is_refused_before_work_begins(papers):
    with pytest.raises(WrongUse, match="different equations"):
        advance(np.zeros((4, 2)), np.hstack([ONE_ROD.columns(1), BOUNDED.columns(1)]), 1.0)
    with pytest.raises(WrongUse, match="step by ticks"):
        sampled.advance(np.zeros((5, 1)), papers.columns(1), Clock(), 1)
    with pytest.raises(WrongUse, match="another Python process"):
        trajectory(START, Wheel(own=99.0), 1.0)
    for wrong in ({"rods": 3}, {"bounded": 0.0}):
        with pytest.raises(WrongUse, match=next(iter(wrong))):
            Wheel(**wrong).checked()


def test_every_study_takes_one_rod_or_refuses_it_before_work():
    """Its cells are what it is going to do. The words of the refusal name who takes one rod."""
    taken, hints = set(), set()
    for name in TABLE:
        try:
            assert find(name).work.cells(
                complete_options(name, TABLE[name], {"rods": 1}), batch=True
            )
        except WrongUse as refused:
            assert "quarter turn" in str(refused)
            hints.add(refused.hint)
        else:
            taken.add(name)
    (hint,) = hints
    named = hint.partition(";")[2].replace(" and ", ", ").replace(" take one rod", "")
    assert taken == {name.strip() for name in named.split(",")}


def test_crossings_of_a_bounded_wheel_are_scipys():
    """On sin(2 phi) = 0, every quarter turn."""
    found = crossings(START[:, None], BOUNDED.columns(1), 4.0)

    def height(_, y):
        return np.sin(2 * y[PHI])

    exact = independent.follow(START, BOUNDED, 4.0, height).t_events[0]
    assert found.times_s[0] == pytest.approx(exact, abs=1e-9)
    assert len(exact) > 3
