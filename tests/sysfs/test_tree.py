"""The file tree in virtual time.

That it is what the brick's kernel shows, down to the errors and the delays.
"""

import errno
import os
import re
from math import pi

import pytest

from sim_motor.brick import SimBrick
from sim_motor.sysfs import Tree

MOTOR = "/tacho-motor/motor0/"
READ, WRITE = os.R_OK, os.W_OK


class Files:
    """A tree and its time. Each file is opened once, as programs do."""

    def __init__(self, **options):
        self.brick = SimBrick(1, jitter=False, **options)
        self.tree = Tree(self.brick)
        self.now = 0.0
        self._handles = {}

    def handle(self, path, wanted):
        if (path, wanted) not in self._handles:
            self._handles[path, wanted] = self.tree.open(path, wanted)
        return self._handles[path, wanted]

    def read(self, path):
        return self.tree.read(self.handle(path, READ), 4096, 0).decode().rstrip("\n")

    def write(self, path, text):
        self.tree.write(self.handle(path, WRITE), text.encode())

    def wait(self, seconds):
        self.now += seconds
        self.tree.run_to(self.now)

    def run(self, duty):
        self.write(MOTOR + "duty_cycle_sp", str(duty))
        self.write(MOTOR + "command", "run-direct")

    def inject(self, fault):
        self.write("/.faults", fault)

    def first(self, condition, within=5.0):
        """The time until the condition holds, looked at every 2 ms."""
        begin = self.now
        while not condition():
            assert self.now - begin < within
            self.wait(0.002)
        return self.now - begin

    @property
    def position(self):
        return int(self.read(MOTOR + "position"))


@pytest.fixture
def files():
    return Files()


def fails(number):
    return pytest.raises(OSError, match=rf"\[Errno {number}\]")


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


def test_a_duty_acts_at_once_under_run_direct_and_is_only_stored_before(files):
    files.write(MOTOR + "duty_cycle_sp", "60")
    files.wait(1.0)
    assert files.position == 0
    assert files.read(MOTOR + "duty_cycle") == "0"
    files.write(MOTOR + "command", "run-direct")
    files.wait(1.0)
    forward = files.position
    assert forward > 180
    assert (files.read(MOTOR + "duty_cycle"), files.read(MOTOR + "state")) == ("60", "running")
    files.write(MOTOR + "duty_cycle_sp", "-60")
    files.wait(1.5)
    assert files.position < forward


def test_the_duty_survives_a_stop_and_acts_again(files):
    files.run(60)
    files.wait(0.5)
    files.write(MOTOR + "command", "stop")
    files.wait(3.0)
    assert files.read(MOTOR + "duty_cycle") == "0"
    assert files.read(MOTOR + "duty_cycle_sp") == "60"
    before = files.position
    files.write(MOTOR + "command", "run-direct")
    files.wait(0.5)
    assert files.position > before + 90


def test_a_reset_forgets_everything(files):
    for name, value in {
        "stop_action": "brake",
        "polarity": "inversed",
        "ramp_up_sp": "100",
    }.items():
        files.write(MOTOR + name, value)
    files.run(60)
    files.wait(0.5)
    assert files.position > 90
    assert files.brick.truth()[0].motor_speed < 0
    files.write(MOTOR + "command", "reset")
    names = (
        "position",
        "duty_cycle_sp",
        "stop_action",
        "polarity",
        "ramp_up_sp",
        "state",
        "speed_pid/Kp",
    )
    assert [files.read(MOTOR + name) for name in names] == [
        "0",
        "0",
        "coast",
        "normal",
        "0",
        "",
        "1000",
    ]


def test_a_position_can_be_written_even_while_the_motor_runs(files):
    files.run(60)
    files.wait(0.5)
    files.write(MOTOR + "position", "-1000")
    assert files.position == -1000
    files.wait(0.5)
    assert files.position > -910


def test_duty_0_brakes_and_coasting_takes_longer(files):
    way = {}
    for action in ("duty 0", "brake", "coast"):
        files.run(60)
        files.wait(1.5)
        begin = files.position
        if action == "duty 0":
            files.write(MOTOR + "duty_cycle_sp", "0")
        else:
            files.write(MOTOR + "stop_action", action)
            files.write(MOTOR + "command", "stop")
        files.wait(6.0)
        assert files.read(MOTOR + "speed") == "0"
        way[action] = files.position - begin
    assert way["duty 0"] == pytest.approx(way["brake"], abs=2)
    assert way["coast"] > 2 * way["brake"]


def test_the_position_is_whole_degrees_sampled_every_2_ms(files):
    start = files.brick.truth()[0].motor_angle
    files.run(100)
    seen = []
    for _ in range(1000):
        files.wait(0.0005)
        seen.append(
            (files.now, files.position, (files.brick.truth()[0].motor_angle - start) * 180 / pi)
        )
    changes = [
        now for (now, new, _), (_, old, _) in zip(seen[1:], seen, strict=False) if new != old
    ]
    assert len(changes) > 100
    assert {round(now / 0.0005) % 4 for now in changes} == {0}
    fastest = max(
        after - before for (_, _, after), (_, _, before) in zip(seen[4:], seen, strict=False)
    )
    assert all(true - fastest - 1.5 <= position <= true + 0.5 for _, position, true in seen)


def test_the_speed_is_that_of_the_wheel_in_both_directions(files):
    for duty in (70, -70):
        files.run(duty)
        files.wait(2.0)
        true = files.brick.truth()[0].motor_speed * 180 / pi
        assert abs(true) > 300
        assert int(files.read(MOTOR + "speed")) == pytest.approx(true, rel=0.05)


def test_the_speed_is_zero_only_200_ms_after_the_last_count(files):
    files.run(70)
    files.wait(1.0)
    files.write(MOTOR + "duty_cycle_sp", "0")
    moved = files.now
    last, zero = files.position, None
    seen = []
    while zero is None:
        files.wait(0.002)
        if files.position != last:
            moved, last = files.now, files.position
        seen.append(int(files.read(MOTOR + "speed")))
        zero = files.now if seen[-1] == 0 else None
    # The last of the counts, two to a degree, may have come after the last whole degree.
    assert 0.198 <= zero - moved < 0.3
    assert min(speed for speed in seen if speed) <= 4


def test_a_motor_that_gets_stuck_is_called_stalled_late(files):
    files.run(40)
    files.wait(2.0)
    files.brick.set_load(0, -5.0)
    assert files.read(MOTOR + "state") == "running"
    files.first(lambda: files.brick.truth()[0].motor_speed < 0)
    files.brick.set_load(0, 0.0)
    files.write(MOTOR + "duty_cycle_sp", "0")
    files.first(lambda: files.brick.truth()[0].motor_speed == 0)
    assert 0.25 < files.first(lambda: files.read(MOTOR + "state") == "running stalled") < 0.42


def test_a_motor_that_never_moves_is_called_stalled_after_100_ms(files):
    files.run(1)
    assert 0.1 < files.first(lambda: files.read(MOTOR + "state") == "running stalled") < 0.12
    files.write(MOTOR + "command", "stop")
    assert files.read(MOTOR + "state") == ""


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


def test_nobody_looking_for_long_changes_nothing(files):
    files.run(60)
    files.wait(60.0)
    often = Files()
    often.run(60)
    for _ in range(60):
        often.wait(1.0)
    assert files.position == often.position
    assert files.read(MOTOR + "speed") == often.read(MOTOR + "speed")
