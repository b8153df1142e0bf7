"""The kick map: where it places a kick, what it counts, and the choice from it."""

import json
from math import pi

import numpy as np
import pytest

from host.client.robot import connect
from host.experiments.robot import kick_map
from host.experiments.robot.kick_map_rows import counts, share
from host.kicking import planning
from host.kicking.kick_map import (
    KINDS,
    LENGTHS,
    PHASE_BINS,
    bin_edges_rad,
    count,
    lengths,
    phase_bin,
    tally,
)
from host.kicking.planning import Plan, choose, reversal
from host.logs.log import Log
from host.perform.run import perform
from host.runs.contract import Setting
from robot.kicks import MEMBRANE, PHASE, POSITION, WHEELS, Kick
from robot.params import Params
from sim_motor import batch

DEFAULTS = Params().values()
QUARTER = PHASE_BINS // 4


def rows(mode, sign, ticks, rates, before=1, tried=100):
    """A map's rows; rates: one for all phases, or by the bin."""
    by_bin = [rates] * PHASE_BINS if isinstance(rates, (int, float)) else rates
    kick = {"mode": mode, "sign": sign, "ticks": ticks, "before": before, "tried": tried}
    return [
        {**kick, "phase": number, "reversed": round(tried * rate)}
        for number, rate in enumerate(by_bin)
    ]


# Where a kick meets a wheel.


def test_the_batch_returns_the_angle_that_the_kicks_first_tick_read():
    result = batch.run(20, 200, 1, kick=Kick("m", MEMBRANE, WHEELS, 1, begin=150), record=20)
    assert np.array_equal(result.kick_phi_rad, result.records[:, 150, 0])
    assert np.isnan(batch.run(2, 50, 1).kick_phi_rad).all()


