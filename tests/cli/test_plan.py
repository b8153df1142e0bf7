"""kickctl plan, and drive by plan: quenched kicks that reverse the robot wherever they meet it."""

import json
from math import pi

import numpy as np
import pytest

from host.client.robot import connect
from host.commands._plan_search import sentences
from host.kicking import planning
from host.kicking.outcome import kick_and_watch, wait_settled
from host.kicking.planning import Plan
from host.kicking.primitives import drive, headings
from host.logs.log import Log
from robot.kicks import MEMBRANE, PHASE, POSITION, WHEELS
from robot.params import Params

OTHER = {"forward": "backward", "backward": "forward"}


def reversals(seed, rounds, changes, reverse):
    """Reverse a robot round after round, at any moment, by reverse(robot, log, headings).

    The kicks that this took.
    """
    rng = np.random.default_rng(seed)
    with connect("sim://", seed) as robot:
        robot.set(**changes)
        robot.wait(3.0)
        log = Log(robot.info())
        robot.add_tap(log)
        kicks = []
        for _ in range(rounds):
            present = headings(robot, log)
            robot.wait(float(rng.uniform(0.0, 1.0)))
            kicks.append(reverse(robot, log, present))
        return kicks


def by_plan(robot, log, present):
    turned = tuple(OTHER[present[side]] for side in WHEELS)
    target = {("forward", "backward"): "spin-right", ("backward", "forward"): "spin-left"}.get(
        turned, turned[0]
    )
    result = drive(robot, log, target)
    assert result["reached"]
    return result["kicks"]


def blind(mode, ticks):
    return lambda robot, log, present: [kick_and_watch(robot, log, mode, ticks=ticks).as_dict()]


@pytest.mark.parametrize(
    ("changes", "mode", "ticks", "most"),
    [
        ({"k": 8.0}, POSITION, 8, 0.6),
        ({"k": 2.0}, POSITION, 3, 0.8),
        ({"tick_s": 0.02}, POSITION, 3, 0.1),
    ],
)
def test_drive_reverses_by_quenched_kicks_of_which_none_fails_where_blind_ones_dip(
    changes, mode, ticks, most
):
    planned = [kicks for seed in range(2) for kicks in reversals(seed, 8, changes, by_plan)]
    assert {kick["mode"] for kicks in planned for kick in kicks} <= {POSITION, PHASE}
    assert sum(kick["reversed"] for kicks in planned for kick in kicks) == sum(map(len, planned))
    tried = [
        kicks[0]["reversed"]
        for seed in range(2)
        for kicks in reversals(seed, 8, changes, blind(mode, ticks))
    ]
    assert np.mean(tried) <= most


@pytest.fixture
def only_a_kick_that_dips(monkeypatch):
    """The only kick is 12 ticks of a negative shift, which fails on half of the forward wheels."""
    monkeypatch.setattr(planning, "KINDS", ((PHASE, -1),))
    monkeypatch.setattr(planning, "lengths", lambda tick_s: [12])
    for kept in (planning._kick_map, planning._compute_plan):
        kept.cache_clear()
    yield
    for kept in (planning._kick_map, planning._compute_plan):
        kept.cache_clear()


def test_a_kick_that_dips_is_given_at_the_moment_at_which_it_reverses(only_a_kick_that_dips):
    assert 0.1 < np.ptp(planning.reversal(1, Params().values()).window_rad) < pi / 2
    for seed in range(12):
        with connect("sim://", seed) as robot:
            log = Log(robot.info())
            robot.add_tap(log)
            drive(robot, log, "forward")
            robot.wait(seed / 20)
            kick = drive(robot, log, "spin-left")["kicks"][0]
            assert (kick["mode"], kick["ticks"], kick["wheel"], kick["reversed"]) == (
                PHASE,
                12,
                "left",
                True,
            )


def test_a_planned_kick_that_fails_is_repeated_and_at_last_the_membrane_is_inverted(monkeypatch):
    monkeypatch.setattr(
        "host.kicking.primitives.reversal", lambda before, params, say, motor: Plan(POSITION, 1)
    )
    kicks = reversals(1, 1, {"k": 8.0}, by_plan)[0]
    assert [kick["mode"] for kick in kicks][:3] == [POSITION] * 3
    assert {kick["mode"] for kick in kicks[3:]} == {MEMBRANE}
    assert kicks[-1]["reversed"]


def test_where_no_quenched_kick_is_sure_the_membrane_is_inverted_at_once(monkeypatch):
    monkeypatch.setattr("host.kicking.primitives.reversal", lambda before, params, say, motor: None)
    kicks = reversals(2, 1, {"k": 8.0}, by_plan)[0]
    assert {kick["mode"] for kick in kicks} == {MEMBRANE}


# kickctl plan.


