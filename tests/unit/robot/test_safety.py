"""The limiter, the states, and the lease: what stands between anybody and the motors."""

from math import inf, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.errors import Refused
from robot.safety import FAULT, HELD, IDLE, RUNNING, STOPPED, Lease, Safety, limit_duty

torques = st.floats(allow_nan=False)
bounds = st.floats(0.0, 100.0)


@given(st.floats(), bounds)
def test_a_duty_is_a_whole_number_within_both_bounds_whatever_the_torque(torque, most):
    duty = limit_duty(torque, most)
    assert type(duty) is int
    assert abs(duty) <= most <= 100


@given(torques, torques, bounds)
def test_more_torque_is_never_less_duty_and_opposite_torque_is_opposite_duty(one, other, most):
    low, high = sorted((one, other))
    assert limit_duty(low, most) <= limit_duty(high, most)
    assert limit_duty(-one, most) == -limit_duty(one, most)


@given(bounds)
def test_what_is_no_number_moves_nothing(most):
    assert limit_duty(nan, most) == 0
    assert limit_duty(0.0, most) == limit_duty(-0.0, most) == 0


@pytest.mark.parametrize(
    ("torque", "most", "duty"),
    [
        (0.5, 85.0, 42),
        (1.0, 85.0, 85),
        (-1.0, 85.0, -85),
        (inf, 85.0, 85),
        (-inf, 100.0, -100),
        (inf, 0.0, 0),
        (1.0, 84.6, 84),
        (2.0, 300.0, 100),
    ],
)
def test_some_duties(torque, most, duty):
    assert limit_duty(torque, most) == duty


@given(st.lists(st.sampled_from(("start", "stop", "fault", "clear"))))
def test_a_fault_latches_until_it_is_cleared_and_its_first_cause_is_told(steps):
    safety = Safety()
    cause = None
    for number, step in enumerate(steps):
        try:
            getattr(safety, step)(*([] if step in ("start", "clear") else [str(number)]))
        except Refused:
            assert step in ("start", "clear")
        else:
            if step == "fault":
                cause = cause or str(number)
            elif step == "clear":
                cause = None
        assert (safety.state == FAULT) == (cause is not None)
        assert cause is None or safety.reason == cause


def test_a_refused_step_changes_nothing():
    safety = Safety()
    for prepare, refused, code in (
        ((), "clear", "state"),
        (("start",), "start", "state"),
        (("start",), "clear", "state"),
        (("start", "hold"), "start", "state"),
        (("fault",), "start", "fault"),
    ):
        safety = Safety()
        for step in prepare:
            getattr(safety, step)(*([] if step == "start" else ["why"]))
        before = vars(safety).copy()
        with pytest.raises(Refused) as error:
            getattr(safety, refused)()
        assert error.value.code == code
        assert vars(safety) == before


def test_the_way_through_the_states():
    safety = Safety()
    states = [safety.state]
    for step in ("start", "hold", "resume", "stop", "start", "fault", "stop", "clear", "start"):
        getattr(safety, step)(*([] if step in ("start", "clear") else ["why"]))
        states.append(safety.state)
    assert states == [
        IDLE,
        RUNNING,
        HELD,
        RUNNING,
        STOPPED,
        RUNNING,
        FAULT,
        FAULT,
        STOPPED,
        RUNNING,
    ]


def test_only_one_holds_the_lease():
    lease = Lease()
    with pytest.raises(Refused):
        lease.require("a", 0.0)
    assert lease.take("a", "Ann", 0.0) is None
    assert lease.take("a", "Ann", 1.0) is None
    with pytest.raises(Refused) as refused:
        lease.take("b", "Bob", 1.0)
    assert "Ann" in refused.value.message
    with pytest.raises(Refused):
        lease.require("b", 1.0)
    lease.release("b")
    lease.require("a", 1.0)
    lease.release("a")
    assert lease.take("b", "Bob", 2.0) is None


def test_who_takes_over_has_the_lease_and_who_lost_it_can_take_it_back():
    lease = Lease()
    assert lease.take("a", "Ann", 0.0, over=True) is None
    assert lease.take("b", "Bob", 1.0, over=True) == "Ann"
    assert (lease.holder, lease.name) == ("b", "Bob")
    assert [lease.taken_over_by(holder) for holder in "abc"] == ["Bob", None, None]
    lease.require("b", 1.0)
    for attempt in (lambda: lease.take("a", "Ann", 63.0), lambda: lease.require("a", 63.0)):
        with pytest.raises(Refused, match=r"^'Bob' has taken over, 1 min 2 s ago$"):
            attempt()
    assert lease.take("a", "Ann", 64.0, over=True) == "Bob"
    assert [lease.taken_over_by(holder) for holder in "abc"] == [None, "Ann", None]


