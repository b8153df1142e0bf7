"""The battery in the loop: a warning, the end, and duties that make up for a low voltage."""

import math

import pytest

from robot.loop import BATTERY_TICKS
from robot.motors import Battery
from robot.power import NOMINAL_V, Power
from robot.record import STATES
from robot.wheel import Wheel
from tests.rig import Rig


class Cells(Battery):
    warn_v, stop_v = 6.5, 6.2

    def __init__(self, volts=NOMINAL_V):
        self.volts = volts

    def voltage_v(self):
        return self.volts


def test_one_low_reading_is_no_low_battery():
    cells = Cells()
    power = Power(cells)
    cells.volts = 5.6
    power.read()
    assert power.latest_v == 5.6
    assert not power.warning()
    assert not power.exhaustion()
    power.read()
    assert power.exhaustion()


@pytest.mark.parametrize("wrong", [math.nan, math.inf, "7.2", True, 10**400])
def test_a_reading_that_is_no_number_counts_as_none(wrong):
    cells = Cells(7.0)
    rig = Rig(battery=cells)
    rig.loop.start()
    cells.volts = wrong
    rig.run(BATTERY_TICKS + 1)
    assert rig.loop.battery_v is None
    assert STATES[rig.last.state] == "running"
    cells.volts = 7.0
    rig.run(BATTERY_TICKS)
    assert rig.loop.battery_v == 7.0
    cells.volts = 5.9
    rig.run(3 * BATTERY_TICKS)
    assert STATES[rig.last.state] == "stopped"


def test_a_low_battery_is_told_once_until_it_has_been_charged():
    cells = Cells(6.4)
    power = Power(cells)
    assert [power.warning() for _ in range(3)] == ["the battery is low (6.4 V): charge it", "", ""]
    cells.volts = 6.6
    for _ in range(9):
        power.read()
    assert not power.warning()
    cells.volts = 6.4
    for _ in range(9):
        power.read()
    assert not power.warning()
    cells.volts = 8.0
    for _ in range(9):
        power.read()
    assert not power.warning()
    cells.volts = 6.4
    for _ in range(9):
        power.read()
    assert power.warning()


@pytest.mark.parametrize(
    ("volts", "scale"), [(7.5, 1.0), (6.25, 1.2), (8.2, 0.91), (1.0, 2.0), (0.0, 2.0), (90.0, 0.5)]
)
def test_the_scale_makes_up_for_the_voltage_within_bounds(volts, scale):
    assert Power(Cells(volts)).duty_scale() == scale


@pytest.mark.parametrize("battery", [None, Cells(None)])
def test_what_is_unknown_is_neither_low_nor_made_up_for(battery):
    power = Power(battery)
    assert (power.latest_v, power.exhaustion(), power.warning(), power.duty_scale()) == (
        None,
        "",
        "",
        1.0,
    )


def test_a_reading_that_fails_leaves_what_was_known():
    cells = Cells(6.0)
    power = Power(cells)
    cells.volts = None
    power.read()
    assert power.latest_v is None
    assert power.exhaustion()


def events(rig, name):
    return [event for event in rig.events if event["event"] == name]


def test_the_robot_warns_of_a_low_battery_and_stops_at_an_empty_one():
    cells = Cells(6.4)
    rig = Rig(battery=cells)
    rig.loop.start()
    rig.run(BATTERY_TICKS)
    assert STATES[rig.last.state] == "running"
    assert [event["reason"] for event in events(rig, "battery")] == [
        "the battery is low (6.4 V): charge it"
    ]
    cells.volts = 5.9
    rig.run(2 * BATTERY_TICKS)
    assert STATES[rig.last.state] == "stopped"
    assert "the battery is empty" in rig.loop.safety.reason
    assert rig.duties == (0, 0)
    assert len(events(rig, "battery")) == 1
    rig.run(2 * BATTERY_TICKS)
    assert len(events(rig, "stop")) == 1


def test_an_empty_battery_changes_nothing_for_a_robot_that_does_not_run():
    rig = Rig(battery=Cells(5.9))
    rig.run(2)
    assert STATES[rig.last.state] == "idle"


def test_a_battery_of_unknown_limits_never_stops_the_robot():
    class Simulated(Battery):
        def voltage_v(self):
            return 2.0

    rig = Rig(battery=Simulated())
    rig.loop.start()
    rig.run(2 * BATTERY_TICKS)
    assert STATES[rig.last.state] == "running"
    assert events(rig, "battery") == []


def test_duties_make_up_for_the_voltage_only_if_wanted_and_within_the_limit(monkeypatch):
    def duties(compensation, torque):
        monkeypatch.setattr(Wheel, "step", lambda *_: torque)
        rig = Rig(battery=Cells(6.25))
        rig.loop.set_params({"battery_compensation": compensation, "max_duty_pct": 50})
        rig.loop.start()
        rig.run(2)
        return rig.duties[0]

    assert duties("off", 0.5) == 25
    assert duties("on", 0.5) == 30
    assert duties("on", 1.0) == 50
    assert duties("on", -1.0) == -50
