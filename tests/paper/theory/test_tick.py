"""The sampled wheel.

Its map against the robot's own wheel, its multipliers against those by hand, its limits against the
continuous model.
"""

from math import pi, sqrt

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.figures.theory.tick import draw
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis import stability_thresholds as thresholds
from host.theory.analysis.hopf import hopf
from host.theory.engine import sampled
from host.theory.engine.kicked import Continuous, Sampled
from host.theory.engine.sampled import Clock, at_rest, coast, jacobian
from host.theory.model.wheel import OMEGA, PHI, Wheel
from host.theory.studies import tick as study
from host.theory.studies.registry import TABLE
from host.theory.studies.tick_rows import ORDERS, growth_of
from robot.controller import target_position
from robot.kick_requests import parse
from robot.kicks import PHASE, POSITION, WAVEFORM
from robot.params import Params
from tests.paper.theory.table import rows_of

WHEEL = Wheel()
OPTIONS = complete_options("tick", TABLE["tick"], {})
NEW, OLD = Clock(), Clock(fresh=False)
CLOCKS = [
    Clock(tick_s, latency_s, fresh)
    for tick_s, latency_s in ((0.03, 0.0), (0.03, 0.012), (0.08, 0.08))
    for fresh in (True, False)
]


@pytest.fixture(scope="module")
def figures():
    """They are as users see them."""


def random_states(count, seed=3):
    rng = np.random.default_rng(seed)
    return rng.uniform(
        [[-1.0], [-1.0], [-4.0], [-9.0], [-5.0]], [[1.0], [1.0], [4.0], [9.0], [5.0]], (5, count)
    )


def by_hand(wheel, clock):
    """The Jacobian at rest of (x2, phi, omega) without latency, worked out on paper.

    X1 decouples at phi = 0.
    """
    part, slope = clock.tick_s / wheel.tau, float(target_position(1.0, wheel.a))
    keep = np.exp(-wheel.f * clock.tick_s / wheel.I)
    ahead = wheel.I / wheel.f * (1 - keep)
    stepped = np.array([1 - part, part, 0.0])
    acting = stepped if clock.fresh else np.array([1.0, 0.0, 0.0])
    force = wheel.k * slope * np.array([0.0, 1.0, 0.0]) - wheel.k * wheel.a / 2 * acting
    moved = np.array([0.0, 1.0, ahead]) + (clock.tick_s - ahead) / wheel.f * force
    return np.array([stepped, moved, np.array([0.0, 0.0, keep]) + (1 - keep) / wheel.f * force])


@pytest.mark.parametrize("seconds", [1e-6, 0.003, 0.0099, 0.0101, 0.2, 30.0])
def test_a_coast_is_the_solution_of_its_equation(seconds):
    ahead, pushed, kept, gained = coast(seconds, 0.05, 0.5)
    solved = solve_ivp(
        lambda _, y: [y[1], (2.0 - 0.5 * y[1]) / 0.05],
        (0, seconds),
        [0.3, -3.0],
        "DOP853",
        rtol=1e-12,
        atol=1e-14,
    )
    assert [0.3 - 3.0 * ahead + 2.0 * pushed, -3.0 * kept + 2.0 * gained] == pytest.approx(
        solved.y[:, -1].tolist(), rel=1e-10
    )


def test_without_friction_a_coast_is_a_parabola():
    assert coast(0.2, 0.05, 0.0) == pytest.approx(
        (0.2, 0.2**2 / 2 / 0.05, 1.0, 0.2 / 0.05), rel=1e-15
    )


@pytest.mark.parametrize("clock", CLOCKS)
def test_a_quarter_turn_and_a_mirror_change_nothing(clock):
    states, parameters = random_states(50), Wheel(k=8.0).columns(50)
    turned = np.array([-states[1], states[0], states[2] + pi / 2, states[3], states[4]])
    ended, turned_ended = (sampled.advance(of, parameters, clock, 20) for of in (states, turned))
    assert np.array(
        [turned_ended[1], -turned_ended[0], turned_ended[2] - pi / 2, *turned_ended[3:]]
    ) == pytest.approx(ended, abs=1e-9)
    signs = np.array([[1.0], [-1.0], [-1.0], [-1.0], [-1.0]])
    assert sampled.advance(signs * states, parameters, clock, 20) * signs == pytest.approx(
        ended, abs=1e-9
    )