def test_who_lost_the_lease_hears_so_until_it_takes_it_again():
    lease = Lease()
    assert [lease.taken_over_by(holder) for holder in ("a", "")] == [None, None]
    lease.take("a", "Ann", 0.0)
    lease.take("b", "Bob", 1.0, over=True)
    lease.release("b")
    with pytest.raises(Refused, match=r"^'Bob' has taken over, and has finished$"):
        lease.require("a", 2.0)
    lease.take("c", "Cid", 3.0)
    assert lease.taken_over_by("a") == "Bob"
    lease.release("c")
    lease.take("a", "Ann", 4.0)
    assert [lease.taken_over_by(holder) for holder in ("a", "")] == [None, None]
    lease.require("a", 4.0)


def test_it_is_known_for_how_long_the_lease_has_been_held():
    lease = Lease()
    assert lease.held_s(7.0) is None
    lease.take("a", "Ann", 1.0)
    lease.take("a", "Ann", 3.0)
    lease.heard("a", 4.0)
    assert lease.held_s(5.0) == 4.0
    lease.take("b", "Bob", 6.0, over=True)
    assert lease.held_s(6.5) == 0.5
    lease.release("b")
    assert lease.held_s(7.0) is None


def test_a_lease_ends_once_after_silence_and_others_words_do_not_prolong_it():
    lease = Lease()
    lease.take("a", "Ann", 10.0)
    lease.heard("a", 10.4)
    lease.heard("b", 10.9)
    assert not lease.expire(10.9, 0.5)
    assert lease.expire(10.91, 0.5)
    assert not lease.expire(99.0, 0.5)
    lease.take("b", "Bob", 99.0)


def test_a_released_lease_does_not_expire():
    lease = Lease()
    lease.take("a", "Ann", 0.0)
    lease.release("a")
    assert not lease.expire(100.0, 0.5)


def refusal(attempt, *arguments):
    with pytest.raises(Refused) as refused:
        attempt(*arguments)
    return refused.value.as_dict()


def test_the_words_of_every_refusal():
    safety, lease = Safety(), Lease()
    nothing = {
        "code": "state",
        "message": "there is no fault to clear",
        "hint": "kickctl status shows its state",
    }
    assert refusal(safety.clear) == nothing
    safety.start()
    runs = {
        "code": "state",
        "message": "the robot runs already",
        "hint": "stop it first to start again",
    }
    assert refusal(safety.start) == runs
    safety.hold("away")
    assert refusal(safety.start) == runs
    safety.fault("its cable came off")
    fault = {
        "code": "fault",
        "message": "the robot is in fault: its cable came off",
        "hint": "mend the cause, then: kickctl clear, kickctl start",
    }
    assert refusal(safety.start) == fault
    assert refusal(lease.require, "a", 0.0) == {
        "code": "lease",
        "message": "you do not control the robot",
        "hint": "take the lease first",
    }
    lease.take("a", "Ann", 0.0)
    wait = (
        "wait until they have finished, or take over: --take-over, in Python robot.take_over()."
        " Anyone may stop the robot: kickctl stop"
    )
    other = {
        "code": "lease",
        "message": "the robot has been driven by 'Ann' for 2 min 10 s",
        "hint": wait,
    }
    assert refusal(lease.take, "b", "Bob", 130.0) == other
    assert refusal(lease.require, "b", 130.0) == other
    lease.take("b", "Bob", 200.0, over=True)
    taken = {"code": "lease", "message": "'Bob' has taken over, 5 s ago", "hint": wait}
    assert refusal(lease.require, "a", 205.9) == taken
    lease.release("b")
    finished = {
        "code": "lease",
        "message": "'Bob' has taken over, and has finished",
        "hint": "take the lease again",
    }
    assert refusal(lease.require, "a", 206.0) == finished


def test_the_reason_of_every_state():
    safety = Safety()
    reasons = [safety.reason]
    for step, *why in (
        ["start"],
        ["hold", "away"],
        ["resume", "back"],
        ["stop", "enough"],
        ["fault", "broken"],
        ["stop", "no"],
        ["clear"],
    ):
        getattr(safety, step)(*why)
        reasons.append(safety.reason)
    assert reasons == [
        "not started yet",
        "started",
        "away",
        "back",
        "enough",
        "broken",
        "broken",
        "fault cleared",
    ]


def test_the_lease_knows_its_holder_and_forgets_it():
    lease = Lease()
    assert lease.holder is None
    lease.take("a", "Ann", 0.0)
    assert (lease.holder, lease.name) == ("a", "Ann")
    assert not lease.expire(0.5, 0.5)
    assert lease.expire(0.75, 0.5)
    assert lease.holder is None
    lease.take("b", "Bob", 0.0)
    lease.release("b")
    assert lease.holder is None
