"""How kicks, parameters and the lease enter the fixed tick."""

from math import pi

import pytest

from robot.errors import Refused
from robot.loop import KICKS_REMEMBERED
from robot.safety import FAULT, HELD, IDLE, RUNNING, STOPPED
from tests.rig import PERIOD, Motor, Rig, kicked, running

# Kicks


def test_the_applied_tick_is_the_one_in_whose_record_the_kick_shows():
    rig = running()
    rig.run(7)
    for mode, details, ticks in (
        ("membrane", {}, 1),
        ("position", {"ticks": 1}, 1),
        ("phase", {}, 4),
        ("pulse", {"param": "k", "value": 0.0, "ticks": 3}, 3),
        ("jump", {"variable": "x1", "delta": 1.0}, 1),
    ):
        tick = kicked(rig, mode, **details)
        assert tick == rig.loop.blackbox.next_tick
        rig.run(ticks + 3)
        assert [record.tick for record in rig.records_from(tick - 1) if record.kick] == list(
            range(tick, tick + ticks)
        )
        assert rig.events[-1]["tick"] == tick
        assert rig.events[-1]["kick"]["begin"] == tick


def test_a_kick_changes_its_tick_and_none_before():
    one, other = running(left=Motor(turn=0.2)), running(left=Motor(turn=0.2))
    for rig in (one, other):
        rig.run(6)
    kicked(one, "membrane", wheel="left")
    for rig in (one, other):
        rig.run(2)
    assert one.records[5].left_x1 == other.records[5].left_x1
    assert one.records[6].left_x1 != other.records[6].left_x1
    assert [record.right_x1 for record in one.records] == [
        record.right_x1 for record in other.records
    ]


def test_a_repeated_id_is_answered_and_not_repeated():
    rig = running()
    rig.run(3)
    request = {"id": "again", "mode": "membrane"}
    assert rig.loop.kick(request) == 3
    rig.run(5)
    before = rig.fingerprint()
    assert rig.loop.kick(request) == 3
    assert rig.loop.kick({"id": "again", "mode": "phase"}) == 3
    assert rig.fingerprint() == before
    rig.loop.stop("enough")
    assert rig.loop.kick(request) == 3


def test_so_many_kicks_are_remembered_and_no_more():
    rig = running()
    for number in range(KICKS_REMEMBERED + 1):
        rig.loop.kick({"id": "n" + str(number), "mode": "membrane"})
        rig.run(1)
    assert rig.loop.kick({"id": "n1", "mode": "membrane"}) == 1
    assert len(rig.loop._kick_begins) == len(rig.loop._kick_ids) == KICKS_REMEMBERED
    assert rig.loop.kick({"id": "n0", "mode": "membrane"}) == KICKS_REMEMBERED + 1


def test_one_kick_at_a_time():
    rig = running()
    rig.run(1)
    kicked(rig, ticks=3)
    for _ in range(3):
        before = rig.fingerprint()
        with pytest.raises(Refused) as refused:
            kicked(rig)
        assert refused.value.code == "busy"
        assert rig.fingerprint() == before
        rig.run(1)
    assert kicked(rig) == 4


@pytest.mark.parametrize("state", [IDLE, STOPPED, HELD, FAULT])
def test_a_robot_that_does_not_run_cannot_be_kicked(state):
    rig = Rig()
    rig.run(1)
    rig.loop.safety.state = state
    before = rig.fingerprint()
    with pytest.raises(Refused) as refused:
        kicked(rig)
    assert refused.value.code == "state"
    assert rig.fingerprint() == before


def test_a_stop_ends_a_kick_for_good():
    rig = running()
    kicked(rig, ticks=10)
    rig.run(2)
    rig.loop.stop("enough")
    rig.loop.start()
    rig.run(3)
    assert [bool(record.kick) for record in rig.records] == [True, True, False, False, False]
    kicked(rig)