@pytest.mark.parametrize("clock", [clock for clock in CLOCKS if clock.fresh])
@pytest.mark.parametrize(
    ("request_", "acting"),
    [
        (None, []),
        ({"mode": POSITION, "ticks": 5}, 5 * [(8.0, sampled.Seen(1.0, 0.0))]),
        ({"mode": PHASE, "ticks": 4, "shift": -2.0}, 4 * [(8.0, sampled.Seen(0.0, -2.0))]),
        (
            {"mode": WAVEFORM, "param": "k", "waveform": [0.0, 40.0, 2.5]},
            [(k, sampled.PLAIN) for k in (0.0, 40.0, 2.5)],
        ),
    ],
)
def test_the_map_is_what_the_robots_own_wheel_does(clock, request_, acting):
    wheel, state = Wheel(k=8.0), random_states(1)
    kick = request_ and parse({"id": "test", **request_}, (1, 1), Params(), 7)
    phi, omega = sampled.as_robot(state[:, 0].tolist(), wheel, clock, 31, kick)
    ended = sampled.advance(state, wheel.columns(1), clock, 7)
    for k, seen in acting:
        ended = sampled.advance(ended, Wheel(k=k).columns(1), clock, 1, seen)
    ended = sampled.advance(ended, wheel.columns(1), clock, 30 - 7 - len(acting))
    assert ended[[PHI, OMEGA], 0].tolist() == pytest.approx([phi[30], omega[30]], rel=1e-10)


def test_with_ever_shorter_ticks_the_map_becomes_the_continuous_model():
    states = random_states(20)
    true = Continuous().averages(states[:4], WHEEL.columns(20), 0.5).states
    for fresh in (True, False):
        coarse, fine = (
            np.abs(
                sampled.advance(states, WHEEL.columns(20), Clock(0.5 / ticks, 0.0, fresh), ticks)[
                    :4
                ]
                - true
            ).max()
            for ticks in (2000, 4000)
        )
        assert fine < 0.01
        assert coarse / fine == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("clock", CLOCKS)
@pytest.mark.parametrize("number", [0, 1])
def test_the_jacobian_is_that_of_the_map(clock, number):
    state = random_states(2)[:, number].tolist() if number else at_rest()
    aside = np.repeat(np.array(state)[:, None], 10, axis=1)
    aside[np.arange(10) % 5, np.arange(10)] += np.repeat([1e-5, -1e-5], 5)
    ended = sampled.advance(aside, WHEEL.columns(10), clock, 1)
    assert (ended[:, :5] - ended[:, 5:]) / 2e-5 == pytest.approx(
        jacobian(state, WHEEL, clock), abs=2e-8
    )


@pytest.mark.parametrize("clock", [NEW, OLD, Clock(0.1), Clock(0.001, 0.0, fresh=False)])
def test_multipliers_at_rest_are_those_worked_out_on_paper(clock):
    expected = [0.0, 1 - clock.tick_s / WHEEL.tau, *np.linalg.eigvals(by_hand(WHEEL, clock))]
    assert np.sort_complex(thresholds.multipliers(WHEEL, clock)) == pytest.approx(
        np.sort_complex(np.array(expected)), abs=1e-9
    )


@pytest.mark.parametrize("clock", [NEW, OLD, Clock(0.1), Clock(0.001, 0.0, fresh=False)])
def test_rest_loses_its_stability_where_a_pair_leaves_the_unit_circle(clock):
    k_c = thresholds.critical_k(WHEEL, clock)
    # Schur and Cohn's condition on the cubic z^3 + c2 z^2 + c1 z + c0 for a pair on the unit
    # circle.
    _, c2, c1, c0 = np.poly(by_hand(WHEEL._replace(k=k_c), clock))
    assert 1 - c1 + c0 * c2 - c0**2 == pytest.approx(0.0, abs=1e-12)
    assert abs(thresholds.leading(WHEEL._replace(k=k_c), clock)) == pytest.approx(1.0, abs=1e-13)
    below, above = (
        abs(thresholds.leading(WHEEL._replace(k=k_c * factor), clock))
        for factor in (1 - 1e-6, 1 + 1e-6)
    )
    assert below < 1.0 < above


