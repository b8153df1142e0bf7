"""The fixed tick: schedule, counts, kicks, parameters, and that it always stops its motors."""

from math import cos, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot import motors
from robot.controller import step_wheel
from robot.errors import Refused
from robot.loop import LATENESS_EDGES_S
from robot.record import STATES
from robot.safety import FAULT, IDLE, RUNNING, STOPPED
from tests.rig import PERIOD, Motor, Rig, kicked, running

# The schedule


def test_a_tick_two_periods_and_a_bit_late_is_counted_and_the_grid_stays():
    rig = Rig(lates=[0.0, 0.0, 2.4 * PERIOD])
    rig.run(6)
    assert [record.missed for record in rig.records] == [0, 0, 2, 0, 0, 0]
    assert [record.tick for record in rig.records] == list(range(6))
    assert rig.records[2].late_s == pytest.approx(0.4 * PERIOD, rel=1e-6)
    # The tick after it is on the grid again, not a period after the late one.
    assert [record.t_s / PERIOD for record in rig.records] == pytest.approx([0, 1, 4.4, 5, 6, 7])
    assert rig.loop.missed == 2


@given(st.lists(st.floats(0.0, 5 * PERIOD), max_size=40))
def test_lateness_never_moves_the_grid_and_every_deadline_is_met_or_counted(lates):
    rig = Rig(lates=lates)
    rig.run(len(lates) + 1)
    records = rig.records
    met = -1
    assert len(records) == len(lates) + 1
    for number, record in enumerate(records):
        met += 1 + record.missed
        assert record.t_s == pytest.approx(met * PERIOD + record.late_s, abs=1e-6)
        assert record.late_s < PERIOD + 1e-6
        late = [*lates, 0.0][number]
        assert late == pytest.approx(record.late_s + record.missed * PERIOD, abs=1e-6)
    assert rig.loop.missed == sum(record.missed for record in records)
    assert sum(rig.loop.lateness) == len(records)
    assert rig.loop.deadline == pytest.approx((met + 1) * PERIOD)


def test_the_histogram_sorts_by_its_edges():
    rig = Rig(lates=[0.0, 0.00005, 0.0015, 0.0021, 0.029])
    rig.run(5)
    edges = (*LATENESS_EDGES_S, "more")
    assert len(rig.loop.lateness) == len(edges)
    assert {edges[index]: count for index, count in enumerate(rig.loop.lateness) if count} == {
        0.0001: 2,
        0.002: 1,
        0.005: 1,
        0.05: 1,
    }


def test_an_hour_of_late_ticks_does_not_drift():
    rig = Rig(lates=[0.001 * (number % 13) for number in range(120000)], capacity=1)
    rig.run(120000)
    assert rig.loop.deadline == pytest.approx(3600.0, abs=1e-6)
    assert rig.loop.missed == 0


def test_delta_t_is_measured_and_clamped_and_the_clamp_is_counted():
    rig = Rig(lates=[0.0, 0.01, 0.0, 3.5 * PERIOD, 0.0291])
    rig.run(6)
    assert [record.dt_s / PERIOD for record in rig.records] == pytest.approx(
        [1, 4 / 3, 2 / 3, 3, 1.47, 0.1], abs=1e-2
    )
    assert rig.loop.clamped == 2


def test_a_tick_that_takes_longer_than_the_next_deadline_is_an_overrun():
    rig = running()
    slow = rig.motors[0].write_duty

    def write(duty):
        slow(duty)
        rig.clock.time += 1.2 * PERIOD

    rig.motors[0].write_duty = write
    rig.run(1)
    rig.motors[0].write_duty = slow
    rig.run(3)
    assert rig.loop.overruns == 1
    assert [record.missed for record in rig.records] == [0, 0, 0, 0]
    assert [record.t_s / PERIOD for record in rig.records] == pytest.approx([0, 1.2, 2, 3])


def test_a_new_period_holds_from_the_next_deadline_on():
    rig = Rig()
    rig.run(2)
    rig.loop.set_params({"tick_s": 0.05})
    rig.run(3)
    assert [record.t_s for record in rig.records] == pytest.approx([0.0, 0.03, 0.06, 0.11, 0.16])


def test_links_are_served_before_every_tick():
    rig = Rig()
    rig.run(3)
    assert rig.served == [0.0] * 3


# What a tick does


def test_a_tick_reads_steps_limits_writes_and_records_in_this_order():
    rig = running(left=Motor(angle=0.4), right=Motor(angle=1.9))
    (x1, x2), (right_1, right_2) = rig.events[0]["x"]
    rig.run(1)
    record = rig.last
    left = step_wheel(x1, x2, *3 * (cos(0.4), sin(0.4)), PERIOD, 4.0, 0.25, 8.0, 2)
    right = step_wheel(right_1, right_2, *3 * (cos(1.9), sin(1.9)), PERIOD, 4.0, 0.25, 8.0, 2)
    assert (record.left_x1, record.left_x2, record.left_force, record.left_torque) == left
    assert (record.right_x1, record.right_x2, record.right_force, record.right_torque) == right
    assert (
        rig.duties
        == (record.left_duty_pct, record.right_duty_pct)
        == (round(85 * left[3]), round(85 * right[3]))
    )
    assert rig.motors[0].done == ["read", "write"]


def test_a_mirrored_motor_makes_the_same_wheel():
    """Polarity -1: the motor turns and is driven the other way, and nothing else differs."""
    plain, mirrored = Rig(right=Motor(0.3, 0.2)), Rig(right=Motor(-0.3, -0.2))
    mirrored.loop.set_params({"polarity_right": -1})
    for rig in (plain, mirrored):
        rig.loop.start()
        rig.run(20)
    assert plain.records == mirrored.records
    assert plain.duties[0] == mirrored.duties[0]
    assert plain.duties[1] == -mirrored.duties[1] != 0


