"""A replay reproduces what a real loop did, bit for bit, and finds every change of a log."""

from struct import pack, unpack

import pytest

from host.logs.log import Log
from host.logs.mcap_files import LogError
from host.logs.replay import replay
from robot.loop import BATTERY_TICKS
from robot.motors import Battery
from robot.power import Power
from robot.record import Record
from tests.fakes import Rig, eventful


@pytest.fixture(scope="module")
def rig():
    return eventful()


def changed(log, alter_record=lambda record: record, keep_event=lambda event: True):
    """A copy of a log, with records altered and events left out."""
    copy = Log(log.info)
    for item in log.stream():
        if isinstance(item, Record):
            copy.take_records([alter_record(item)])
        elif keep_event(item):
            copy.take_event(item)
    return copy


def next_float(value):
    """The float that differs in the last bit."""
    return unpack("<d", pack("<q", unpack("<q", pack("<d", value))[0] ^ 1))[0]


def test_an_eventful_log_replays_bit_for_bit(rig):
    log = rig.log()
    assert {event["event"] for event in log.events} == {
        *(
            "snapshot",
            "start",
            "params",
            "kick",
            "stop",
            "link_loss",
            "hold",
            "resume",
            "fault",
            "clear",
        )
    }
    assert {record.kick for record in log.records} == {0, 1, 2, 3, 4, 5, 6}
    result = replay(log)
    assert (result.first, result.worst) == (None, 0.0)
    assert result.exact
    assert result.reproduced
    faults = {event["tick"] for event in log.events if event["event"] == "fault"}
    assert result.not_comparable == 1 + len(faults)
    assert result.compared + result.not_comparable == len(log)


def test_a_client_that_joins_at_any_tick_gets_a_log_that_replays(rig):
    for tick in range(1, rig.loop.blackbox.next_tick, 7):
        log = rig.log(tick)
        result = replay(log)
        assert result.first is None
        faults = {event["tick"] for event in log.events if event["event"] == "fault"}
        assert result.compared >= len(log) - 1 - len(faults)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("channel", ["x1", "x2", "force", "torque"])
def test_one_changed_bit_is_found(rig, side, channel):
    name = f"{side}_{channel}"

    def alter(record):
        return (
            record._replace(**{name: next_float(getattr(record, name))})
            if record.tick == 77
            else record
        )

    result = replay(changed(rig.log(), alter))
    assert not result.exact
    assert not result.reproduced
    assert (result.first.tick, result.first.channel) == (77, name)
    assert 0 < result.worst < 1e-14
    assert "of tick 77" in str(result.first)


@pytest.mark.parametrize("machine", [None, "armv5tejl CPython 3.5.3"])
def test_one_percent_of_duty_is_found_on_any_machine(rig, machine):
    log = changed(
        rig.log(),
        lambda record: (
            record._replace(right_duty_pct=record.right_duty_pct - 1)
            if record.tick == 77
            else record
        ),
    )
    if machine:
        log.info["robot_machine"] = machine
    result = replay(log)
    assert not result.reproduced
    assert (result.first.tick, result.first.channel, result.worst) == (77, "right_duty_pct", 1.0)


def test_the_sign_of_a_zero_is_a_bit_too():
    rig = Rig()
    rig.run(3)
    log = changed(
        rig.log(), lambda record: record._replace(left_force=-0.0) if record.tick == 2 else record
    )
    assert replay(rig.log()).exact
    assert replay(log).first.channel == "left_force"


@pytest.mark.parametrize(
    ("kind", "number"), [("start", 0), ("kick", 0), ("kick", 20), ("params", 1), ("params", 4)]
)
def test_a_course_that_the_events_do_not_explain_is_found(rig, kind, number):
    log = rig.log()
    victim = [event for event in log.events if event["event"] == kind][number]
    result = replay(changed(log, keep_event=lambda event: event is not victim))
    assert not result.reproduced
    assert result.first.tick == victim["tick"]


def test_angles_and_steps_of_time_are_what_drives_the_replay(rig):
    for name in ("left_phi_rad", "dt_s"):

        def alter(record, name=name):
            return (
                record._replace(**{name: getattr(record, name) * 1.01})
                if record.tick == 50
                else record
            )

        assert replay(changed(rig.log(), alter)).first.tick == 50


def test_another_machine_may_differ_in_the_last_bits_but_no_further(rig):
    def log(difference):
        log = changed(
            rig.log(),
            lambda record: record._replace(
                left_force=record.left_force + difference * (record.tick == 60)
            ),
        )
        log.info["robot_machine"] = "armv5tejl CPython 3.5.3"
        return log

    close = replay(log(5e-13))
    assert close.reproduced
    assert not close.exact
    assert 0 < close.worst < 1e-12
    far = replay(log(2e-12))
    assert not far.reproduced
    assert far.beyond.tick == 60


def test_a_gap_costs_the_comparison_of_one_tick():
    rig = Rig()
    rig.loop.start()
    rig.run(50)
    log = rig.log()
    rig.kick("phase", ticks=40)
    rig.run(20)
    rig.loop.set_params({"k": 5.0})
    rig.run(5)
    log.take_event({"event": "lost", "tick": 70, "from": 50})
    rig.feed(log, 70)
    assert log.missing() == [(50, 70)]
    result = replay(log)
    assert result.exact
    assert (result.compared, result.not_comparable) == (54, 1)


def test_a_link_that_broke_without_loss_costs_nothing():
    rig = Rig()
    rig.loop.start()
    rig.run(20)
    log = rig.log()
    rig.kick("position", ticks=3)
    rig.run(20)
    rig.feed(log, 20)
    assert [event["event"] for event in log.events] == ["snapshot", "start", "snapshot", "kick"]
    result = replay(log)
    assert result.exact
    assert (result.compared, result.not_comparable) == (40, 0)


def test_a_robot_that_restarted_restarts_in_the_replay():
    log = Log()
    for seed, joined, ticks in ((1, 0, 60), (2, 60, 90)):  # by chance, the numbers go on
        rig = Rig(seed)
        rig.loop.start()
        rig.run(ticks)
        rig.feed(log, joined)
        log.take_event({"event": "restart", "tick": 0, "boot": "another"})
    result = replay(log)
    assert result.exact
    assert (result.compared, result.not_comparable) == (60 + 29, 1)


def test_what_the_robot_made_up_for_the_voltage_stands_in_the_log():
    class Sagging(Battery):
        volts = 8.5

        def voltage_v(self):
            self.volts -= 0.2
            return self.volts

    rig = Rig()
    rig.loop._power = Power(Sagging())
    rig.loop.set_params({"battery_compensation": "on"})
    rig.loop.start()
    rig.run(3 * BATTERY_TICKS)
    log = rig.log()
    scales = [
        event["set"]["duty_scale"] for event in log.events if "duty_scale" in event.get("set", {})
    ]
    assert len(set(scales)) == 3
    result = replay(log)
    assert result.exact
    assert result.compared > 2 * BATTERY_TICKS


def test_nothing_is_not_reproduced():
    assert not replay(Log()).reproduced
    rig = Rig()
    rig.run(1)
    assert not replay(rig.log()).reproduced


def test_numbers_too_large_to_compute_with_are_said(rig):
    log = changed(rig.log(), lambda record: record._replace(dt_s=1e300))
    with pytest.raises(LogError, match="has numbers too large"):
        replay(log)
