"""Two motors as plain files, and the ways to drive them that the benchmarks compare.

The emulated brick imports this too.
"""

from pathlib import Path

import ev3dev2
from ev3dev2.motor import LargeMotor

from robot.ev3 import DRIVER, RAD_PER_DEGREE, Ev3Motor
from robot.motors import Motor

PORTS = ("outB", "outC")
ATTRIBUTES = {
    "command": "",
    "count_per_rot": "360",
    "driver_name": DRIVER,
    "duty_cycle": "0",
    "duty_cycle_sp": "0",
    "max_speed": "1050",
    "polarity": "normal",
    "position": "1234",
    "ramp_down_sp": "0",
    "ramp_up_sp": "0",
    "stop_action": "coast",
}
BATTERY = {"technology": "Li-ion", "voltage_now": "7500000"}


def make_tree(root):
    """Fill the folder `root` with a motor at each port and a battery. Plain files.

    Nothing moves, and nothing is refused.
    """
    for number, port in enumerate(PORTS):
        _write(Path(root, "tacho-motor", "motor" + str(number)), dict(ATTRIBUTES, address=port))
    _write(Path(root, "power_supply", "lego-ev3-battery"), BATTERY)


def _write(folder, attributes):
    folder.mkdir(parents=True)
    for name, value in attributes.items():
        (folder / name).write_text(value + "\n", encoding="ascii")
        # python-ev3dev2 opens an attribute as the group's permissions say.
        (folder / name).chmod(0o664)


class LibraryMotor(Motor):
    """A motor read and written through the properties of python-ev3dev2's LargeMotor."""

    def __init__(self, port, root):
        ev3dev2.Device.DEVICE_ROOT_PATH = root
        self._motor = LargeMotor(port)

    def angle_rad(self):
        return self._motor.position * RAD_PER_DEGREE

    def write_duty(self, duty_pct):
        self._motor.duty_cycle_sp = duty_pct

    def stop(self):
        self._motor.stop()


def our_motors(root):
    """Both motors through robot.ev3."""
    motors = [Ev3Motor("test", port, root) for port in PORTS]
    for motor in motors:
        motor.find()
    return motors


def library_motors(root):
    """Both motors through python-ev3dev2 alone."""
    return [LibraryMotor(port, root) for port in PORTS]
