"""The study `branch`: its numbers by two methods, its claims, and runs that find nothing."""

import json

import numpy as np
import pytest

from host.figures.theory.branch import draw
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.model.wheel import Wheel
from host.theory.studies import branch
from host.theory.studies.branch_formula import Deviation, claim_m6
from host.theory.studies.branch_merging import period_law
from host.theory.studies.registry import TABLE
from tests.paper.theory import independent
from tests.paper.theory.table import rows_of


def setting(**options):
    return Setting(1, complete_options("branch", TABLE["branch"], options))


PAPER = setting(to=3.0)


@pytest.fixture(scope="module")
def rows():
    return rows_of(branch, PAPER, ("fixpoints", "merging", "FB", "LLM", "dry", "turning"))


@pytest.fixture(scope="module")
def found(rows):
    return branch.report(rows, PAPER)


def claim(found, number):
    return next(claim for claim in found.claims if claim.id == number)


def test_the_contract_has_the_merging_and_the_special_points_in_plain_data(found):
    numbers = json.loads(json.dumps(found.numbers, allow_nan=False))
    assert numbers["k_merge"] == pytest.approx(1.77731184665692, rel=1e-12)
    points = {(point["type"], point["branch"]): point for point in numbers["special_points"]}
    assert set(points) == {
        ("hopf", "rest"),
        ("merging", "saddles"),
        ("fold", "rotation with dry friction"),
        ("merging", "rotation with dry friction"),
    }
    assert all(
        {"type", "k", "omega_mean", "multipliers"} <= set(point) for point in points.values()
    )
    assert points["hopf", "rest"]["multipliers"][0] == pytest.approx([1.0, 0.0], abs=1e-9)
    assert points["fold", "rotation with dry friction"]["multipliers"][0] == pytest.approx(
        [1.0, 0.0], abs=1e-9
    )


def test_two_methods_agree_in_each_number(found, rows):
    accuracy = found.numbers["accuracy"]
    assert max(accuracy["merging_against_extrapolated_branches"].values()) < 1e-9
    assert set(accuracy["merging_against_extrapolated_branches"]) == {"FB", "LLM"}
    assert accuracy["merging_with_other_begin_and_shorter_steps"] < 1e-12
    assert accuracy["bifurcations_of_cycles_with_shorter_steps"] < 1e-10
    assert accuracy["hopf_closed_form_against_eigenvalues"] < 1e-12
    assert accuracy["cycles_against_time_stepping_rad_per_s"] < 1e-6
    assert accuracy["product_of_multipliers"] < 1e-12
    assert {row["part"] for row in rows if row["kind"] == "check"} == {"FB", "LLM", "dry"}


def test_the_period_grows_towards_the_merging_as_the_saddles_growth_rate_says(found):
    """Swinging passes two saddles in a period, rolling four."""
    saddle = [np.sqrt(0.5), -np.sqrt(0.5), -np.pi / 4, 0.0]
    wheel = Wheel(k=found.numbers["k_merge"])
    growth = np.linalg.eigvals(independent.jacobian(saddle, wheel)).real.max()
    for part, passages in (("FB", 2), ("LLM", 4)):
        law = found.numbers["period_law"][part]
        assert law["predicted_s"] == pytest.approx(-passages / growth, rel=1e-9)
        assert law["limit_s"] == pytest.approx(law["predicted_s"], abs=law["limit_error_s"])
        assert law["limit_error_s"] < 4e-3
        assert law["slope_s"] == pytest.approx(law["predicted_s"], rel=0.025)
        assert law["slope_s"] == pytest.approx(law["explained_s"], rel=2e-4)
        assert law["slope_s"] != pytest.approx(law["predicted_s"], rel=0.01)


def _law_of(growth, higher=0.0):
    """The law of cycles whose distances fall as exp(-0.8 T/2) and exp(-growth T/2)."""
    periods = np.linspace(8.0, 30.0, 40)
    slow, fast = (np.exp(-rate * periods / 2) for rate in (0.8, growth))
    values = 1.0 - 1e-3 * (2 * slow + fast + higher * (slow + fast) ** 2)
    rows = [
        {"part": "FB", "kind": "cycle", "way": None, "value": value, "period": period}
        for value, period in zip(values.tolist(), periods.tolist(), strict=True)
    ]
    rates = (growth, -0.8, -1.0, -11.0)
    merging = {"value": 1.0, "eigenvalues": [[rate, 0.0] for rate in rates]}
    return period_law(rows, "FB", merging)


def test_where_the_saddle_quantity_is_positive_the_rate_of_decay_rules_the_period():
    law = _law_of(0.9)
    assert law["predicted_s"] == pytest.approx(-2 / 0.8)
    assert law["limit_s"] == pytest.approx(-2 / 0.8, rel=1e-4)
    assert law["explained_s"] == pytest.approx(law["slope_s"], rel=1e-6)
    assert law["power"] == pytest.approx(0.125)


def test_the_limit_has_an_error_and_is_refused_where_both_rates_nearly_agree():
    law = _law_of(0.9, 0.3)
    assert abs(law["limit_s"] + 2 / 0.8) < law["limit_error_s"] < 0.02
    assert _law_of(0.81, 0.3)["limit_s"] is None


