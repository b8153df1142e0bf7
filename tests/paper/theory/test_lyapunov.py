"""Exponents against eigenvalues, symmetries and a second algorithm; attractors and transients."""

import json

import numpy as np
import pytest

from host.errors import WrongUse
from host.perform.run import perform
from host.runs.claims import Claim
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.analysis import transients
from host.theory.analysis.attractors import BACK, CHAOS, REST, ROLL, random_starts, settle, watch
from host.theory.analysis.tangent import (
    divergence,
    growth,
    kaplan_yorke,
    pair_growth,
    smooth_mean,
    tangent_rates,
)
from host.theory.analysis.transients import crisis, lives, sample
from host.theory.model.symbolic import jacobian_at
from host.theory.model.turning import rolling_states
from host.theory.model.wheel import PHI, Wheel, rates, resting
from host.theory.studies import lyapunov as study
from host.theory.studies import lyapunov_line, lyapunov_plane
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_report import in_words, spectrum
from host.theory.studies.registry import TABLE
from tests.lint.sources import ROOT
from tests.paper.theory import independent

RESTING, SWINGING, ROLLING, CHAOTIC = (
    Wheel(k=1.4),
    Wheel(k=1.65),
    Wheel(k=8.0),
    Wheel(k=15.0, tau=1.0),
)
OPTIONS = complete_options("lyapunov", TABLE["lyapunov"], {})
LINE = complete_options("lyapunov-line", TABLE["lyapunov-line"], {})


def _chance():
    return np.random.default_rng(11)


@pytest.fixture(scope="module")
def chaotic():
    """Chaotic wheels on their attractor."""
    parameters = CHAOTIC.columns(64)
    return settle(random_starts(64, _chance()), parameters, 60.0), parameters


def test_a_vector_is_driven_as_a_small_difference_is():
    rng, step = _chance(), 1e-6
    state, vector = random_starts(1, rng)[:, 0], rng.normal(size=4)
    out = np.empty((8, 1))
    tangent_rates()(np.concatenate([state, vector])[:, None], CHAOTIC.columns(1), out)
    ahead, behind = (np.array(rates(*(state + sign * step * vector), *CHAOTIC)) for sign in (1, -1))
    assert out[:4, 0] == pytest.approx(rates(*state, *CHAOTIC), rel=1e-12)
    assert out[4:, 0] == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("wheel", [RESTING, Wheel(k=0.3), Wheel(k=0.0), Wheel(a=0.0)])
def test_at_rest_exponents_are_the_real_parts_of_the_eigenvalues(wheel):
    found = smooth_mean(growth(resting(np.zeros(1)), wheel.columns(1), 200.0, 4).rates)[:, 0]
    exact = np.sort(np.linalg.eigvals(jacobian_at((1.0, 0.0, 0.0, 0.0), wheel)).real)[::-1]
    assert found == pytest.approx(exact, abs=2e-3)


def test_a_wheel_that_balances_is_not_chaotic_though_what_is_near_it_parts():
    state, parameters = resting(np.zeros(1)), CHAOTIC.columns(1)
    assert smooth_mean(growth(state, parameters, 20.0).rates)[0, 0] > 1.0
    assert watch(state, parameters, 20.0).kinds()[0] == REST


def test_along_a_cycle_one_exponent_is_0_and_the_others_are_negative():
    parameters = ROLLING.columns(1)
    begin = settle(rolling_states(ROLLING.columns(1)), parameters, 60.0)
    found = growth(begin, parameters, 100.0, 4)
    exponents = smooth_mean(found.rates)[:, 0]
    assert exponents[0] == pytest.approx(0.0, abs=1e-3)
    assert (exponents[1:] < -0.1).all()
    assert kaplan_yorke(exponents, 0.01) == 1.0


def test_the_sum_of_the_exponents_is_the_divergence_at_every_moment(chaotic):
    states, parameters = chaotic
    assert divergence(CHAOTIC) == pytest.approx(-2 / CHAOTIC.tau - CHAOTIC.f / CHAOTIC.I, abs=1e-12)
    sums = growth(states, parameters, 10.0, 4).rates.sum(axis=1)
    assert np.abs(sums - divergence(CHAOTIC)).max() < 1e-6


def test_both_algorithms_find_the_same_positive_exponent(chaotic):
    states, parameters = chaotic
    vectors = growth(states, parameters, 120.0).rates[5:, 0].mean(axis=0)
    pairs = pair_growth(states, parameters, 120.0)[10:].mean(axis=0)
    errors = [own.std() / np.sqrt(own.size) for own in (vectors, pairs)]
    assert vectors.mean() == pytest.approx(pairs.mean(), abs=4 * np.hypot(*errors))
    assert vectors.mean() - 5 * errors[0] > 0.7


