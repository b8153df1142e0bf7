"""When the claims about cars and trains hold, do not hold, or are undecided."""

import pytest

from host.experiments.bodies import car_slope, train_start, train_wall
from host.runs.contract import Setting


def wall_rows(counts, ended=train_wall.STUCK):
    """Runs with so many reversals, by (preset, drag, bouncy)."""
    rows = []
    for train in train_wall.TRAINS:
        for bouncy in (False, True):
            own = {
                **train,
                "bouncy": bouncy,
                "number": 0,
                "whole": counts[train["preset"]],
                "aside_m": 0.0,
            }
            times = [float(time) for time in range(9)]  # not all of them of the whole train
            rows += [{**own, "controller": True, "reversals_s": times, "ended": train_wall.RUNS}]
            rows += [{**own, "controller": False, "reversals_s": [], "ended": ended}]
    return rows


@pytest.mark.parametrize(
    ("paper", "snake", "ended", "holds"),
    [
        (5, 5, train_wall.STUCK, True),
        (9, 4, train_wall.STUCK, False),
        (4, 9, train_wall.STUCK, False),
        (9, 9, train_wall.RUNS, False),
    ],
)
def test_b3_wants_five_reversals_of_both_presets_and_none_without_neurons(
    paper, snake, ended, holds
):
    rows = wall_rows({"paper": paper, "snake2019": snake}, ended)
    long = Setting(1, {"seconds": 60.0, "seeds": 3})
    (claim,) = train_wall.report(rows, long).claims
    assert claim.holds is holds
    for short in ({"seconds": 59.0, "seeds": 3}, {"seconds": 60.0, "seeds": 2}):
        (undecided,) = train_wall.report(rows, Setting(1, short)).claims
        assert undecided.holds is None
    assert claim.measured == min(paper, snake)


def start_rows(orders, ways):
    return [
        {
            "preset": name,
            "number": number,
            "t_s": t_s,
            "order": order if t_s else 0.2,
            "omega_rad_s": 40.0 * way,
        }
        for name in ("paper", "snake2019")
        for number, (order, way) in enumerate(zip(orders, ways, strict=True))
        for t_s in (0.0, 5.0, 5.5)
    ]


@pytest.mark.parametrize(
    ("orders", "ways", "seeds", "holds"),
    [
        ((1.0, 1.0), (1, -1), 10, True),
        ((1.0, 1.0), (1, -1), 9, None),
        ((1.0, 0.9), (1, -1), 10, False),
        ((1.0, 0.9), (1, -1), 2, False),
        ((1.0, 1.0), (1, 1), 10, False),
        ((1.0, 1.0), (1, 1), 2, None),
    ],
)
def test_b2_wants_all_trains_ordered_and_both_directions(orders, ways, seeds, holds):
    rows = start_rows(orders, ways)
    findings = train_start.report(rows, Setting(1, {"seconds": 15.0, "seeds": seeds}))
    assert findings.claims[0].holds is holds
    (short,) = train_start.report(rows, Setting(1, {"seconds": 3.0, "seeds": seeds})).claims
    assert short.holds is None
    assert findings.numbers["paper"]["ordered_s_latest"] == 5.0


@pytest.mark.parametrize(
    ("inside", "flipped", "seconds", "last_s", "holds"),
    [
        (True, False, 600.0, 600.0, True),
        (False, False, 600.0, 600.0, False),
        (True, True, 600.0, 600.0, False),
        (True, False, 599.0, 599.0, None),
        (True, False, 600.0, 300.0, True),
    ],
)
def test_b1_wants_ten_minutes_inside_on_the_wheels(inside, flipped, seconds, last_s, holds):
    fixed = {
        "reach_m": 5.0,
        "lean_rad": 0.3,
        "reversals": 9,
        "path_m": 1.0,
        "travelled": 1.0,
        "last_s": last_s,
        "spun": 0.0,
        "squares": 9,
    }
    rows = [
        {"angle": angle, "number": 0, "inside": inside, "flipped": flipped, **fixed}
        for angle in car_slope.ANGLES
    ]
    (claim,) = car_slope.report(rows, Setting(1, {"seconds": seconds, "seeds": 1})).claims
    assert claim.holds is holds