def test_rest_swings_and_rotations_are_stable_where_the_paper_finds_them(rows):
    for k, part, stable in (
        (1.4, "fixpoints", True),
        (1.65, "fixpoints", False),
        (1.65, "FB", True),
        (1.85, "LLM", True),
    ):
        near = min(
            (row for row in rows if row["part"] == part and row["kind"] in ("cycle", "fixpoint")),
            key=lambda row: abs(row["value"] - k),
        )
        assert near["value"] == pytest.approx(k, rel=0.07)
        assert near["stable"] is stable
    assert all(not row["stable"] for row in rows if row["kind"] == "fixpoint" and row["phi"] > 0.0)
    amplitudes = [
        row["amplitude"] for row in rows if row["part"] == "FB" and row["kind"] == "cycle"
    ]
    assert amplitudes == sorted(amplitudes)
    assert 0.785 < amplitudes[-1] < 0.7854


def test_the_claims_hold_and_say_where_the_formula_does_not(found):
    assert claim(found, "M5").holds
    assert "no hysteresis" in claim(found, "M5").note
    assert claim(found, "M9").holds
    assert claim(found, "M6").holds is None
    assert "to = 20 or more (here 3)" in claim(found, "M6").note
    assert claim(found, "M6").measured > 0.2
    assert found.numbers["formula_within_5_percent"] == []


def test_m5_does_not_hold_if_a_branch_does_not_reach_the_merging_or_cycles_are_born_unstable(rows):
    without = [
        row
        for row in rows
        if not (row["part"] == "FB" and row["kind"] == "cycle" and row["period"] > 4.0)
    ]
    assert claim(branch.report(without, PAPER), "M5").holds is False
    unstable = [{**row, "l1": 0.1} if row.get("type") == "hopf" else row for row in rows]
    assert claim(branch.report(unstable, PAPER), "M5").holds is False


def test_other_constants_decide_nothing(rows):
    found = branch.report(rows, setting(tau=0.1))
    assert [(claim.id, claim.holds) for claim in found.claims] == [
        ("M5", None),
        ("M6", None),
        ("M9", None),
    ]
    assert all("made for tau = 0.25 (here 0.1)" in claim.note for claim in found.claims)


def test_along_another_constant_m5_and_m6_are_undecided_and_name_theirs(rows):
    found = branch.report(rows, setting(along="tau"))
    assert [(claim.id, claim.holds) for claim in found.claims] == [
        ("M5", None),
        ("M6", None),
        ("M9", True),
    ]
    for number in ("M5", "M6"):
        assert "made for along = k (here tau)" in claim(found, number).note


def test_a_branch_that_ends_before_the_merging_decides_neither(rows):
    before = [row for row in rows if row.get("value", 0.0) < 1.6]
    found = branch.report(before, setting(to=1.6))
    for number in ("M5", "M6"):
        one = claim(found, number)
        assert (one.measured, one.holds, one.number()) == (None, None, "nothing")
        assert "to = 20 or more (here 1.6)" in one.note


def test_a_whole_branch_without_a_merging_disproves_m5(rows):
    without = [row for row in rows if row.get("type") != "merging"]
    assert claim(branch.report(without, setting()), "M5").holds is False


def test_m6_does_not_hold_if_the_formula_is_off_at_the_end_of_the_whole_branch(rows):
    assert claim(branch.report(rows, setting()), "M6").holds is False


def test_the_branch_with_dry_friction_ends_in_a_fold_below_its_merging(found):
    dry = found.numbers["dry"]
    (fold,) = dry["folds"]
    assert found.numbers["k_merge"] < fold["value"] < dry["merging"]
    assert fold["omega_mean"] > 0.5
    assert dry["merging_by_extrapolation"] == pytest.approx(dry["merging"], rel=1e-8)


def test_the_figure_shows_stable_and_unstable_parts(found, rows):
    figure = draw(rows, found)
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert {"rotation with dry friction", "unstable", "fold", "Hopf", "merging"} <= {*labels}
    assert "Neimark-Sacker" not in labels  # there is none at this tau
    figure.draw_without_rendering()
    box = legend.get_window_extent()
    assert box.x0 >= 0.0
    assert box.x1 <= figure.bbox.x1


def test_nothing_to_find_is_said_and_drawn():
    low = setting(to=1.0)
    rows = rows_of(branch, low, ("fixpoints", "merging", "FB", "LLM", "turning"))
    found = branch.report(rows, low)
    assert found.numbers["k_merge"] is None
    assert found.numbers["special_points"] == []
    assert "rolling" in found.numbers["ends"][0]["end"]
    assert [(claim.id, claim.holds) for claim in found.claims] == [
        ("M5", None),
        ("M6", None),
        ("M9", True),
    ]
    draw(rows, found).canvas.draw()


def test_another_constant_is_followed_to_the_same_merging():
    along = setting(along="f", k=1.77731184665692)
    rows = rows_of(branch, along, ("merging",))
    report = branch.report([*rows, *rows_of(branch, along, ("turning",))], along)
    (point,) = report.numbers["special_points"]
    assert (point["type"], point["f"], point["k"]) == (
        "merging",
        pytest.approx(0.5, rel=1e-10),
        1.77731184665692,
    )


@pytest.mark.parametrize(
    ("along", "words"),
    [
        ("k", "begins at k = 1,"),
        ("a", "begins at a = 2.162,"),
        ("tau", "begins at tau = 0.1351,"),
        ("f", "ends at f = a k tau / 2 = 0.925"),
        ("I", "same for all I"),
    ],
)
def test_m6_says_where_the_formula_begins_along_each_constant(along, words):
    note = claim_m6([Deviation(1.0, 0.1, "")], [], [], along, Wheel()).note
    assert words in note