def test_neither_algorithm_finds_growth_on_a_cycle():
    parameters = ROLLING.columns(1)
    begin = settle(rolling_states(ROLLING.columns(1)), parameters, 60.0)
    assert smooth_mean(pair_growth(begin, parameters, 100.0)) == pytest.approx(0.0, abs=1e-3)


def test_vectors_in_the_mirror_grow_alike():
    mirror = np.array([1.0, -1.0, -1.0, -1.0])[:, None]
    state, parameters = random_starts(1, _chance()), CHAOTIC.columns(1)
    vector = _chance().normal(size=(1, 4, 1))
    plain, other = (
        growth(sign * state, parameters, 4.0, vectors=vector * sign.reshape(1, 4, 1)).rates
        for sign in (np.ones((4, 1)), mirror)
    )
    assert other == pytest.approx(plain, rel=1e-6)


@pytest.mark.parametrize(
    ("exponents", "dimension"),
    [
        ((-1.0, -2.0), 0.0),
        ((0.0, -1.0, -2.0), 1.0),
        ((0.0, 0.0, -1.0), 2.0),
        ((0.906, 0.0, -14.572), 2.0622),
        ((1.0, -0.5), 2.0),
    ],
)
def test_dimensions(exponents, dimension):
    assert kaplan_yorke(np.array(exponents)) == pytest.approx(dimension, abs=1e-4)


@pytest.mark.parametrize(
    ("wheel", "kind"), [(RESTING, REST), (SWINGING, BACK), (ROLLING, ROLL), (CHAOTIC, CHAOS)]
)
def test_kinds_at_the_papers_points(wheel, kind):
    parameters = wheel.columns(16)
    seen = watch(settle(random_starts(16, _chance()), parameters, 150.0), parameters, 100.0)
    assert (seen.kinds() == kind).all()
    assert ((seen.apart > 1e-3) == (kind == CHAOS)).all()


def test_what_still_settles_is_not_called_chaos():
    """Just above the Hopf point a cycle takes very long to grow to its size."""
    parameters = RESTING._replace(k=1.55).columns(8)
    for seconds in (1.0, 5.0, 20.0):
        seen = watch(settle(resting(np.full(8, 0.02)), parameters, seconds), parameters, 20.0)
        assert np.isin(seen.kinds(), (REST, BACK)).all()


def test_smooth_averages_are_the_plain_ones_of_long_times():
    parameters, seconds = ROLLING.columns(1), 1000.0
    begin = settle(rolling_states(ROLLING.columns(1)), parameters, 60.0)
    plain = (settle(begin, parameters, seconds)[PHI] - begin[PHI]) / seconds
    assert watch(begin, parameters, 60.0).omega_mean == pytest.approx(plain, rel=1e-5)


def test_lives_are_those_of_switching_only():
    wheel = Wheel(k=4.4, tau=1.0)
    begin = np.hstack([random_starts(31, _chance()), rolling_states(wheel.columns(1))])
    found = lives(begin, wheel.columns(32), 1000.0, 0.6)
    assert found.ended.all()
    assert found.life_s[-1] == 0.0
    assert found.life_s.max() > 20.0


def test_means_of_lives_take_those_that_did_not_end_into_account():
    whole = 20.0 + _chance().exponential(100.0, 4000)
    cut = sample(1.0, np.minimum(whole, 170.0), whole < 170.0)
    assert cut.mean_s == pytest.approx(100.0, rel=0.06)
    assert cut.likeness is None


def test_lives_that_are_not_exponential_are_told_apart():
    rng, ended = _chance(), np.ones(200, dtype=bool)
    assert sample(1.0, 20.0 + rng.exponential(100.0, 200), ended).likeness > 0.01
    assert sample(1.0, 20.0 + rng.uniform(50.0, 150.0, 200), ended).likeness < 0.01


def test_a_crisis_is_found_where_lives_have_no_bound():
    rng, ended = _chance(), np.ones(400, dtype=bool)
    ks = 5.0 - np.array([0.6, 0.4, 0.3, 0.2, 0.1, 0.05, 0.02])
    samples = [sample(k, 20.0 + rng.exponential(30.0 * (5.0 - k) ** -1.3, 400), ended) for k in ks]
    found = crisis(samples)
    assert found.k == pytest.approx(5.0, abs=0.01)
    assert found.k_interval[0] <= 5.0 <= found.k_interval[1]
    assert found.power == pytest.approx(1.3, abs=0.15)
    assert crisis(samples[:3]) is None


