"""The experiment `primitives`.

Every transition tried, by kicks alone where the paper says so, and no claim without its evidence.
"""

from collections import Counter
from itertools import pairwise

import pytest

from host.experiments.robot import primitives
from host.perform.run import perform
from host.runs.contract import Setting

KS = (0.4, 0.5, 8.0)


@pytest.fixture(scope="module")
def summary(tmp_path_factory):
    """One round, one start and one try of rest at three k, through the robot's whole loop."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(primitives, "KS", KS)
        return perform(
            "primitives", "sim://", seed=2, out=tmp_path_factory.mktemp("results"), trials=1
        )


def claims_of(summary):
    return {claim["id"]: claim for claim in summary["claims"]}


def row(begin, end, *, reached=True, k=8.0):
    return {
        "kind": "transition",
        "begin": begin,
        "end": end,
        "reached": reached,
        "kicks": 1,
        "seconds": 1.0,
        "k_before": 8.0,
        "k": k,
    }


def round_of(**changes):
    """Rows in which all went well, with changes to the transition from forward to backward."""
    rows = [
        row(*pair, **(changes if pair == ("forward", "backward") else {}))
        for pair in pairwise(primitives.circuit())
    ]
    rows += [{"kind": "rest", "k": k, "runs": k > 0.45, "stays": k < 0.6} for k in primitives.KS]
    return [
        *rows,
        *(
            {"kind": "start", "side": side, "hz": hertz, "duty_pct": 85.0, "ripple": 0.0}
            for side, hertz in started()
        ),
    ]


def started(backward=-2.0):
    return 5 * [("left", 2.0), ("right", backward)]


def verdict(rows, number):
    findings = primitives.report(rows, Setting(1, {"trials": 1}))
    return next(claim for claim in findings.claims if claim.id == number)


def test_a_round_makes_every_transition_once_each_from_where_the_last_ended():
    tour = primitives.circuit()
    wanted = {
        (begin, end): 1 for begin in primitives.STATES for end in primitives.STATES if begin != end
    }
    assert Counter(pairwise(tour)) == wanted


def test_all_primitives_are_reached_from_each_other(summary):
    claims = claims_of(summary)
    assert claims["R7"]["holds"], claims["R7"]
    assert len(summary["numbers"]["transitions"]) == 20
    assert all(
        score["reached"] == score["of"] == 1 for score in summary["numbers"]["transitions"].values()
    )


def test_speed_power_and_steadiness_are_the_papers(summary):
    claims = claims_of(summary)
    assert all(claims[number]["holds"] for number in ("R2", "R3", "R4")), claims


def test_rest_beside_locomotion_is_found_where_it_is_and_only_there(summary):
    found = summary["numbers"]["rest_after_a_pulse_of_k"]
    assert found["0.4"] == {"runs": [0, 1], "stays": [1, 1]}
    assert found["0.5"] == {"runs": [1, 1], "stays": [1, 1]}
    assert found["8.0"] == {"runs": [1, 1], "stays": [0, 1]}


def test_rows_in_which_all_went_well_make_the_claims_hold():
    assert all(verdict(round_of(), number).holds for number in ("R1", "R2", "R3", "R4", "R7"))


def test_a_transition_that_failed_or_needed_another_k_is_not_one_by_kicks_alone():
    assert not verdict(round_of(reached=False), "R7").holds
    assert not verdict(round_of(k=4.0), "R7").holds


def test_without_every_transition_the_rest_can_only_disprove():
    def rows(**changes):
        return [
            row
            for row in round_of(**changes)
            if (row.get("begin"), row.get("end")) != ("stopped", "spin-left")
        ]

    assert verdict(rows(), "R7").holds is None
    assert "19 transitions are too few: it takes 20" in verdict(rows(), "R7").note
    assert verdict(rows(reached=False), "R7").holds is False


def test_a_few_starts_do_not_show_both_directions():
    rows = [row for row in round_of() if row["kind"] != "start"] + round_of()[-4:]
    assert verdict(rows, "R1").holds is None


@pytest.mark.parametrize("number", ["R1", "R2", "R3", "R4", "R7"])
def test_another_motor_decides_nothing(number):
    other = Setting(1, {"trials": 1}, motor="nxt_unroller")
    (claim,) = [
        claim for claim in primitives.report(round_of(), other).claims if claim.id == number
    ]
    assert claim.holds is None


def test_rest_that_coexists_with_locomotion_nowhere_is_a_failure():
    rows = [
        {**row, "stays": row["k"] < 0.45} if row["kind"] == "rest" else row for row in round_of()
    ]
    assert not verdict(rows, "R7").holds


@pytest.mark.parametrize("backward", [2.0, -1.8])
def test_one_direction_alone_or_of_another_speed_is_no_coexistence_of_mirror_images(backward):
    rows = [row for row in round_of() if row["kind"] != "start"]
    rows += [
        {"kind": "start", "side": side, "hz": hertz, "duty_pct": 85.0, "ripple": 0.0}
        for side, hertz in started(backward)
    ]
    assert verdict(rows, "R1").holds is False
