"""python-ev3dev2, as it is, on the live tree.

Every answer that it has for the brick's kernel, it has for this one.
"""

import gc
import time

import ev3dev2
import pytest
from ev3dev2.motor import LargeMotor, MediumMotor
from ev3dev2.power import PowerSupply

from tests.sysfs.mount import inject, mounted, needs_mount

pytestmark = [
    needs_mount,
    pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning"),
    pytest.mark.usefixtures("collected"),
]


@pytest.fixture
def collected():
    """The library leaves its files to the garbage collector.

    Have it find them before another test begins.
    """
    yield
    gc.collect()


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    with mounted(tmp_path_factory.mktemp("live") / "sys", "--seed", "2") as folder:
        yield folder


@pytest.fixture
def motor(live, monkeypatch):
    monkeypatch.setattr(ev3dev2.Device, "DEVICE_ROOT_PATH", str(live))
    large = LargeMotor("outC")
    large.reset()
    return large


def wait_until(condition, seconds=20.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_it_finds_motors_by_port_and_kind(motor):
    assert (motor.address, motor.driver_name, motor.count_per_rot, motor.max_speed) == (
        "ev3-ports:outC",
        "lego-ev3-l-motor",
        360,
        1050,
    )
    assert "run-direct" in motor.commands
    for kind, port in ((MediumMotor, "outC"), (LargeMotor, "outA")):
        with pytest.raises(ev3dev2.DeviceNotFound, match="is not connected"):
            kind(port)


def test_run_direct_and_stop(motor):
    motor.duty_cycle_sp = 50
    motor.run_direct()
    wait_until(lambda: motor.position > 180)
    assert motor.is_running
    assert motor.duty_cycle == 50
    assert motor.speed > 0
    motor.stop(stop_action="brake")
    assert motor.state == []
    wait_until(lambda: motor.speed == 0)
    position = motor.position
    assert motor.duty_cycle_sp == 50
    motor.polarity = "inversed"
    assert motor.position == -position


def test_a_duty_out_of_range_is_a_value_error(motor):
    motor.duty_cycle_sp = 40
    for wrong in (101, -101):
        with pytest.raises(ValueError, match="out of range"):
            motor.duty_cycle_sp = wrong
    assert motor.duty_cycle_sp == 40


def test_values_of_fewer_digits_leave_nothing_behind(motor):
    for value in (100, -7, 5):
        motor.duty_cycle_sp = value
        assert motor.duty_cycle_sp == value


def test_a_motor_that_is_gone_is_not_found(live, motor):
    inject(live, "eio outC")
    with pytest.raises(OSError, match="Input/output error"):
        _ = motor.position
    assert motor.position == 0
    inject(live, "unplug outC")

    def gone():
        try:
            return motor.position != 0
        except ev3dev2.DeviceNotFound:
            return True

    wait_until(gone)
    with pytest.raises(ev3dev2.DeviceNotFound, match="no longer connected"):
        motor.duty_cycle_sp = 0
    inject(live, "replug outC")

    def back():
        try:
            LargeMotor("outC").reset()
        except (ev3dev2.DeviceNotFound, OSError):
            return False
        return True

    wait_until(back)


def test_the_battery(live, monkeypatch):
    monkeypatch.setattr(ev3dev2.Device, "DEVICE_ROOT_PATH", str(live))
    assert PowerSupply().measured_volts == pytest.approx(7.5)
