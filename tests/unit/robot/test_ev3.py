"""The brick's motors and battery (robot.ev3) on plain files, where the kernel is to be odd."""

import gc

import pytest

from robot.ev3 import Ev3Battery, Ev3Motor
from robot.motors import MotorFault
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
def plain(tmp_path):
    """A motor at outB whose files are plain ones."""
    return plain_motor(tmp_path)


def text(folder, name):
    return (folder / name).read_text(encoding="ascii").strip()


def make_motor(plain):
    return Ev3Motor("left", "outB", str(plain.parent.parent))


def test_a_motor_that_nobody_looked_for_says_so(plain):
    motor = make_motor(plain)
    for use in (motor.angle_rad, motor.stop, lambda: motor.write_duty(5)):
        with pytest.raises(MotorFault, match=r"left motor \(outB\): nobody has looked"):
            use()


def test_an_empty_port_is_told_with_what_to_do(plain):
    motor = Ev3Motor("right", "outC", str(plain.parent.parent))
    with pytest.raises(MotorFault, match=r"right motor \(outC\): there is none: plug its cable in"):
        motor.find()
    with pytest.raises(MotorFault, match="there is none"):
        motor.angle_rad()


def test_a_machine_without_motors_is_told_the_same(tmp_path):
    with pytest.raises(MotorFault, match="there is none"):
        Ev3Motor("left", "outB", str(tmp_path)).find()


def test_another_kind_of_motor_is_refused_by_name(plain):
    (plain / "driver_name").write_text("lego-ev3-m-motor\n", encoding="ascii")
    motor = make_motor(plain)
    with pytest.raises(MotorFault, match="a lego-ev3-m-motor is there: plug in a large motor"):
        motor.find()
    with pytest.raises(MotorFault, match="lego-ev3-m-motor"):
        motor.stop()


def test_a_motor_that_does_not_stop_is_told_and_counts_as_lost(plain):
    motor = make_motor(plain)
    motor.find()
    (plain / "duty_cycle").write_text("30\n", encoding="ascii")
    with pytest.raises(MotorFault, match="does not stop: pull its cable"):
        motor.stop()
    (plain / "duty_cycle").write_text("0\n", encoding="ascii")
    (plain / "ramp_up_sp").write_text("9\n", encoding="ascii")
    motor.find()
    assert text(plain, "ramp_up_sp").startswith("0")
    motor._close()


@pytest.mark.parametrize(
    ("technology", "warn_v", "stop_v"),
    [("Li-ion", 6.5, 6.2), ("Unknown", 5.5, 5.0), ("NiMH", 5.5, 5.0)],
)
def test_when_a_battery_is_low_depends_on_its_kind(tmp_path, technology, warn_v, stop_v):
    folder = tmp_path / "power_supply" / "lego-ev3-battery"
    folder.mkdir(parents=True)
    (folder / "technology").write_text(technology + "\n", encoding="ascii")
    (folder / "voltage_now").write_text("7412345\n", encoding="ascii")
    battery = Ev3Battery(str(tmp_path))
    assert (battery.warn_v, battery.stop_v, battery.voltage_v()) == (warn_v, stop_v, 7.412345)


def test_a_machine_without_a_battery_has_none(tmp_path):
    with pytest.raises(FileNotFoundError):
        Ev3Battery(str(tmp_path))