@pytest.mark.parametrize("tau", [1.0, 0.6])
def test_rolling_loses_its_stability_where_scipy_finds_a_multiplier_on_the_circle(tau):
    (found,) = lyapunov_line.simulate({"part": "rolling"}, Setting(1, {**LINE, "tau": tau}))
    wheel = Wheel(k=found["k"], tau=tau)
    begin = independent.turning(wheel)
    state, quarter_s = independent.rotation(wheel, begin)
    pair = independent.multipliers(state, quarter_s, wheel)[:2]
    assert abs(pair) == pytest.approx(1.0, abs=1e-7)
    assert (found["type"], found["above"]) == ("neimark-sacker", "chaotic")
    assert found["omega_mean"] == pytest.approx(np.pi / 2 / quarter_s)


def test_the_glossary_names_the_study_that_shows_a_torus_bifurcation():
    """`branch` has none at its defaults."""
    rows = (ROOT / "host" / "GLOSSARY.md").read_text(encoding="utf-8").splitlines()
    (row,) = (row for row in rows if row.startswith("| Neimark-Sacker"))
    assert row.endswith("| `kickctl theory lyapunov-line` |")


def test_where_rolling_stays_stable_it_has_no_end():
    assert lyapunov_line.simulate({"part": "rolling"}, Setting(1, {**LINE, "tau": 0.25})) == []


@pytest.mark.parametrize(
    ("wrong", "words"),
    [({"I": 1e-9}, "long"), ({"tau": 1e-6}, "long"), ({"f": 1e3}, "long"), ({"f": 0.0}, "settles")],
)
def test_wheels_that_are_too_fast_or_never_settle_are_refused(wrong, words):
    with pytest.raises(WrongUse, match=words):
        study.cells({**OPTIONS, **wrong})
    with pytest.raises(WrongUse, match=words):
        lyapunov_line.cells({**LINE, **wrong})


def test_longer_runs_are_more_pieces_of_the_same_length():
    points = [
        cell for cell in study.cells({**OPTIONS, "seconds": 700.0}) if cell["part"] == "point"
    ]
    assert [cell["batch"] for cell in points] == list(range(6))
    assert 3 * points[0]["seconds"] == pytest.approx(700.0)


@pytest.fixture
def small(monkeypatch):
    """Studies that take seconds."""
    sizes = {
        lyapunov_line: {"KS": 8, "WHEELS": 2, "BAND": 8, "LIVES_AT": (0.0,)},
        lyapunov_plane: {"POINTS": 4},
        pieces: {
            "WHEELS": 8,
            "LIVES_WHEELS": 8,
            "LIVES_S": 70.0,
            "CHECKED": 8,
            "SERIES_S": 60.0,
            "SETTLE_S": 60.0,
            "MEASURE_S": 20.0,
        },
        transients: {"SEARCH_STEPS": 4, "SEARCH_S": 60.0},
    }
    for module, values in sizes.items():
        for name, value in values.items():
            monkeypatch.setattr(module, name, value)


@pytest.mark.parametrize(
    ("options", "kind"), [({"k": 8.0, "tau": 0.25}, "rolling"), ({"k": 0.0}, "at rest")]
)
def test_where_there_is_no_chaos_the_study_says_so(small, options, kind):
    summary = perform("lyapunov", 3, out="here", seconds=50.0, **options)
    numbers = summary["numbers"]
    assert numbers["verdict"] == numbers["point"]["kind"] == kind
    assert len(numbers["exponents"]) == len(numbers["standard_errors"]) == 4
    assert numbers["exponents"][0] == pytest.approx(0.0, abs=1e-4)
    assert numbers["exponents"] == sorted(numbers["exponents"], reverse=True)
    assert sum(numbers["exponents"]) == pytest.approx(
        numbers["accuracy"]["sum_of_exponents_exact"], abs=1e-4
    )
    (claim,) = summary["claims"]
    assert (claim["id"], claim["verdict"]) == ("M8", "undecided")
    assert "the claim is made for" in claim["note"]
    json.dumps(summary, allow_nan=False)