@pytest.mark.parametrize("clock", [NEW, OLD, Clock(0.04, 0.02)])
def test_a_small_swing_fades_below_that_k_and_grows_above(clock):
    k_c = thresholds.critical_k(WHEEL, clock)
    assert study.k_by_time_course(WHEEL, clock, k_c) == pytest.approx(k_c, rel=1e-7)


@pytest.mark.parametrize("tau_s", [0.05, 0.25, 1.0])
def test_without_a_tick_k_c_is_the_hopf_bifurcations_to_first_order(tau_s):
    wheel = WHEEL._replace(tau=tau_s)
    for fresh in (True, False):
        near, nearer = (
            thresholds.critical_k(wheel, Clock(tau_s * share, 0.0, fresh)) / hopf(wheel).k - 1
            for share in (1e-3, 5e-4)
        )
        assert near / nearer == pytest.approx(2.0, abs=0.01)
        assert 2 * nearer - near == pytest.approx(0.0, abs=1e-5)
        assert (near > 0) == fresh


def test_the_two_orders_move_k_c_in_opposite_directions_and_latency_lowers_it():
    k_hopf = hopf(WHEEL).k
    shift = {
        (tick_s, fresh): thresholds.critical_k(WHEEL, Clock(tick_s, 0.0, fresh)) / k_hopf - 1
        for tick_s in (0.03, 0.04)
        for fresh in (0, 1)
    }
    assert [shift[0.03, 1], shift[0.04, 1]] == pytest.approx([0.1159, 0.1608], abs=1e-4)
    assert [shift[0.03, 0], shift[0.04, 0]] == pytest.approx([-0.0793, -0.1027], abs=1e-4)
    for fresh in (True, False):
        late = [
            thresholds.critical_k(WHEEL, Clock(0.03, latency_s, fresh))
            for latency_s in (0.0, 0.01, 0.02, 0.03)
        ]
        assert late == sorted(late, reverse=True)


def test_a_new_force_that_acts_a_whole_tick_late_is_an_old_one_but_for_where_it_pulls():
    # With a latency of a tick, F of (x_n+1, phi_n) acts one tick later; k_c then lies between the
    # two orders without latency.
    assert (
        thresholds.critical_k(WHEEL, OLD)
        < thresholds.critical_k(WHEEL, Clock(0.03, 0.03))
        < thresholds.critical_k(WHEEL, NEW)
    )


def test_where_there_is_no_k_c_none_is_returned():
    assert thresholds.critical_k(WHEEL, Clock(0.6)) is None  # the neurons overshoot: 0.6 s > 2 tau
    assert thresholds.critical_k(WHEEL._replace(f=0.0), NEW) == 0.0  # nothing brakes
    assert thresholds.critical_k(WHEEL._replace(a=0.0), NEW) is None  # the rods do not pull


@pytest.mark.parametrize("model", [Continuous(), Sampled(NEW), Sampled(OLD)])
def test_rolling_begins_and_ends_where_wheels_say_so(model):
    k_c = (
        hopf(WHEEL).k
        if isinstance(model, Continuous)
        else thresholds.critical_k(WHEEL, model.clock)
    )
    begins = thresholds.swinging_ends(model, WHEEL, k_c, 5 * k_c, 60.0)
    ends = thresholds.rolling_ends(model, WHEEL, 5 * k_c, 0.2 * k_c, 60.0)
    assert begins == pytest.approx(ends, rel=1e-6)  # no hysteresis at tau = 0.25 s
    assert begins > 1.05 * k_c  # forth and back in between
    start = model.states_of(np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0], [12.0, 12.0]]))
    parameters = WHEEL.columns(2)
    parameters[2] = begins * 0.999, begins * 1.001
    settled = model.averages(start, parameters, 60.0)
    swings, rolls = np.abs(model.averages(settled.states, parameters, 60.0).omega_mean).tolist()
    assert swings < 0.05
    assert rolls > 0.5


def test_no_end_of_a_motion_is_returned_where_there_is_none():
    assert (
        thresholds.rolling_ends(Sampled(NEW), WHEEL, 8.0, 4.0, 30.0) is None
    )  # it rolls all the way down
    assert thresholds.rolling_ends(Sampled(NEW), WHEEL, 1.5, 0.5, 30.0) is None  # it never rolls
    assert (
        thresholds.swinging_ends(Sampled(NEW), WHEEL, 1.0, 1.9, 30.0) is None
    )  # it swings all the way up


