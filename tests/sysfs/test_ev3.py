"""The brick's motors and battery (robot.ev3) on the live tree."""

import gc
import os
import time
from math import pi

import pytest

from robot.ev3 import Ev3Battery, Ev3Motor
from robot.motors import MotorFault
from tests.live import wait_until
from tests.sysfs.mount import inject, motor_folder, mounted, needs_mount

# The library leaves the files that it opened to the garbage collector.
pytestmark = [
    pytest.mark.filterwarnings("ignore:unclosed file:ResourceWarning"),
    pytest.mark.usefixtures("collected"),
]


@pytest.fixture
def collected():
    """Have the collector find them before another test begins."""
    yield
    gc.collect()


@pytest.fixture(scope="module")
def live(tmp_path_factory):
    with mounted(tmp_path_factory.mktemp("live") / "sys", "--seed", "1") as folder:
        yield folder


@pytest.fixture
def motor(live):
    """The left motor, found; in the end it is there, whatever was done to it."""
    found = Ev3Motor("left", "outB", str(live))
    found.find()
    yield found
    found.stop()
    found._close()


def eventually(condition, seconds=20.0):
    """Whether the condition holds some time; the wait is bounded only so that a failure ends."""
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if condition():
            return True
        time.sleep(0.01)
    return False


def is_found(motor):
    try:
        motor.find()
    except MotorFault:
        return False
    return True


def text(folder, name):
    return (folder / name).read_text(encoding="ascii").strip()


@needs_mount
def test_a_found_motor_is_set_up_and_braked(live, motor):
    folder = motor_folder(live, "outB")
    for name, value in {
        "stop_action": "coast",
        "polarity": "inversed",
        "ramp_down_sp": "500",
        "duty_cycle_sp": "80",
        "position": "777",
    }.items():
        (folder / name).write_text(value, encoding="ascii")
    again = Ev3Motor("left", "outB", str(live))
    again.find()
    names = (
        "stop_action",
        "polarity",
        "ramp_up_sp",
        "ramp_down_sp",
        "duty_cycle_sp",
        "position",
        "state",
    )
    assert [text(folder, name) for name in names] == ["brake", "normal", "0", "0", "0", "0", ""]
    again._close()


@needs_mount
def test_a_found_motor_does_not_coast_on(live, motor):
    def way(let_go):
        motor.write_duty(80)
        begin = motor.angle_rad()
        assert eventually(lambda: motor.angle_rad() > begin + 4 * pi)
        begin = motor.angle_rad()
        let_go()
        assert eventually(lambda: text(motor_folder(live, "outB"), "speed") == "0")
        return motor.angle_rad() - begin

    def coast():
        for name, value in (("stop_action", "coast"), ("command", "stop")):
            (motor_folder(live, "outB") / name).write_text(value, encoding="ascii")

    def find():
        motor._lost = "to be found anew"
        motor.find()

    braked, coasted = way(motor.stop), way(coast)
    motor.stop()
    assert way(find) < (braked + coasted) / 2


@needs_mount
def test_a_duty_that_somebody_left_in_the_file_never_acts(live, motor, monkeypatch):
    folder = motor_folder(live, "outB")
    (folder / "duty_cycle_sp").write_text("100", encoding="ascii")
    at_run = []
    pwrite = os.pwrite

    def watched(descriptor, data, offset):
        if data == b"run-direct":
            at_run.append(text(folder, "duty_cycle_sp"))
        return pwrite(descriptor, data, offset)

    monkeypatch.setattr(os, "pwrite", watched)
    motor.write_duty(33)
    assert at_run == ["0"]
    assert text(folder, "state").split()[0] == "running"
    assert text(folder, "duty_cycle") == "33"
    motor.stop()
    assert (text(folder, "state"), text(folder, "duty_cycle_sp")) == ("", "0")


@needs_mount
def test_angles_are_the_positions_in_rad(live, motor):
    motor.write_duty(60)
    assert eventually(lambda: motor.angle_rad() > pi)
    motor.stop()
    folder = motor_folder(live, "outB")
    assert eventually(lambda: text(folder, "speed") == "0")
    assert motor.angle_rad() == pytest.approx(int(text(folder, "position")) * pi / 180)


@needs_mount
def test_unplugged_found_again_by_its_port_and_its_angle_goes_on(live, motor):
    def lost():
        try:
            motor.angle_rad()
        except MotorFault as fault:
            return "its cable came off: plug its cable in" in str(fault)
        return False

    motor.write_duty(60)
    assert eventually(lambda: motor.angle_rad() > pi)
    old = motor_folder(live, "outB").name
    inject(live, "unplug outB")
    last = motor.angle_rad()
    assert eventually(lost)
    for use in (motor.stop, lambda: motor.write_duty(0)):
        with pytest.raises(MotorFault, match="cable") as gone:
            use()
        assert gone.value.absent
    with pytest.raises(MotorFault, match="there is none"):
        motor.find()
    with pytest.raises(MotorFault, match="there is none") as gone:
        motor.stop()  # its files are closed now
    assert gone.value.absent
    inject(live, "replug outB")
    assert eventually(lambda: is_found(motor))
    assert motor_folder(live, "outB").name != old
    # The wheel may have come to rest only now.
    assert motor.angle_rad() == pytest.approx(last, abs=1)
    motor.write_duty(-60)
    assert eventually(lambda: motor.angle_rad() < last - 1)


@needs_mount
def test_a_motor_whose_files_are_not_writable_yet_is_told_as_such(live, motor):
    inject(live, "replug outB 1000000")

    def complaint():
        try:
            motor._lost = "to be found anew"
            motor.find()
        except MotorFault as fault:
            return "may not command it yet: wait a second and try again" in str(fault)
        return False

    assert eventually(complaint)
    inject(live, "replug outB")
    assert eventually(lambda: is_found(motor))


@needs_mount
def test_finding_a_motor_that_is_well_changes_nothing(live, motor):
    motor.write_duty(40)
    motor.find()
    assert text(motor_folder(live, "outB"), "duty_cycle") == "40"


@needs_mount
def test_an_io_error_makes_a_motor_lost_until_it_is_found(live, motor):
    motor.write_duty(40)
    inject(live, "eio outB")
    with pytest.raises(MotorFault, match="EIO"):
        motor.angle_rad()
    motor.stop()
    assert text(motor_folder(live, "outB"), "duty_cycle") == "0"
    (motor_folder(live, "outB") / "stop_action").write_text("coast", encoding="ascii")
    motor.find()
    assert text(motor_folder(live, "outB"), "stop_action") == "brake"


@needs_mount
@pytest.mark.parametrize("times", [1, 2])
def test_a_stop_gets_through_io_errors(live, motor, times):
    motor.write_duty(60)
    inject(live, f"eio outB {times}")
    motor.stop()
    assert text(motor_folder(live, "outB"), "duty_cycle") == "0"


@needs_mount
def test_a_stop_that_does_not_get_through_says_so(live, motor):
    motor.write_duty(60)
    inject(live, "eio outB 3")
    with pytest.raises(MotorFault, match="EIO") as deaf:
        motor.stop()
    assert not deaf.value.absent
    motor.stop()
    assert text(motor_folder(live, "outB"), "duty_cycle") == "0"


@needs_mount
def test_the_battery_of_the_live_tree(live):
    battery = Ev3Battery(str(live))
    # The motors of the test before may still roll out, and charge it.
    wait_until(lambda: battery.voltage_v() == 7.5, "the battery rests", battery.voltage_v)
    assert battery.stop_v == 6.2