def test_plan_tells_mode_length_and_moment_for_each_wheel_and_kicks_nothing(kickctl):
    status, out, err = kickctl("plan", "--to", "backward", "--seed", "1", "--json")
    result = json.loads(out)
    assert status == 0
    assert "computing which kicks reverse" in err
    assert (result["to"], result["params"]["k"]) == ("backward", 8.0)
    left, right = (result["wheels"][side] for side in WHEELS)
    assert (left["heading"], right["heading"]) == ("forward", "backward")
    assert right["kick"] is None
    assert left["kick"]["mode"] in {POSITION, PHASE}
    assert left["rate"] >= 0.99
    assert left["interval"][0] <= left["rate"] <= left["interval"][1]
    assert 0 <= left["phase_rad"] < 2 * pi
    assert left["turns_per_s"] == pytest.approx(2.0, abs=0.3)
    assert left["wait_ticks"] == 1
    again = json.loads(kickctl("plan", "--to", "forward", "--seed", "1", "--json")[1])
    assert again["wheels"]["left"]["kick"] is None
    assert again["wheels"]["right"]["kick"] is not None


def test_the_kick_that_plan_tells_reverses_the_wheel(kickctl):
    left = json.loads(kickctl("plan", "--to", "backward", "--seed", "1", "--json")[1])["wheels"][
        "left"
    ]
    with connect("sim://", 1) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        wait_settled(robot)
        assert kick_and_watch(robot, log, wheel="left", **left["kick"]).reversed


def test_plan_speaks_in_sentences(kickctl):
    status, out, _ = kickctl("plan", "--to", "backward", "--seed", "1")
    assert status == 0
    lines = out.splitlines()
    assert "left wheel is forward" in lines[0]
    assert "ticks, at any phase; reversed 100.0%" in lines[0]
    assert "as wanted: no kick" in lines[1]


def test_a_resting_wheel_is_set_going_and_a_window_is_told(kickctl, monkeypatch):
    with monkeypatch.context() as rested:
        rested.setattr("host.logs.motion.heading_of", lambda phi: "stopped")
        out = kickctl("plan", "--to", "forward", "--seed", "1")[1]
    assert "phase kick by -135° of 4 ticks, at any phase; pushes a resting wheel forward;" in out
    monkeypatch.setattr(
        "host.kicking.primitives.reversal",
        lambda before, params, say, motor: Plan(PHASE, 9, 3 * pi / 4, (0.5, 1.5), 100, 99),
    )
    out = kickctl("plan", "--to", "backward", "--seed", "1")[1]
    assert "at a phase from 29° to 86°" in out
    assert "ticks from now" in out
    assert "reversed 99.0% of 100 simulated wheels" in out


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("--to", "spin-left"), 2, "invalid choice"),
        ((), 2, "--to"),
        (("--to", "forward", "--brick", "sim://?idle=1"), 1, "kickctl start"),
        (("--to", "forward", "--brick", "tcp://127.0.0.1:1"), 3, "tcp://127.0.0.1:1"),
    ],
)
def test_what_cannot_be_planned_is_told_in_words(kickctl, arguments, status, words):
    code, out, err = kickctl("plan", *arguments)
    assert (code, out) == (status, "")
    assert words in err


# kickctl plan --search.


def test_a_search_ranks_pulses_beside_the_papers_kicks_with_margins_and_odds(kickctl, monkeypatch):
    monkeypatch.setattr("host.kicking.search.AMPLITUDES", (("beta", (1.0,)),))
    monkeypatch.setattr("host.kicking.search_margins.STEPS", (0.9,))
    monkeypatch.setattr("host.kicking.search_margins.MAY_BE_OFF", ("k", "battery_v"))
    monkeypatch.setattr("host.kicking.search_margins._WHEELS", 120)
    status, out, _ = kickctl("plan", "--to", "backward", "--search", "shortest", "--json")
    result = json.loads(out)
    assert (status, result["search"], result["period_rad"]) == (0, "shortest", pi / 2)
    (best,) = result["found"]
    assert best["kick"] == {"mode": "pulse", "param": "beta", "value": 1.0, "ticks": 3}
    assert (best["window_rad"], best["phase_may_be_off_rad"]) == ([0.0, pi / 2], pi / 4)
    membrane, position, phase = result["paper"]
    assert [row["kick"]["mode"] for row in result["paper"]] == [MEMBRANE, POSITION, PHASE]
    # The paper's inverted positions are this pulse, so all about them is the same.
    assert {**position, "kick": None} == {**best, "kick": None}
    assert position["at_any_phase"]["reversed"] >= 0.99 * position["at_any_phase"]["tried"]
    assert (membrane["effort_s"], phase["effort_s"]) == (None, pytest.approx(0.09))
    # With a tenth of the battery's voltage no wheel rolls, so nothing is reversed.
    assert best["may_be_off"]["battery_v"][0] == 0.0
    words = "\n".join(sentences(result, "backward", Params()))
    assert "pulse of beta to 1, 3 ticks (90 ms), effort 0.09 s" in words
    assert "still does with any phase, k -" in words
    assert "kickctl kick --mode pulse --param beta --value 1 --ticks 3\n" in words


def test_where_no_wheel_rolls_there_is_nothing_to_search(kickctl):
    status, out, err = kickctl(
        "plan", "--to", "backward", "--search", "least-effort", "--set", "k=0.1", "--seed", "1"
    )
    assert (status, out) == (1, "")
    assert "no simulated wheel rolls steadily" in err
