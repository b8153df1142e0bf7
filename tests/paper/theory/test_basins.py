"""Kicks and basins of the model.

Kicks against the robot's and another integrator's, symmetries, outcomes, and what the maps must
show.
"""

from math import pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.figures.theory.basins import draw
from host.runs.contract import Findings, Setting
from host.runs.registry import complete_options
from host.theory.analysis.outcomes import (
    BACK,
    BACKWARD,
    FORWARD,
    OTHER,
    REST,
    classify,
    mirror,
    outcomes_after_kicks,
    rest_is_stable,
    rolling_states,
    settle_and_classify,
    starting_states,
)
from host.theory.engine import sampled
from host.theory.engine.ensemble import Averages
from host.theory.engine.kicked import KICKS, Continuous, Sampled, inverted, seen_in
from host.theory.engine.sampled import PLAIN, Clock, Seen
from host.theory.model.turning import rolling_states as turning_steadily
from host.theory.model.wheel import OMEGA, PHI, Wheel, seen_rates
from host.theory.studies import basins
from host.theory.studies.registry import TABLE
from robot.controller import actual_positions, step_wheel
from robot.kick_requests import parse
from robot.kicks import MEMBRANE, PHASE, POSITION
from robot.params import Params
from tests.paper.theory import independent
from tests.paper.theory.table import rows_of

WHEEL = Wheel(k=8.0)
OPTIONS = complete_options("basins", TABLE["basins"], {"points": 16})
MODELS = [Continuous(), Sampled()]
NAMED = pytest.mark.parametrize("model", MODELS, ids=["continuous", "sampled"])
PHASES = 36
TICK_S = 0.03


@pytest.fixture(scope="module")
def figures():
    """They are as users see them."""


@pytest.fixture(scope="module")
def rolling():
    """Wheels that roll forward, of either model."""
    return [rolling_states(model, WHEEL, PHASES) for model in MODELS]


def shares(model, wheels, mode, sign, lengths_s):
    """The share of wheels that a kick of each length reverses."""
    return (
        (outcomes_after_kicks(model, WHEEL, wheels, mode, sign, [0.0, *lengths_s])[1:] == BACKWARD)
        .mean(axis=1)
        .tolist()
    )


def test_kicks_show_the_neurons_what_the_robots_kicks_show_them():
    assert seen_in(POSITION, 0) == (1.0, 0.0)
    assert seen_in(PHASE, 1) == (0.0, pytest.approx(3 * pi / 4))
    assert seen_in(PHASE, -1) == (0.0, pytest.approx(-3 * pi / 4))
    state = np.array([[0.3], [-0.4], [1.0], [5.0], [2.0]])
    assert inverted(state)[:, 0].tolist() == [-0.3, 0.4, 1.0, 5.0, 2.0]


def test_a_kick_alters_the_potentials_rates_and_not_the_force():
    x, actual = (0.3, -0.4), actual_positions(0.7)
    plain, kicked = (
        seen_rates(*x, 5.0, *actual, *seen, *WHEEL[:7])
        for seen in (actual, (-actual[0], -actual[1]))
    )
    assert plain[2:] == kicked[2:]
    assert [(kicked[i] + plain[i]) / 2 for i in (0, 1)] == pytest.approx(
        [-x[0] / 0.25, -x[1] / 0.25]
    )


