"""The robot's claims from counted kicks: holds, does not hold, or undecided."""

import pytest

from host.kicking.robot_claims import LEAST_TRIALS, SURE_LENGTHS, inversions, quenched


@pytest.mark.parametrize(
    ("reversals", "holds"),
    [
        ([True] * 50, True),
        ([True] * 49, None),
        ([True] * 49 + [False], False),
        ([True, False], False),
        ([True] * 5999 + [False], True),
        ([], None),
    ],
)
def test_r8_takes_fifty_inversions_to_hold_and_failures_of_a_percent_not_to(reversals, holds):
    assert inversions(reversals).holds is holds


def kicks(tried, sure=1.0, at_one=0.0, long=0.0):
    """R9 from kicks of 1 to 7 ticks, with these rates."""
    rates = {1: at_one, 2: 0.5, 3: sure, 4: sure, 5: sure, 6: 0.5, 7: long}
    counts = {ticks: (round(rate * tried), tried) for ticks, rate in rates.items()}
    return quenched("R9", "a kick is reliable", "anywhere", counts, rates, tried, "kicks")


@pytest.mark.parametrize(
    ("rates", "holds"),
    [({}, True), ({"sure": 0.9}, False), ({"at_one": 0.2}, False), ({"long": 0.2}, False)],
)
def test_a_quenched_kick_is_judged_from_twenty_trials_on(rates, holds):
    assert set(SURE_LENGTHS) == {3, 4, 5}
    assert kicks(LEAST_TRIALS, **rates).holds is holds
    few = kicks(LEAST_TRIALS - 1, **rates)
    assert few.holds is None
    assert "19 kicks are too few: it takes 20 to decide" in few.note