@pytest.mark.parametrize(("turn", "sign"), [(0.3, 1), (-0.3, -1)])
def test_the_sign_of_a_phase_kick_is_the_wheels_direction_even_in_the_first_ticks(turn, sign):
    """The wheels' angles may begin anywhere; where they begin is no travel."""
    for ticks in (2, 5, 30):
        rig = running(left=Motor(5.0, turn), right=Motor(-5.0, -turn))
        rig.run(ticks)
        kicked(rig, "phase")
        assert rig.events[-1]["kick"]["values"] == pytest.approx(
            [sign * 3 * pi / 4, -sign * 3 * pi / 4]
        )


def test_a_wheel_that_was_turned_around_has_no_direction_from_before():
    rig = Rig(left=Motor(5.0, 0.3), right=Motor(-50.0, 0.3))
    rig.run(20)
    rig.loop.set_params({"polarity_right": -1})
    rig.loop.start()
    rig.run(2)
    kicked(rig, "phase")
    assert rig.events[-1]["kick"]["values"] == pytest.approx([3 * pi / 4, -3 * pi / 4])


# Parameters


def test_parameters_change_all_or_none_and_from_the_next_tick_on():
    rig = running()
    rig.run(2)
    before = rig.fingerprint()
    for wrong in (
        {"k": 1.0, "a": -1.0},
        {"k": 1.0, "speed": 2.0},
        {"k": 1.0, "polarity_left": -1},
        {},
        None,
    ):
        with pytest.raises(Refused):
            rig.loop.set_params(wrong)
        assert rig.fingerprint() == before
    assert rig.loop.set_params({"k": 0.0, "a": 5.0}) == 2
    rig.run(1)
    assert [record.left_force == 0.0 for record in rig.records] == [False, False, True]
    assert rig.events[-1] == {
        "event": "params",
        "tick": 2,
        "number": 1,
        "set": {"k": 0.0, "a": 5.0},
    }


def test_a_held_robot_still_runs_as_far_as_polarity_goes():
    rig = running()
    rig.loop.safety.hold("so")
    with pytest.raises(Refused):
        rig.loop.set_params({"polarity_left": -1})


def test_the_period_of_a_kick_cannot_change_under_it():
    rig = running()
    kicked(rig, "pulse", param="tau_s", value=0.09, ticks=5)
    with pytest.raises(Refused) as refused:
        rig.loop.set_params({"tick_s": 0.05})
    assert refused.value.code == "busy"
    rig.run(5)
    rig.loop.set_params({"tick_s": 0.05})


# The lease


@pytest.mark.parametrize(
    ("policy", "state"), [("stop", STOPPED), ("hold", HELD), ("continue", RUNNING)]
)
def test_what_happens_when_the_controller_falls_silent(policy, state):
    rig = running()
    rig.loop.set_params({"link_loss": policy})
    rig.loop.take_lease("a", "Ann")
    rig.run(17)
    assert rig.last.state == RUNNING
    rig.run(1)
    assert rig.last.state == state
    assert (rig.duties == (0, 0)) == (state != RUNNING)
    assert [event["event"] for event in rig.events][-2:] == {
        "stop": ["link_loss", "stop"],
        "hold": ["link_loss", "hold"],
        "continue": ["params", "link_loss"],
    }[policy]
    assert "Ann" in rig.events[-1]["reason"]
    rig.loop.take_lease("b", "Bob")
    rig.run(1)
    assert rig.last.state == (STOPPED if policy == "stop" else RUNNING)


def test_a_held_robot_brakes_pauses_its_neurons_and_goes_on_from_them():
    rig = running(left=Motor(turn=0.2))
    rig.loop.set_params({"link_loss": "hold"})
    rig.loop.take_lease("a", "Ann")
    rig.run(30)
    held = [record for record in rig.records if record.state == HELD]
    assert len({record.left_x1 for record in held}) == 1
    assert {record.left_duty_pct for record in held} == {0}
    rig.loop.take_lease("a", "Ann")
    rig.run(1)
    assert rig.last.left_x1 == pytest.approx(held[-1].left_x1, abs=2 * PERIOD / 0.25)
    assert rig.last.left_duty_pct != 0
