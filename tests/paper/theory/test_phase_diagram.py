"""M7: the phase diagram."""

from __future__ import annotations

import json

import numpy as np
import pytest

from host.runs.contract import Part, Setting
from host.runs.registry import complete_options
from host.theory.analysis import deciding
from host.theory.analysis.deciding import STILL
from host.theory.analysis.hopf import critical_k
from host.theory.analysis.merging import merging
from host.theory.analysis.phases import phases
from host.theory.engine.ensemble import averages, rate_per_s
from host.theory.model.turning import constant_velocity, rolling_states, turning
from host.theory.model.wheel import OMEGA, Wheel, resting
from host.theory.studies import phase_diagram
from host.theory.studies.registry import TABLE
from kickctl.theory import PhaseDiagram
from tests.lint.sources import ROOT
from tests.paper.theory.independent import last
from tests.paper.theory.table import rows_of

OPTIONS = complete_options(
    "phase-diagram", TABLE["phase-diagram"], {"points": 10, "transient": 60.0, "seconds": 40.0}
)


@pytest.fixture(scope="module")
def diagram():
    """A coarse diagram's rows, and what they come to."""
    setting = Setting(1, OPTIONS)
    rows = rows_of(phase_diagram, setting)
    return rows, phase_diagram.report(rows, setting)


def at(rows, panel, way, tau, k):
    """The row nearest to a point."""
    own = [row for row in rows if row["panel"] == panel and row["way"] == way]
    return min(own, key=lambda row: abs(row["tau"] - tau) + abs(row["k"] - k) / 10)


def test_every_point_is_there_once_each_way(diagram):
    rows, _ = diagram
    for panel in ("plane", "inset"):
        for way in ("up", "down"):
            points = [
                (row["tau"], row["k"])
                for row in rows
                if row["panel"] == panel and row["way"] == way
            ]
            assert len(points) == len(set(points)) == OPTIONS["points"] ** 2


def test_the_four_phases_are_where_the_paper_has_them(diagram):
    rows, _ = diagram
    expected = {
        ("plane", 0.08, 1.0): "S",
        ("plane", 0.2, 9.0): "LLM",
        ("plane", 1.4, 15.0): "C",
        ("inset", 0.12, 3.2): "FB",
    }
    for (panel, tau, k), name in expected.items():
        row = at(rows, panel, "up", tau, k)
        assert row["phase"] == name, row


def test_far_from_the_line_a_wheel_rests_exactly_below_it(diagram):
    rows, _ = diagram
    for row in rows:
        if row["panel"] == "accuracy":
            continue
        line = critical_k(Wheel(tau=row["tau"]))
        if row["way"] == "up" and not 0.8 < row["k"] / line < 1.2:
            rests = abs(row["omega_mean"]) < STILL and row["omega_std"] < STILL
            assert rests == (row["k"] < line), row


def test_locomotion_that_is_fast_has_the_constant_velocity(diagram):
    rows, _ = diagram
    row = at(rows, "plane", "up", 0.2, 9.0)
    expected = constant_velocity(Wheel(tau=row["tau"], k=row["k"]))
    assert abs(row["omega_mean"]) == pytest.approx(expected, rel=0.1)


def test_locomotion_goes_on_into_chaos_with_k_going_up_only(diagram):
    _, findings = diagram
    shares = findings.numbers["hysteresis"]["plane"]
    assert shares["LLM up, C down"] > 0.0
    assert "C up, LLM down" not in shares


def test_points_out_of_chaos_do_not_depend_on_the_step(diagram):
    _, findings = diagram
    found = findings.numbers["accuracy"]
    assert found["points"] > 50
    assert found["p90_rad_s"] < 1e-6


@pytest.mark.parametrize(
    ("options", "holds", "words"),
    [
        ({}, None, "points = 200 or more (here 10)"),
        ({"points": 200, "a": 3.0}, None, "a = 4 (here 3)"),
        ({"points": 200, "start": "up"}, None, "start = sweep (here up)"),
        ({"points": 200, "transient": 100.0, "seconds": 100.0}, True, "misjudges"),
    ],
)
def test_m7_is_decided_by_a_fine_diagram_of_the_papers_wheel(diagram, options, holds, words):
    rows, _ = diagram
    (claim,) = phase_diagram.report(rows, Setting(1, OPTIONS | options)).claims
    assert (claim.id, claim.holds) == ("M7", holds)
    assert words in claim.note


def test_m7_does_not_hold_without_chaos(diagram):
    rows, _ = diagram
    tame = [{**row, "phase": "FB" if row["phase"] == "C" else row["phase"]} for row in rows]
    long = {"points": 200, "transient": 100.0, "seconds": 100.0}
    (claim,) = phase_diagram.report(tame, Setting(1, OPTIONS | long)).claims
    assert claim.holds is False
    assert "not found: C in the plane" in claim.note


@pytest.mark.parametrize(
    ("wheel", "phase"),
    [
        (Wheel(k=13.5, tau=0.19, rods=1.0), "LLM"),
        (Wheel(k=10.0, tau=0.19, rods=1.0), "LLM"),
        (Wheel(k=15.0, tau=1.0), "C"),
    ],
)
def test_a_wheel_is_chaotic_where_scipy_sees_close_wheels_part(wheel, phase):
    """One rod makes a wheel roll so unevenly that omega deviates by more than 0.6 of its mean."""
    found = averages(rolling_states(wheel.columns(1)) + 1e-3, wheel.columns(1), 60.0, 40.0)
    assert found.omega_std > 0.6 * abs(found.omega_mean)
    assert phases(found, wheel.columns(1)) == [phase]
    start = found.states[:, 0]
    one, other = (last(y, wheel, 20.0, rtol=1e-9) for y in (start, start + 1e-7))
    assert (np.abs(one - other).max() > 1.0) == (phase == "C")


