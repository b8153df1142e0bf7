"""Cables, errors and batteries of the simulated brick, on demand."""

import errno
import re

import pytest

from tests.sysfs.files import MOTOR, READ, WRITE, fails


def test_an_unplugged_motor_freezes_and_is_gone_100_ms_later(files):
    files.run(60)
    files.wait(1.0)
    files.inject("unplug outB")
    frozen = files.position
    files.wait(0.09)
    assert files.position == frozen
    files.write(MOTOR + "duty_cycle_sp", "-60")
    assert files.brick.truth()[0].motor_speed > 0
    files.wait(0.02)
    for access in (
        lambda: files.read(MOTOR + "position"),
        lambda: files.write(MOTOR + "duty_cycle_sp", "0"),
    ):
        with fails(errno.ENODEV):
            access()
    with fails(errno.ENOENT):
        files.handle(MOTOR + "state", READ)
    assert files.tree.names("/tacho-motor") == ["motor1"]
    assert files.read("/tacho-motor/motor1/position") == "0"


def test_a_motor_that_comes_back_is_another_one_that_may_not_be_written_yet(files):
    files.run(60)
    files.wait(1.0)
    assert files.position > 180
    files.inject("unplug outB")
    files.wait(0.2)
    files.inject("replug outB")
    files.wait(0.38)
    assert files.tree.names("/tacho-motor") == ["motor1"]
    files.wait(0.02)
    assert files.tree.names("/tacho-motor") == ["motor1", "motor2"]
    back = "/tacho-motor/motor2/"
    assert files.read(back + "address") == "ev3-ports:outB"
    assert abs(int(files.read(back + "position"))) < 45
    assert files.read(back + "duty_cycle_sp") == "0"
    with fails(errno.EACCES):
        files.handle(back + "command", WRITE)
    files.wait(0.31)
    files.write(back + "command", "run-direct")
    with fails(errno.ENODEV):
        files.read(MOTOR + "position")


def test_an_io_error_happens_as_often_as_it_was_asked_for(files):
    files.inject("eio outB 2")
    files.read("/tacho-motor/motor1/position")
    for _ in range(2):
        with fails(errno.EIO):
            files.read(MOTOR + "position")
    assert files.position == 0


def test_the_battery_is_in_microvolts_sags_and_can_be_changed(files):
    voltage = "/power_supply/lego-ev3-battery/voltage_now"
    assert files.read(voltage) == "7500000"
    files.run(100)
    files.wait(0.05)
    assert 6_500_000 < int(files.read(voltage)) < 7_400_000
    files.wait(3.0)
    fast = files.brick.truth()[0].motor_speed
    files.inject("battery 6.1")
    files.wait(3.0)
    assert int(files.read(voltage)) < 6_100_000
    assert files.brick.truth()[0].motor_speed == pytest.approx(fast * 6.1 / 7.5, rel=0.05)


@pytest.mark.parametrize(
    "fault",
    [
        "",
        "unplug",
        "unplug outA",
        "replug outZ",
        "battery full",
        "battery 84",
        "eio outB x",
        "fire outB",
    ],
)
def test_an_unknown_fault_is_refused(files, fault):
    with fails(errno.EINVAL):
        files.inject(fault)


def test_the_file_of_faults_names_them_all(files):
    assert re.findall(r"^\w+", files.read("/.faults"), re.MULTILINE) == [
        "unplug",
        "replug",
        "eio",
        "battery",
    ]