def test_where_starts_lead_to_different_attractors_each_has_its_exponents(small):
    """One rod rolls, or rests at 0° with the eigenvalues that differences give."""
    found = perform("lyapunov", 3, out="here", seconds=50.0, k=15.0, tau=0.19, rods=1)
    attractors = found["numbers"]["point"]["attractors"]
    assert set(attractors) == {"rolling", "at rest"}
    shares = [row["value"] for row in found["answers"] if row["name"].startswith("starts")]
    assert sum(shares) == pytest.approx(100.0)
    wheel = Wheel(k=15.0, tau=0.19, rods=1.0)
    rest, steps = np.array([1.0, 0.0, 0.0, 0.0]), 1e-5 * np.eye(4)
    matrix = [
        (independent.rates(rest + step, wheel) - independent.rates(rest - step, wheel)) / 2e-5
        for step in steps
    ]
    expected = np.sort(np.linalg.eigvals(matrix).real)[::-1]
    assert attractors["at rest"]["exponents"] == pytest.approx(expected, abs=1e-6)


def test_two_ways_to_roll_are_two_attractors_and_two_directions_are_one():
    """Wheels 0 and 1 turn opposite ways; wheel 2 is slower."""
    exponents = {f"exponent_{n}": 1.0 - n for n in range(1, 5)}
    kinds = {"kind": "rolling", "kind_after": "rolling"}
    measured = {"batch": 0, "block": 0, "omega_std": 0.5, "along_flow": True, "by_pairs": 0.0}
    measured["seconds"] = 250.0
    rows = [
        {**exponents, **kinds, **measured, "wheel": wheel, "omega_mean": mean}
        for wheel, mean in enumerate((5.0, -5.0, 4.0))
    ]
    point = spectrum(rows, Wheel())
    assert {name: own["wheels"] for name, own in point["attractors"].items()} == {
        "rolling": 2,
        "rolling (2)": 1,
    }
    assert in_words(point) == "rolling or rolling (2); its start decides"


@pytest.mark.parametrize(("seconds", "attractors"), [(50.0, 1), (250.0, 2)])
def test_exponents_of_a_short_time_do_not_make_two_attractors_of_one(seconds, attractors):
    """A complex pair of multipliers, whose exponents are equal in the long run."""
    kinds = {"kind": "rolling", "kind_after": "rolling", "omega_mean": 5.0, "omega_std": 0.5}
    measured = {"batch": 0, "block": 0, "along_flow": True, "by_pairs": 0.0, "seconds": seconds}
    rows = [
        {
            **kinds,
            **measured,
            "wheel": wheel,
            "exponent_1": 0.0,
            "exponent_2": -0.8 + half,
            "exponent_3": -0.8 - half,
            "exponent_4": -16.0,
        }
        for wheel, half in enumerate((0.0, 0.05))
    ]
    assert len(spectrum(rows, Wheel())["attractors"]) == attractors


def test_the_papers_point_is_judged(small):
    summary = perform("lyapunov", 3, out="here", seconds=50.0)
    (claim,) = [Claim.from_dict(claim) for claim in summary["claims"]]
    assert claim.id == "M8"
    assert claim.holds


def test_the_line_and_the_plane_are_studies_of_their_own(small):
    line = perform("lyapunov-line", 3, out="here")["numbers"]
    assert not line["through_a_crisis"]  # too few wheels to say
    assert line["rolling_ends"]["k"] == pytest.approx(5.168078, abs=1e-6)
    plane = perform("lyapunov-plane", 3, out="here")["numbers"]
    assert plane["accuracy"]["points"] == 8
    assert sum(plane["shares"]["any"].values()) == pytest.approx(1.0)


def test_the_same_seed_gives_the_same_rows(small):
    cell = {"part": "line", "first": 0}
    first, again, other = (lyapunov_line.simulate(cell, Setting(seed, LINE)) for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_a_colour_is_chaos_where_the_exponent_is_positive_and_cycles_have_the_exponent_0():
    """Rolling one way for ever may be chaotic; wheels near the merging have long periods."""
    points = [(0.48, 1.0), (3.0, 1.0), (8.0, 0.25), (1.6, 0.25), (1.85, 0.25), (12.0, 0.6)]
    ks, taus = np.array(points).T
    parameters = Wheel().columns(6, k=ks, tau=taus)
    rows = pieces.from_both_starts(parameters, 2, _chance())
    for row in rows:
        assert (row["kind"] == "chaotic") == (row["exponent"] > 0.05)
        if row["kind"] in ("rolling", "forth-and-back"):
            assert abs(row["exponent"]) < 5e-3
    assert {row["kind"] for row in rows} >= {"chaotic", "rolling", "forth-and-back"}
