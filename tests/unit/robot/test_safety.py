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
        lease.require("a")
    lease.take("a", "Ann", 0.0)
    lease.take("a", "Ann", 1.0)
    with pytest.raises(Refused) as refused:
        lease.take("b", "Bob", 1.0)
    assert "Ann" in refused.value.message
    with pytest.raises(Refused):
        lease.require("b")
    lease.release("b")
    lease.require("a")
    lease.release("a")
    lease.take("b", "Bob", 2.0)


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
    nothing = {"code": "state", "message": "there is no fault to clear", "hint": ""}
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
    assert refusal(lease.require, "a") == {
        "code": "lease",
        "message": "you do not control the robot",
        "hint": "take the lease first",
    }
    lease.take("a", "Ann", 0.0)
    other = {
        "code": "lease",
        "message": "somebody else controls the robot now: 'Ann'",
        "hint": "wait until they have finished. Anyone may stop the robot: kickctl stop",
    }
    assert refusal(lease.take, "b", "Bob", 0.0) == other


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