def test_every_count_of_the_encoder_has_its_bin_forward_and_backward():
    """Whole counts in double precision, any number of turns away.

    Ten of them in each bin, none on its edge.
    """
    for turn in (-1000, -1, 0, 1, 1000):
        bins = [phase_bin((360 * turn + degree) * pi / 180) for degree in range(360)]
        assert bins == [degree // 10 for degree in range(360)]
    low, high = bin_edges_rad(7)
    assert phase_bin(low + 1e-9) == phase_bin(high - 1e-9) == 7


def test_lengths_cover_the_same_stretch_of_time_at_any_tick():
    assert lengths(0.03) == list(LENGTHS)
    assert (lengths(0.01)[0], lengths(0.01)[-1]) == (3, 36)
    assert lengths(0.1) == [1, 2, 3, 4]


# The map.


def test_a_map_counts_every_wheel_that_ran_and_depends_on_its_seed_alone():
    once, again, other = (tally(POSITION, 0, 8, 400, seed, params=Params()) for seed in (1, 1, 2))
    assert once == again != other
    assert 380 <= count(once)[1] <= 400
    assert {row["before"] for row in once} == {1, -1}


def test_success_has_the_quarter_turn_symmetry_of_two_rods_and_not_of_chance():
    """At 8 ticks inverted positions reverse at some phases only, and again a quarter turn on."""
    found = [
        {"ticks": 8, **row}
        for row in tally(POSITION, 0, 8, 8000, 4, params=Params())
        if row["before"] == 1
    ]
    shares = share(counts(found))[LENGTHS.index(8)]
    assert shares.max() > 0.9
    assert shares.min() < 0.02
    assert np.abs(shares - np.roll(shares, QUARTER)).max() < 0.3
    assert np.abs(shares - np.roll(shares, QUARTER // 2)).max() > 0.8


def test_the_two_directions_mirror_each_other():
    for sign in (1, -1):
        found = tally(PHASE, sign, 9, 4000, 5, params=Params())
        done, tried = count(row for row in found if row["before"] == sign)
        assert done / tried == pytest.approx(0.47, abs=0.06)


# The choice.


def test_the_length_farthest_from_failure_is_chosen():
    shares = {1: 0, 2: 0.5, 3: 1, 4: 1, 5: 0.995, 6: 1, 7: 1, 8: 0.3, 9: 1}
    found = [row for ticks, rate in shares.items() for row in rows(POSITION, 0, ticks, rate)]
    assert choose(found, 1) == Plan(POSITION, 5, None, None, 3600, 3600)
    assert choose(found, -1) is None


def test_a_kick_that_fails_at_some_phases_is_given_at_the_others_and_not_at_their_edges():
    shares = [1.0 if number >= 30 or number < 6 else 0.0 for number in range(PHASE_BINS)]
    plan = choose(rows(PHASE, 1, 4, shares) + rows(PHASE, 1, 5, 0.9), 1)
    assert (plan.mode, plan.ticks, plan.shift_rad) == (PHASE, 4, 3 * pi / 4)
    assert [round(edge) for edge in plan.window_deg()] == [310, 50]
    met = [degree for degree in range(360) if plan.meets(degree * pi / 180)]
    assert met == [*range(50), *range(310, 360)]
    assert plan.meets(-20 * pi) == plan.meets(20 * pi) is True
    assert (plan.tried, plan.reversed) == (1000, 1000)


def test_the_wait_is_until_the_first_tick_in_the_window():
    plan = Plan(PHASE, 4, 1.0, (1.0, 1.5))
    assert plan.wait_ticks(0.0, 0.4) == 3
    assert plan.wait_ticks(2.0, -0.4) == 2
    assert plan.wait_ticks(1.2, 2 * pi) == 1
    assert plan.wait_ticks(0.0, 0.0) is None
    assert Plan(PHASE, 4).wait_ticks(0.0, 0.0) == 1


@pytest.mark.parametrize(
    "nothing", [[], rows(POSITION, 0, 3, 0.5), rows(POSITION, 0, 3, [1.0] * 2 + [0.0] * 34)]
)
def test_where_nothing_is_sure_nothing_is_planned(nothing):
    assert choose(nothing, 1) is None


@pytest.mark.parametrize(
    ("changes", "mode", "blind_ticks", "dips_to"),
    [
        ({}, POSITION, 8, 0.4),
        ({"k": 2.0}, POSITION, 3, 0.7),
        ({"tick_s": 0.02}, POSITION, 3, 0.05),
        ({"tick_s": 0.05}, PHASE, 7, 0.1),
    ],
)
def test_the_planned_kick_reverses_from_any_phase_where_a_blind_one_dips(
    changes, mode, blind_ticks, dips_to
):
    """Borne out by wheels, motors and chances that the plan has not seen, forward and backward."""
    params = Params()
    params.apply(params.check({"k": 8.0, **changes}))
    plans = {before: reversal(before, params.values()) for before in (1, -1)}
    for before, plan in plans.items():
        sign = round((plan.shift_rad or 0.0) / (3 * pi / 4))
        seen = [
            row
            for row in tally(plan.mode, sign, plan.ticks, 1000, 77, params=params)
            if row["before"] == before
        ]
        met = [row for row in seen if plan.meets(sum(bin_edges_rad(row["phase"])) / 2)]
        done, tried = count(met)
        assert done >= 0.99 * tried > 300
        blind = [
            row
            for row in tally(mode, before * (mode == PHASE), blind_ticks, 400, 78, params=params)
            if row["before"] == before
        ]
        done, tried = count(blind)
        assert done <= dips_to * tried


def test_a_plan_is_computed_once_for_a_robots_parameters(monkeypatch):
    planned = reversal(1, DEFAULTS)
    monkeypatch.setattr(planning, "_compute_plan", None)
    assert reversal(1, {**DEFAULTS, "link_loss": "hold"}) == planned


def test_a_plan_of_other_sources_is_not_taken(monkeypatch):
    plans = iter([Plan(PHASE, 4), Plan(PHASE, 5)])
    monkeypatch.setattr(planning, "_compute_plan", lambda *_: next(plans))
    monkeypatch.setattr(planning, "sources", lambda: "1111")
    first = reversal(1, DEFAULTS)
    monkeypatch.setattr(planning, "sources", lambda: "2222")
    assert reversal(1, DEFAULTS) == Plan(PHASE, 5)
    monkeypatch.setattr(planning, "sources", lambda: "1111")
    assert reversal(1, DEFAULTS) == first


def test_no_plan_is_kept_after_a_source_has_changed(monkeypatch):
    """As in a lab that has run for days: it may have been computed by the changed code."""
    plans = iter([Plan(PHASE, 4), Plan(PHASE, 5)])
    monkeypatch.setattr(planning, "_compute_plan", lambda *_: next(plans))
    with monkeypatch.context() as changed:
        changed.setattr("host.util.provenance._places", list)  # the sources are gone
        reversal(1, DEFAULTS)
    assert reversal(1, DEFAULTS) == Plan(PHASE, 5)


def test_only_the_newest_plans_are_kept(monkeypatch):
    monkeypatch.setattr(planning, "_KEPT", 2)
    asked = []
    monkeypatch.setattr(
        planning, "_compute_plan", lambda before, motor, *chosen: asked.append(chosen[2])
    )
    for k in (5.0, 6.0, 7.0, 7.0, 6.0, 5.0):
        reversal(1, {**DEFAULTS, "k": k})
    assert asked == [5.0, 6.0, 7.0, 5.0]


def test_plans_with_a_window_and_none_at_all_are_kept_as_they_are(monkeypatch):
    plans = iter([Plan(PHASE, 12, -1.0, (6.0, 0.5), 30, 30), None])
    monkeypatch.setattr(planning, "_compute_plan", lambda *_: next(plans))
    fresh = [reversal(before, DEFAULTS) for before in (1, -1)]
    assert [reversal(before, DEFAULTS) for before in (1, -1)] == fresh
    assert fresh[0].window_rad == (6.0, 0.5)
    assert fresh[1] is None


@pytest.mark.parametrize("damage", ["", "no json", "[]"])
def test_kept_plans_that_cannot_be_read_are_computed_again(monkeypatch, damage):
    monkeypatch.setattr(planning, "_compute_plan", lambda *_: Plan(PHASE, 4))
    reversal(1, DEFAULTS)
    planning._file().write_text(damage)
    assert reversal(1, DEFAULTS) == Plan(PHASE, 4)


# The experiment.


def test_the_experiment_tries_what_was_asked_in_chunks_and_reports_the_best_beside_the_blind(
    tmp_path,
):
    assert sum(
        cell["kicks"] for cell in kick_map.cells({"kicks": 2000000}, batch=True)
    ) == pytest.approx(2000000, abs=36)
    summary = perform("kick-map", kicks=36 * 300, out=tmp_path, seed=2)
    assert json.loads(json.dumps(summary["numbers"])) == summary["numbers"]
    assert {claim["id"]: claim["measured"] for claim in summary["claims"]} == {
        "R9": 1.0,
        "R10": 1.0,
    }
    for claim in summary["claims"]:  # four kicks at a phase, all of which reversed
        assert (claim["holds"], claim["verdict"]) == (None, "undecided")
        assert "too few" in claim["note"]
    maps = {
        (entry["mode"], entry["sign"], entry["before"]): entry
        for entry in summary["numbers"]["maps"]
    }
    assert len(maps) == 6
    for entry in maps.values():
        assert entry["best"]["window_deg"] is None
        assert entry["best"]["rate"] > 0.99
        assert entry["best"]["ticks"] in {4, 5, 6}
    assert maps[POSITION, 0, 1]["blind"][LENGTHS.index(8)]["rate"] < 0.4
    assert maps[POSITION, 0, 1]["blind"][LENGTHS.index(8)]["at_the_worst_phase"] == 0


def test_on_a_robot_the_phase_is_that_of_the_kicks_first_tick():
    cell = {"mode": PHASE, "sign": 1, "ticks": 4, "trial": 0}
    with connect("sim://", 1) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        found = kick_map.trial(cell, robot, log, Setting(1, {"kicks": 36}))
        row, kick = log.kicks()[0]
    phis = [log.records[row].left_phi_rad, log.records[row].right_phi_rad]
    assert log.records[row].tick == kick["begin"]
    assert [entry["phase"] for entry in found] == [phase_bin(phi) for phi in phis]
    assert [entry["tried"] for entry in found] == [1, 1]
    assert len(kick_map.cells({"kicks": 72}, batch=False)) == 2 * len(KINDS) * len(LENGTHS)


@pytest.mark.parametrize("tried", ["all", "all but one bin"])
def test_the_figure_says_what_is_white_where_something_is(tried):
    from host.figures.robot.kick_map import draw

    everything = [
        row
        for mode, sign in ((POSITION, 0), (PHASE, 1), (PHASE, -1))
        for before in (1, -1)
        for ticks in LENGTHS
        for row in rows(mode, sign, ticks, 1.0, before)
    ]
    some = everything if tried == "all" else everything[:-1]
    figure = draw(some, kick_map.report(some, Setting(1, {"trials": len(some)})))
    assert ("white: not tried" in figure.get_suptitle()) == (tried != "all")
