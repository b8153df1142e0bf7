"""What the kernel may answer besides a number and an error with a number.

It is a fault in words, never the end of the program.
"""

import errno
import gc
import io
import os

import ev3dev2
import pytest

from robot.errors import Refused
from robot.ev3 import Ev3Battery, Ev3Motor
from robot.motors import MotorFault
from robot.record import STATES
from tests.rig import Rig
from tests.sysfs.plain import plain_motor

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


@pytest.fixture
def pair(tmp_path):
    """Both motors of a robot, found, and their folders."""
    folders = [plain_motor(tmp_path, 0, "outB"), plain_motor(tmp_path, 1, "outC")]
    motors = [Ev3Motor("left", "outB", str(tmp_path)), Ev3Motor("right", "outC", str(tmp_path))]
    for motor in motors:
        motor.find()
    yield motors, folders
    for motor in motors:
        motor._close()


class Stubborn(io.RawIOBase):
    """A file of the kernel that refuses everything that is written to it."""

    def writable(self):
        return True

    def write(self, data):
        raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))


@pytest.fixture
def refuse(monkeypatch):
    """Have the kernel refuse what python-ev3dev2 writes to an attribute."""
    opened = ev3dev2.Device._attribute_file_open

    def refuse(attribute):
        monkeypatch.setattr(
            ev3dev2.Device,
            "_attribute_file_open",
            lambda device, name: Stubborn() if name == attribute else opened(device, name),
        )

    return refuse


@pytest.mark.parametrize(
    "attribute", ["command", "stop_action", "polarity", "ramp_up_sp", "ramp_down_sp"]
)
def test_a_value_that_the_kernel_refuses_is_a_fault(tmp_path, refuse, attribute):
    plain_motor(tmp_path)
    refuse(attribute)
    motor = Ev3Motor("left", "outB", str(tmp_path))
    with pytest.raises(MotorFault, match=r"left motor \(outB\): the kernel refuses a value \(EI"):
        motor.find()
    with pytest.raises(MotorFault, match="refuses a value"):
        motor.angle_rad()


def test_a_fault_stays_when_a_motor_that_came_back_refuses_its_settings(pair, refuse):
    (left, right), _ = pair
    rig = Rig(left, right)
    left._lost = "its cable came off"
    rig.loop.fail("its cable came off")
    refuse("stop_action")
    with pytest.raises(Refused, match="the fault stays: left motor"):
        rig.loop.clear()
    rig.run(3)
    assert STATES[rig.last.state] == "fault"


@pytest.mark.parametrize("answer", ["", "\n", "twelve", "\x00"])
def test_a_position_that_is_no_number_stops_both_motors_until_it_is_cleared(pair, answer):
    (left, right), folders = pair
    rig = Rig(left, right)
    rig.loop.start()
    rig.run(2)
    (folders[0] / "position").write_text(answer, encoding="ascii")
    rig.run()
    assert STATES[rig.last.state] == "fault"
    assert "left motor (outB): the kernel gives no number for it" in rig.loop.safety.reason
    assert [(folder / "duty_cycle_sp").read_text()[0] for folder in folders] == ["0", "0"]
    rig.run(3)
    (folders[0] / "position").write_text("7\n", encoding="ascii")
    rig.loop.clear()
    rig.run()
    assert STATES[rig.last.state] == "stopped"


def test_a_duty_that_is_no_number_does_not_keep_a_motor_from_being_stopped(pair):
    (left, _), folders = pair
    left.write_duty(50)
    (folders[0] / "duty_cycle").write_text("", encoding="ascii")
    with pytest.raises(MotorFault, match="gives no number"):
        left.stop()
    assert (folders[0] / "command").read_text(encoding="ascii").startswith("stop")


@pytest.mark.parametrize("answer", ["", "\n", "full"])
def test_a_voltage_that_is_no_number_is_unknown(tmp_path, answer):
    folder = tmp_path / "power_supply" / "lego-ev3-battery"
    folder.mkdir(parents=True)
    (folder / "technology").write_bytes(b"Li-ion\xff\n")
    (folder / "voltage_now").write_text(answer, encoding="ascii")
    battery = Ev3Battery(str(tmp_path))
    assert battery.voltage_v() is None
    (folder / "voltage_now").write_text("7400000\n", encoding="ascii")
    assert battery.voltage_v() == 7.4


def test_a_motor_that_breaks_the_program_itself_does_not_keep_the_other_one_running():
    rig = Rig()
    rig.loop.start()
    rig.run(2)

    def broken():
        raise TypeError("a programming error")

    rig.motors[0].stop = broken
    rig.motors[1].done.clear()
    with pytest.raises(TypeError):
        rig.loop.stop("somebody")
    assert rig.motors[1].done == ["stop"]