@pytest.mark.parametrize(
    "clock",
    [Clock(0.0), Clock(float("inf")), Clock(0.03, 0.04), Clock(0.03, -0.01), Clock(float("nan"))],
)
def test_a_clock_that_cannot_go_is_refused(clock):
    with pytest.raises(WrongUse):
        clock.checked()


def test_neurons_that_run_away_are_refused():
    with pytest.raises(WrongUse, match="run away"):
        sampled.advance(random_states(2), WHEEL._replace(tau=1e-3).columns(2), NEW, 2000)
    with pytest.raises(WrongUse, match="ticks"):
        sampled.ticks_in(1e9, NEW)


@pytest.mark.parametrize("changed", [{"f": 0.0}, {"a": 0.0}, {"latency": 0.04}, {"tick": 1e-5}])
def test_a_study_without_a_question_is_refused(changed):
    with pytest.raises(WrongUse):
        study.cells(OPTIONS | changed)


@pytest.fixture(scope="module")
def short_run():
    """A study of few ticks and latencies: its rows and its findings."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "TICKS_S", (0.005, 0.01, 0.02, 0.03))
        patch.setattr(study, "LATENCIES", 3)
        patch.setattr(study, "FOLLOWED", 100.0)
        patch.setattr(study, "PATIENCE", 300_000)
        setting = Setting(1, OPTIONS)
        rows = rows_of(study, setting)
        return rows, study.report(rows, setting)


def test_the_study_says_how_accurate_it_is(short_run):
    numbers = short_run[1].numbers
    for order in ORDERS:
        accuracy = numbers["accuracy"][order]
        assert accuracy["k_c_against_time_course"] < 1e-7
        assert accuracy["k_c_without_tick_against_hopf"] < 1e-9
        assert accuracy["order_of_convergence"] == pytest.approx(1.0, abs=1e-3)
        assert accuracy["k_rolls_and_stops_followed_twice_as_long"] < 1e-6
        assert accuracy["k_rolls_without_tick_against_continuous"] < 1e-3
        assert numbers[order]["k_rolls"] == pytest.approx(numbers[order]["k_stops"], rel=1e-6)
    assert numbers["new"]["k_c_rises_per_s_of_tick"] > 0 > numbers["old"]["k_c_rises_per_s_of_tick"]


def test_the_growth_rate_is_zero_at_k_c_and_the_continuous_ones_between(short_run):
    rows, findings = short_run
    growth = {order: growth_of(rows, order) for order in ("continuous", "new", "old")}
    for order, line in growth.items():
        k_c = findings.numbers[order]["k_c"]
        assert all(
            (row["growth_per_s"] > 0) == (row["k"] > k_c)
            for row in line
            if row["k"] not in (0.0, k_c)
        )
    fast, middle, slow = (
        growth[order][-1]["growth_per_s"] for order in ("old", "continuous", "new")
    )
    assert fast > middle > slow


def test_a_tick_changes_the_speed_little_at_first(short_run):
    numbers = short_run[1].numbers
    assert numbers["continuous"]["hz"] == pytest.approx(1.5650, abs=1e-3)
    assert numbers["new"]["hz"] < numbers["continuous"]["hz"] < numbers["old"]["hz"]
    formula = sqrt((4.0 * 8.0 * 0.25 - 1.0) / 0.0625) / (2 * pi)
    assert numbers["continuous"]["hz"] == pytest.approx(formula, rel=0.08)


def test_the_figure_shows_both_orders_beside_the_continuous_model(short_run):
    figure = draw(*short_run)
    lines, growth = figure.axes[:2]
    assert len(lines.lines) >= 6
    assert len(growth.lines) == 4
    assert figure.get_size_inches()[0] * figure.dpi == 1920


def test_a_tick_too_long_for_the_neurons_is_drawn_and_reported_as_such(short_run):
    rows = short_run[0]
    gone = {
        "k_c": None,
        "modulus": None,
        "angle": None,
        "k_rolls": None,
        "k_stops": None,
        "hz": None,
    }
    rows = [{**row, **gone} if row["part"] in ("point", "tick", "latency") else row for row in rows]
    found = study.report(rows, Setting(1, OPTIONS))
    assert found.numbers["new"]["k_c"] is None
    assert "too long" in draw(rows, found).get_suptitle()