@pytest.mark.parametrize("tau", [0.25, 0.4])
def test_beside_rest_wheels_roll_above_the_merging_and_swing_below(tau):
    """The merging is by bisection; growth from rest takes longer than the averages do."""
    k = merging(Wheel(tau=tau)).k
    parameters = Wheel(tau=tau).columns(2, k=np.array([0.997, 1.003]) * k)
    found = averages(resting(np.full(2, 1e-3)), parameters, 60.0, 40.0)
    assert phases(found, parameters) == ["FB", "LLM"]


@pytest.mark.parametrize(("k", "tau"), [(1.0, 1000.0), (30.0, 1000.0), (0.01, 500.0)])
def test_slow_neurons_do_not_make_a_wheel_rest_where_rest_is_unstable(k, tau):
    wheel = Wheel(k=k, tau=tau)
    assert k > 8 * critical_k(wheel)
    found = averages(resting(np.array([1e-3])), wheel.columns(1), 100.0, 100.0)
    assert found.omega_std < 2e-4
    assert phases(found, wheel.columns(1)) != ["S"]


@pytest.mark.parametrize(("phi", "phase"), [(0.0, "S"), (np.pi / 2, "LLM")])
def test_one_rod_holds_a_wheel_at_0_for_every_k_and_at_90_degrees_for_a_small_one(phi, phase):
    wheel = Wheel(k=8.0, tau=0.25, rods=1.0)
    still = averages(resting(np.array([phi])), wheel.columns(1), 1.0, 1.0)
    assert still.omega_std < 1e-9
    assert phases(still, wheel.columns(1)) == [phase]
    assert phases(still, wheel._replace(k=0.5).columns(1)) == ["S"]


def test_a_wheel_too_fast_for_a_round_is_undecided_and_the_words_say_so(hasty):
    fast = Wheel(k=15.0, tau=1.0, I=1e-4)
    assert rate_per_s(fast.columns(1)) * deciding.FIRST_S > deciding.MOST_STEPS
    found = averages(resting(np.array([1e-3])), fast.columns(1), 2.0, 2.0)
    assert phases(found, fast.columns(1)) == ["undecided"]
    steps = f"{deciding.MOST_STEPS:,}".replace(",", " ")
    for words in (phases.__doc__, PhaseDiagram.__doc__, (ROOT / "docs" / "theory.md").read_text()):
        assert f"more than {steps} steps" in " ".join(words.split())


@pytest.fixture
def hasty(monkeypatch):
    """Wheels are not followed for long."""
    monkeypatch.setattr(deciding, "ROUNDS", 1)


def test_a_cell_done_twice_is_the_same_bits(hasty):
    options = {**OPTIONS, "points": 6, "transient": 5.0, "seconds": 5.0}
    cell = {"panel": "plane", "first": 0, "end": 6}
    assert phase_diagram.simulate(cell, Setting(1, options)) == phase_diagram.simulate(
        cell, Setting(2, options)
    )


@pytest.mark.parametrize("start", ["sweep", "rest"])
def test_a_cell_that_is_resumed_in_the_middle_is_the_same_bits(monkeypatch, hasty, start):
    monkeypatch.setattr(phase_diagram, "KS_OF_A_PART", 2)
    options = {"points": 5, "start": start, "transient": 5.0, "seconds": 5.0}
    setting = Setting(1, {**OPTIONS, **options})
    cell = {"panel": "plane", "first": 0, "end": 5}
    first, *rest = phase_diagram.parts(cell, setting, None)
    assert [part.share for part in (first, *rest)] == [0.4, 0.8, 1.0]
    kept = Part(**json.loads(json.dumps(first._asdict())))
    assert list(phase_diagram.parts(cell, setting, kept)) == rest


@pytest.mark.parametrize("change", [{"f": 1e-3}, {"a": 0.0}, {"I": 1e-3}])
def test_degenerate_wheels_have_a_diagram_without_gaps(hasty, change):
    options = {**OPTIONS, **change, "points": 4, "start": "rest", "transient": 2.0, "seconds": 2.0}
    setting = Setting(1, options)
    rows = rows_of(phase_diagram, setting)
    found = phase_diagram.report(rows, setting)
    assert np.isfinite([row["omega_std"] for row in rows]).all()
    assert sum(found.numbers["shares"]["plane, rest"].values()) == pytest.approx(1.0)


def test_the_state_of_a_turning_wheel_is_that_of_its_equations():
    """Eq. x-t solves tau dx/dt = x_a - x along phi = omega t."""
    wheel, omega, step = Wheel(), 5.0, 1e-5
    before, now, after = (
        turning(np.array([omega * t]), np.array([omega]), wheel)[:, 0]
        for t in (0.7 - step, 0.7, 0.7 + step)
    )
    for row, seen in ((0, np.cos(0.7 * omega)), (1, np.sin(0.7 * omega))):
        assert (after[row] - before[row]) / (2 * step) == pytest.approx(
            (seen - now[row]) / wheel.tau, abs=1e-8
        )
    assert rolling_states(wheel.columns(1))[OMEGA] == [constant_velocity(wheel)]