@pytest.mark.parametrize(
    "kick", [PLAIN, *(seen_in(mode, sign) for mode, sign in KICKS[1:]), Seen(0.3, 1.1)]
)
def test_a_kicked_wheel_moves_as_another_integrator_moves_it(kick):
    def field(_, y):
        sign, angle = 1 - 2 * kick.beta, y[PHI] + kick.shift_rad
        return seen_rates(
            *y[:2],
            y[OMEGA],
            *actual_positions(y[PHI]),
            sign * np.cos(angle),
            sign * np.sin(angle),
            *WHEEL[:7],
        )

    state = np.array([0.3, -0.4, 1.0, 7.0])
    solved = solve_ivp(field, (0.0, 0.4), state, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    ended = Continuous(2.0).kicked(state[:, None], WHEEL.columns(1), 0.4, kick)[:, 0]
    assert ended == pytest.approx(solved, abs=1e-8)


def test_without_a_kick_a_kicked_wheel_is_any_wheel():
    states = starting_states(np.linspace(-3.0, 3.0, 7), np.linspace(-9.0, 9.0, 7))
    for model in MODELS:
        kicked = model.kicked(model.states_of(states), WHEEL.columns(7), 0.6, PLAIN)
        assert kicked == pytest.approx(
            model.averages(model.states_of(states), WHEEL.columns(7), 0.6).states, abs=1e-7
        )


@pytest.mark.parametrize(("mode", "sign"), KICKS[1:])
def test_a_sampled_kick_reverses_the_wheels_that_the_robots_own_kick_reverses(rolling, mode, sign):
    lengths = (3, 5, 8)
    found = outcomes_after_kicks(
        Sampled(), WHEEL, rolling[1], mode, sign, [0.0, *(TICK_S * ticks for ticks in lengths)]
    )[1:]
    shift = {"shift": sign * 3 * pi / 4} if sign else {}
    for ticks, line in zip(lengths, found, strict=True):
        kick = parse({"id": "test", "mode": mode, "ticks": ticks, **shift}, (1, 1), Params(), 0)
        for state, outcome in list(zip(rolling[1].T.tolist(), line, strict=True))[::5]:
            phi, _ = sampled.as_robot(state, WHEEL, Clock(), 300, kick)
            assert (phi[299] < phi[250]) == (outcome == BACKWARD)


@NAMED
def test_a_quarter_turn_ahead_a_kick_does_the_same(model, rolling):
    wheels = rolling[MODELS.index(model)]
    turned = np.vstack([-wheels[1], wheels[0], wheels[2] + pi / 2, wheels[3:]])
    for mode, sign in KICKS:
        lengths_s = [0.0, 0.12, 0.24]
        assert (
            outcomes_after_kicks(model, WHEEL, wheels, mode, sign, lengths_s)
            == outcomes_after_kicks(model, WHEEL, turned, mode, sign, lengths_s)
        ).mean() > 0.99


@NAMED
def test_in_a_mirror_a_kick_of_the_other_sign_does_the_other(model, rolling):
    wheels = rolling[MODELS.index(model)]
    opposite = {FORWARD: BACKWARD, BACKWARD: FORWARD}
    for mode, sign in KICKS:
        lengths_s = [0.0, 0.12, 0.24]
        forward = outcomes_after_kicks(model, WHEEL, wheels, mode, sign, lengths_s)
        backward = outcomes_after_kicks(model, WHEEL, mirror(wheels), mode, -sign, lengths_s)
        assert (
            np.mean(
                [
                    opposite[name] == other
                    for name, other in zip(forward.ravel(), backward.ravel(), strict=True)
                ]
            )
            > 0.99
        )


@NAMED
def test_inverted_potentials_always_reverse_a_wheel(model, rolling):
    assert set(
        outcomes_after_kicks(model, WHEEL, rolling[MODELS.index(model)], MEMBRANE, 0, [0.0]).ravel()
    ) == {BACKWARD}


@NAMED
def test_a_kick_of_no_length_does_nothing_and_some_lengths_always_reverse(model, rolling):
    wheels = rolling[MODELS.index(model)]
    assert set(outcomes_after_kicks(model, WHEEL, wheels, POSITION, 0, [0.0]).ravel()) == {FORWARD}
    assert shares(model, wheels, POSITION, 0, [0.06, 0.18, 0.36]) == [
        0.0,
        1.0,
        pytest.approx(0.43, abs=0.15),
    ]
    assert shares(model, wheels, PHASE, 1, [0.06, 0.12, 0.3]) == [0.0, 1.0, 1.0]
    assert max(shares(model, wheels, PHASE, -1, [0.03, 0.06, 0.09])) == 0.0


def test_the_wrong_sign_is_sure_for_the_sampled_wheel_only(rolling):
    continuous, by_ticks = (
        shares(model, wheels, PHASE, -1, [0.18, 0.21])
        for model, wheels in zip(MODELS, rolling, strict=True)
    )
    assert by_ticks == [1.0, 1.0]
    assert max(continuous) < 0.75


def test_a_kick_that_altered_the_projection_too_would_never_reverse(rolling):
    """If rods pulled where neurons see the wheel, it would be one that is half a turn ahead."""
    ahead, pushed, kept, gained = sampled.coast(TICK_S, WHEEL.I, WHEEL.f)
    kicked = rolling[1].copy()
    for number in range(PHASES):
        x1, x2, phi, omega, _ = kicked[:, number].tolist()
        for _ in range(5):
            minus = [-position for position in actual_positions(phi)]
            x1, x2, force, _ = step_wheel(
                x1, x2, *minus, *minus, *minus, TICK_S, WHEEL.a, WHEEL.tau, WHEEL.k, 2
            )
            phi, omega = phi + ahead * omega + pushed * force, kept * omega + gained * force
        kicked[:, number] = x1, x2, phi, omega, 0.0
    right = Sampled().kicked(rolling[1], WHEEL.columns(PHASES), 5 * TICK_S, seen_in(POSITION, 0))
    assert np.mean(settle_and_classify(Sampled(), right, WHEEL)[0] == BACKWARD) == 1.0
    assert np.mean(settle_and_classify(Sampled(), kicked, WHEEL)[0] == BACKWARD) == 0.0


@NAMED
def test_phases_cover_the_quarter_turn_evenly_in_time(model, rolling):
    phases = rolling[MODELS.index(model)][PHI] % (pi / 2)
    assert (np.diff(phases) >= 0).all()
    assert np.diff(np.concatenate([[phases[-1] - pi / 2], phases])).max() < 4 * pi / 2 / PHASES


@pytest.mark.parametrize(
    ("travel", "std", "expected"),
    [
        ((9.0, 9.0), (1.0, 1.0), FORWARD),
        ((-9.0, -9.5), (1.0, 1.0), BACKWARD),  # as far, to a quarter turn
        ((9.0, 6.0), (5.0, 5.0), OTHER),
        ((9.0, -9.0), (5.0, 5.0), OTHER),
        ((1.5, 1.5), (5.0, 5.0), OTHER),  # hops to and fro
        ((0.1, -0.1), (1.0, 1.0), BACK),
        ((0.1, 0.0), (1.0, 0.5), REST),  # fades
        ((0.0, 0.0), (0.0, 0.0), REST),
    ],
)
def test_outcomes_are_classified_by_two_windows(travel, std, expected):
    windows = [
        Averages(np.array([quarters * pi / 2 / 10.0]), np.array([own]), np.zeros((4, 1)))
        for quarters, own in zip(travel, std, strict=True)
    ]
    assert classify(*windows, 10.0, stable=True).tolist() == [expected]
    if expected == REST:
        assert classify(*windows, 10.0, stable=False).tolist() == [BACK]


@NAMED
def test_where_chaos_and_rolling_coexist_no_chaotic_wheel_is_taken_for_a_regular_one(model):
    """By two windows alone, 1 of 15 chaotic wheels seems to roll, or to swing in one well.

    scipy sees that wheels part from close ones; below k = 5.168 rolling is stable.
    """
    wheel = Wheel(k=5.0, tau=1.0)
    rng = np.random.default_rng(1)
    anywhere = starting_states(*(most * rng.uniform(-1, 1, 60) for most in (pi, 20.0)))
    states = np.hstack([turning_steadily(wheel.columns(1)), anywhere])
    names = settle_and_classify(model, model.states_of(states), wheel)[0]
    assert names.tolist() == [FORWARD if isinstance(model, Continuous) else OTHER] + [OTHER] * 60
    start = anywhere[:, 0]
    last, other = (independent.last(y, wheel, 80.0, rtol=1e-8) for y in (start, start + 1e-6))
    assert np.abs(last - other).max() > 1.0


@NAMED
def test_rest_is_stable_below_each_models_own_k(model):
    k_c = 1.5873 if isinstance(model, Continuous) else 1.7712
    assert rest_is_stable(model, WHEEL._replace(k=k_c - 1e-4))
    assert not rest_is_stable(model, WHEEL._replace(k=k_c + 1e-4))


def test_between_the_two_k_c_the_continuous_wheel_swings_and_the_sampled_one_rests():
    states = starting_states(np.array([0.1, 0.3, 1.7]), np.zeros(3))
    names = [
        settle_and_classify(model, model.states_of(states), WHEEL._replace(k=1.65))[0].tolist()
        for model in MODELS
    ]
    assert names == [[BACK] * 3, [REST] * 3]


@NAMED
def test_slow_wheels_rest_where_they_are_and_fast_ones_wells_further_on(model):
    rows = basins.simulate_starts(
        model,
        WHEEL._replace(k=1.2),
        np.array([0.1, pi / 2 - 0.1, 0.1, -0.1]),
        np.array([0.0, 0.0, 20.0, -20.0]),
    )
    assert [row["outcome"] for row in rows] == [REST] * 4
    assert [row["quarters"] for row in rows[:2]] == [0, 1]
    assert rows[2]["quarters"] == -rows[3]["quarters"] > 0


@NAMED
def test_without_springs_a_wheel_rests_anywhere_and_none_rolls(model):
    (row,) = basins.simulate_starts(model, WHEEL._replace(k=0.0), np.array([0.5]), np.array([3.0]))
    assert (row["outcome"], row["quarters"]) == (REST, None)
    assert rolling_states(model, WHEEL._replace(k=0.0), 4) is None


@pytest.mark.parametrize("changed", [{"f": 1e-3}, {"I": 1e-6}])
def test_wheels_that_hardly_settle_or_are_stiff_are_refused(changed):
    with pytest.raises(WrongUse, match="settles too slowly"):
        basins.cells(OPTIONS | changed)


def test_a_tau_too_short_for_the_tick_is_refused():
    with pytest.raises(WrongUse, match="run away"):
        basins.simulate_starts(
            Sampled(), WHEEL._replace(tau=0.01), np.array([0.5]), np.array([3.0])
        )


@pytest.fixture(scope="module")
def run():
    """A small study: its rows and findings."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(basins, "PHASES", 30)
        patch.setattr(basins, "CHECKED", 40)
        setting = Setting(1, OPTIONS)
        rows = rows_of(basins, setting)
        return rows, basins.report(rows, setting)


def test_the_study_reports_basins_sure_kicks_and_its_accuracy(run):
    numbers = run[1].numbers
    for model in basins.MODEL_NAMES:
        of_model = numbers["basins"][model]
        assert of_model["shares"][FORWARD] == of_model["shares"][BACKWARD] == 0.5
        assert 0.1 < of_model["turned_around"] < 0.4
        assert set(numbers["accuracy"]["same_outcome"][model].values()) <= {1.0, None}
        assert numbers["accuracy"]["angle_off_rad"][model] < 1e-6
    sure = {
        (kick["model"], kick["mode"], kick["sign"]): kick["sure_s"] for kick in numbers["kicks"]
    }
    assert sure["sampled", POSITION, 0] == [[pytest.approx(0.15), pytest.approx(0.21)]]
    assert sure["sampled", PHASE, 1] == [[pytest.approx(0.12), pytest.approx(0.3)]]
    assert sure["continuous", POSITION, 0] == [
        [pytest.approx(0.145, abs=0.006), pytest.approx(0.22, abs=0.006)]
    ]
    assert sure["continuous", PHASE, -1] == []
    assert numbers["no_wheel_rolls"] == []
    assert 0.05 < numbers["starts_that_end_otherwise_if_sampled"] < 0.35


def test_the_same_seed_checks_the_same_starts():
    cell = {"part": "check", "model": "sampled"}
    states = [
        np.random.default_rng(Setting(1, OPTIONS).seed_of(cell)).random(3).tolist()
        for _ in range(2)
    ]
    assert states[0] == states[1]


def test_the_figure_shows_starts_and_kicks_of_both_models(run):
    figure = draw(*run)
    assert round(figure.get_size_inches()[0] * figure.dpi) == 1920
    assert len(figure.axes) == 12
    assert [text.get_text() for text in figure.axes[8].get_legend().get_texts()][:2] == [
        "rolls forward",
        "rolls backward",
    ]


def test_where_no_wheel_rolls_the_study_says_so_and_still_draws(run):
    setting = Setting(1, OPTIONS | {"k": 1.2})
    rows = [row for row in run[0] if row["part"] != "kicks"]
    rows = [
        row | {"outcome": REST, "quarters": 1} if row["part"] == "starts" else row for row in rows
    ]
    findings = basins.report(rows, setting)
    assert findings.numbers["no_wheel_rolls"] == ["continuous", "sampled"]
    assert findings.numbers["kicks"] == []
    assert findings.numbers["basins"]["sampled"]["wells"] == {"1": 1.0}
    assert isinstance(findings, Findings)
    figure = draw(rows, findings)
    assert len(figure.axes) == 2
    assert "no wheel rolls" in figure.get_suptitle()
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        r"bound to $\varphi$ = $\pi/2$"
    ]


def test_where_only_one_models_wheel_rolls_the_other_panels_say_so(run):
    rows = [row for row in run[0] if (row["part"], row["model"]) != ("kicks", "sampled")]
    findings = basins.report(rows, Setting(1, OPTIONS))
    assert findings.numbers["no_wheel_rolls"] == ["sampled"]
    assert [kick["model"] for kick in findings.numbers["kicks"]] == ["continuous"] * 4
    assert findings.numbers["kicks_that_end_otherwise_if_sampled"] == []
    assert any("no wheel rolls" in text.get_text() for text in draw(rows, findings).axes[5].texts)