def test_start_potentials_come_from_the_seed_and_lie_on_the_circle():
    starts = [running(seed=seed).events[0]["x"] for seed in (1, 1, 2)]
    assert starts[0] == starts[1] != starts[2]
    assert all(x1**2 + x2**2 == pytest.approx(1.0) for start in starts for x1, x2 in start)


def test_an_idle_robot_records_and_moves_nothing():
    rig = Rig(left=Motor(turn=0.1))
    rig.run(3)
    assert [record.state for record in rig.records] == [IDLE] * 3
    assert [record.left_phi_rad for record in rig.records] == pytest.approx([0.0, 0.1, 0.2])
    assert "write" not in rig.motors[0].done + rig.motors[1].done


# Stops and faults


@pytest.mark.parametrize("error", [RuntimeError, KeyboardInterrupt, OSError])
def test_motors_stop_however_the_loop_ends(error):
    rig = running()
    rig.run(2)
    rig.motors[0].duty = rig.motors[1].duty = 50

    def broken(timeout_s):
        raise error

    with pytest.raises(error):
        rig.loop.run(broken)
    assert rig.duties == (0, 0)
    rig = running()
    rig.loop.run(lambda timeout_s: setattr(rig.loop, "done", True))
    assert rig.duties == (0, 0)
    assert rig.motors[0].done[-1] == rig.motors[1].done[-1] == "stop"


def test_a_stop_is_obeyed_at_once():
    rig = running(left=Motor(turn=0.3))
    rig.run(5)
    assert rig.duties != (0, 0)
    tick = rig.loop.stop("enough")
    assert rig.duties == (0, 0)
    rig.run(3)
    assert [record.state for record in rig.records_from(tick - 1)] == [RUNNING] + [STOPPED] * 3
    assert rig.duties == (0, 0)
    assert rig.last.left_force == rig.last.left_torque == rig.last.left_duty_pct == 0
    assert rig.loop.safety.reason == "enough"


def test_stopping_a_stopped_robot_again_is_answered_and_leaves_no_trace():
    """Or anybody could push everything else out of the journal by sending stop frames."""
    rig = running()
    rig.run(2)
    rig.loop.stop("first")
    before = len(rig.events)
    assert [rig.loop.stop("again") for _ in range(10)] == [2] * 10
    rig.run(1)
    assert rig.loop.stop("again") == 3
    assert len(rig.events) == before
    assert rig.loop.safety.reason == "first"
    assert rig.motors[0].done.count("stop") == 12


@pytest.mark.parametrize("what", ["read", "write"])
@pytest.mark.parametrize("side", [0, 1])
def test_a_motor_fault_stops_both_motors_and_latches(what, side):
    rig = running(left=Motor(turn=0.3), right=Motor(turn=0.3))
    rig.run(4)
    rig.motors[side].fails = {what}
    rig.run(1)
    assert rig.duties == (0, 0)
    assert rig.last.state == FAULT
    assert (rig.last.left_duty_pct, rig.last.right_duty_pct) == (0, 0)
    assert rig.last.left_force == rig.last.right_torque == 0.0
    assert rig.loop.safety.reason == "cannot " + what
    assert [
        (event["reason"], event["tick"]) for event in rig.events if event["event"] == "fault"
    ] == [("cannot " + what, 4)]
    rig.motors[side].fails = set()
    rig.run(2)
    assert rig.last.state == FAULT
    for refused in (rig.loop.start, lambda: kicked(rig)):
        with pytest.raises(Refused):
            refused()
    rig.loop.clear()
    rig.run(1)
    assert rig.last.state == STOPPED
    rig.loop.start()
    rig.run(1)
    assert rig.last.state == RUNNING


def test_a_fault_that_lasts_is_told_once():
    """Or an unplugged motor would push everything else out of the journal within a minute."""
    rig = running()
    rig.run(2)
    rig.motors[1].fails = {"read", "stop"}
    rig.run(50)
    assert [event["event"] for event in rig.events] == ["start", "fault"]
    assert rig.loop.safety.reason == "cannot read"
    assert {record.state for record in rig.records_from(2)} == {FAULT}


@pytest.mark.parametrize("side", [0, 1])
def test_a_motor_that_does_not_stop_is_told_again_and_the_other_one_stops(side):
    rig = running(left=Motor(turn=0.3), right=Motor(turn=0.3))
    rig.run(4)
    rig.motors[side].fails = {"stop"}
    rig.loop.stop("enough")
    assert rig.motors[1 - side].duty == 0
    assert rig.loop.safety.state == FAULT
    assert rig.loop.safety.reason == "cannot stop"
    rig.run(2)
    rig.motors[side].fails = set()
    rig.run(1)
    assert rig.duties == (0, 0)


def test_an_unplugged_motor_of_an_idle_robot_is_a_fault():
    rig = Rig()
    rig.motors[0].fails = {"read"}
    rig.run(1)
    assert STATES[rig.last.state] == "fault"


def test_a_battery_is_read_now_and_then():
    class Battery(motors.Battery):
        reads = 0

        def voltage_v(self):
            self.reads += 1
            return 7.0 + self.reads

    battery = Battery()
    rig = Rig(battery=battery)
    assert rig.loop.battery_v == 8.0
    rig.run(301)
    assert battery.reads == 3
    assert rig.loop.battery_v == 10.0
