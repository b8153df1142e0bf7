"""The simulated kernel's files: which there are, what they take and what they show."""

import errno

import pytest

from tests.sysfs.files import MOTOR, READ, WRITE, fails


def test_a_motor_has_the_attributes_of_the_kernels_class(files):
    assert files.tree.names("/tacho-motor") == ["motor0", "motor1"]
    assert (
        " ".join(files.tree.names(MOTOR[:-1]))
        == "address command commands count_per_rot driver_name duty_cycle duty_cycle_sp hold_pid"
        " max_speed polarity position position_sp ramp_down_sp ramp_up_sp speed speed_pid"
        " speed_sp state stop_action stop_actions time_sp uevent"
    )
    assert files.tree.names(MOTOR + "speed_pid") == ["Kd", "Ki", "Kp"]
    values = {
        name: files.read(MOTOR + name)
        for name in ("address", "driver_name", "count_per_rot", "max_speed", "stop_action", "state")
    }
    assert values == {
        "address": "ev3-ports:outB",
        "driver_name": "lego-ev3-l-motor",
        "count_per_rot": "360",
        "max_speed": "1050",
        "stop_action": "coast",
        "state": "",
    }
    assert files.read("/tacho-motor/motor1/address") == "ev3-ports:outC"


@pytest.mark.parametrize(
    "text", ["101", "-101", "33.9", "", "\n", " 5", "5 ", "0x10", "1e1", "five", "5\n\n", "٣"]
)
def test_a_wrong_duty_is_refused_and_the_motor_keeps_the_old_one(files, text):
    files.run(40)
    files.wait(0.5)
    with fails(errno.EINVAL):
        files.write(MOTOR + "duty_cycle_sp", text)
    assert files.read(MOTOR + "duty_cycle_sp") == "40"
    before = files.position
    files.wait(0.5)
    assert files.position > before + 90


def test_a_number_beyond_32_bits_is_out_of_range(files):
    with fails(errno.ERANGE):
        files.write(MOTOR + "duty_cycle_sp", str(2**31))


@pytest.mark.parametrize("text", ["-100", "+7", "0", "007", "100\n"])
def test_what_the_kernel_reads_as_a_duty_is_taken(files, text):
    files.write(MOTOR + "duty_cycle_sp", text)
    assert files.read(MOTOR + "duty_cycle_sp") == str(int(text))


def test_a_shorter_value_leaves_nothing_of_a_longer_one(files):
    for value in ("100", "-7", "5"):
        files.write(MOTOR + "duty_cycle_sp", value)
        assert files.read(MOTOR + "duty_cycle_sp") == value


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("command", "go"),
        ("stop_action", "halt"),
        ("polarity", "1"),
        ("ramp_up_sp", "60001"),
        ("speed_sp", "1051"),
        ("time_sp", "-1"),
    ],
)
def test_what_no_attribute_knows_is_invalid(files, name, value):
    with fails(errno.EINVAL):
        files.write(MOTOR + name, value)


def test_regulated_runs_are_not_simulated_and_say_so(files):
    with fails(errno.EOPNOTSUPP):
        files.write(MOTOR + "command", "run-forever")
    assert files.read(MOTOR + "state") == ""


def test_permissions_are_the_groups(files):
    with fails(errno.EACCES):
        files.handle(MOTOR + "command", READ)
    with fails(errno.EACCES):
        files.handle(MOTOR + "speed", WRITE)
    with fails(errno.ENOENT):
        files.handle(MOTOR + "colour", READ)
    assert [
        oct(files.tree.mode(MOTOR + name) & 0o777) for name in ("command", "position", "speed")
    ] == ["0o220", "0o664", "0o444"]


def test_the_lights_keep_their_brightness(files):
    light = "/leds/led1:green:brick-status/brightness"
    files.write(light, "300")
    assert files.read(light) == "255"
    with fails(errno.EINVAL):
        files.write(light, "bright")


def test_a_text_is_read_in_pieces_as_it_was_at_its_beginning(files):
    files.run(60)
    files.wait(1.0)
    handle = files.handle(MOTOR + "position", READ)
    whole = files.tree.read(handle, 100, 0)
    files.wait(0.5)
    assert files.tree.read(handle, 100, 1) == whole[1:]
    assert files.tree.read(handle, 100, 0)[1:] != whole[1:]
    assert files.tree.read(handle, 100, 100) == b""
