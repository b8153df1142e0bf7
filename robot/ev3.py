"""The brick's motors and its battery, through the kernel's files.

python-ev3dev2 finds a motor by its port and sets it up. The tick itself reads and writes through
descriptors that are opened once, which is faster.
"""

import errno
import os
from math import pi
from os import pread, pwrite

import ev3dev2  # not ev3dev2.motor, whose import takes a brick 1 s

from robot.motors import Battery, Motor, MotorFault

SYSFS = "/sys/class"
DRIVER = "lego-ev3-l-motor"
RAD_PER_DEGREE = pi / 180
READ_BYTES = 16
STOP_TRIES = 3
# There is no motor now, or none was found.
_ABSENT = (errno.ENODEV, errno.ENOENT, errno.EBADF)
# The text of every valid duty cycle. Any other value is a MotorFault here, instead of the kernel's
# EINVAL.
DUTY_TEXT = {duty: b"%d" % duty for duty in range(-100, 101)}

# With a ramp the kernel would regulate the stop.
_SETUP = (
    ("command", b"reset"),
    ("stop_action", b"brake"),
    ("polarity", b"normal"),
    ("ramp_up_sp", b"0"),
    ("ramp_down_sp", b"0"),
)

# In V. brickd, with the limits of LEGO's firmware, warns of a low lithium pack at 6.5 and of low AA
# cells at 5.5, and switches the brick off at 6.0 and 4.5. The motors stop before that; below 5 V
# brick and motors do not work well.
LITHIUM_WARN_V, LITHIUM_STOP_V = 6.5, 6.2
OTHER_WARN_V, OTHER_STOP_V = 5.5, 5.0

_CABLE = "plug its cable in, wait a second, then clear the fault"
_CAUSES = {
    errno.ENODEV: ("its cable came off", _CABLE),
    errno.ENOENT: ("its cable came off", _CABLE),
    errno.EIO: ("the kernel cannot talk to it (EIO)", "check its cable, then clear the fault"),
    errno.EINVAL: (
        "the kernel refuses a value (EINVAL)",
        "clear the fault; if it comes back, report it",
    ),
    errno.ENODATA: (
        "the kernel gives no number for it",
        "clear the fault; if it comes back, check its cable",
    ),
}
# Errors that may pass: the motor gets the command to stop again.
_PASSING = (errno.EIO, errno.ENODATA)
_NOT_READY = "wait a second and try again; if it stays so, add this user to the group ev3dev"


def _number(error):
    """The kernel's number for an error, None if it has none.

    python-ev3dev2 turns EINVAL into a ValueError, and an empty file gives a ValueError too.
    """
    if isinstance(error, OSError):
        return error.errno
    return getattr(error.__cause__, "errno", errno.ENODATA)


class Ev3Motor(Motor):
    """The large motor at a port. It counts as lost until `find` has found it, and when it fails.

    Args:
        name: What people call it: 'left' or 'right'.
        port: The port, for example 'outB'.
        root: Where the kernel's classes of devices are.
    """

    model = DRIVER

    def __init__(self, name, port, root=SYSFS):
        self._label = "{} motor ({})".format(name, port)
        self._port = port
        self._root = root
        self._lost = self._label + ": nobody has looked for it yet"
        self._running = False
        self._position = self._duty = self._command = self._applied = -1
        self._zero = self._angle = 0.0

    def angle_rad(self):
        try:
            self._angle = angle = (
                self._zero + int(pread(self._position, READ_BYTES, 0)) * RAD_PER_DEGREE
            )
        except (OSError, ValueError) as error:
            raise self._fault(error) from error
        return angle

    def write_duty(self, duty_pct):
        try:
            if not self._running:
                self._run()
            pwrite(self._duty, DUTY_TEXT[duty_pct], 0)
        except OSError as error:
            raise self._fault(error) from error
        except KeyError:
            raise MotorFault(
                "{}: {!r} is no duty cycle: write a whole number from -100 to 100".format(
                    self._label, duty_pct
                )
            ) from None

    def stop(self):
        self._running = False
        for left in reversed(range(STOP_TRIES)):
            try:
                # Duty 0 first: it brakes at once, also if the motor misses the command.
                os.pwrite(self._duty, DUTY_TEXT[0], 0)
                os.pwrite(self._command, b"stop", 0)
                if int(os.pread(self._applied, READ_BYTES, 0)) == 0:
                    return
            except (OSError, ValueError) as error:
                if not left or _number(error) not in _PASSING:
                    raise self._fault(error) from error
        self._lost = "{}: it does not stop: pull its cable out".format(self._label)
        raise MotorFault(self._lost)

    def find(self):
        if not self._lost:
            return
        self._close()
        self._zero = self._angle
        try:
            self._set_up()
            self._lost = ""
            self.stop()
        except (OSError, ValueError, ev3dev2.DeviceNotFound) as error:
            self._close()
            self._lost = self._missing(error)
            # The error's traceback would keep the library's frames, and their open files, until
            # the garbage collector comes.
            raise MotorFault(self._lost) from error.with_traceback(None)

    def _set_up(self):
        folder = os.path.join(self._root, "tacho-motor")
        name = next(ev3dev2.list_device_names(folder, "motor*", address=self._port), None)
        if name is None:
            raise OSError(errno.ENODEV, os.strerror(errno.ENODEV))
        ev3dev2.Device.DEVICE_ROOT_PATH = self._root
        motor = ev3dev2.Device("tacho-motor", name, name_exact=True)
        driver = motor.get_attr_string(None, "driver_name")[1]
        if driver != DRIVER:
            self._lost = "{}: a {} is there: plug in a large motor, then clear the fault".format(
                self._label, driver
            )
            raise MotorFault(self._lost)
        for attribute, value in _SETUP:
            motor.set_attr_raw(None, attribute, value)
        folder = os.path.join(folder, name)
        self._position = os.open(os.path.join(folder, "position"), os.O_RDONLY)
        self._duty = os.open(os.path.join(folder, "duty_cycle_sp"), os.O_WRONLY)
        self._command = os.open(os.path.join(folder, "command"), os.O_WRONLY)
        self._applied = os.open(os.path.join(folder, "duty_cycle"), os.O_RDONLY)

    def _close(self):
        for descriptor in (self._position, self._duty, self._command, self._applied):
            if descriptor >= 0:
                os.close(descriptor)
        self._position = self._duty = self._command = self._applied = -1

    def _run(self):
        # The duty cycle that is still in the file would act at once.
        os.pwrite(self._duty, DUTY_TEXT[0], 0)
        os.pwrite(self._command, b"run-direct", 0)
        self._running = True

    def _fault(self, error):
        """The MotorFault for an error of the kernel. From now on the motor counts as lost."""
        number = _number(error)
        # EBADF: nothing is open, and the reason is known already.
        if number != errno.EBADF:
            cause, remedy = _CAUSES.get(
                number, ("the kernel reports: {}".format(error), "clear the fault")
            )
            self._lost = "{}: {}: {}".format(self._label, cause, remedy)
        return MotorFault(self._lost, absent=number in _ABSENT)

    def _missing(self, error):
        # python-ev3dev2 has one error for a motor that is not there or disappears just now, and one
        # without a number for files that udev has not opened to this user yet.
        number = errno.ENODEV if isinstance(error, ev3dev2.DeviceNotFound) else _number(error)
        if number in (errno.ENODEV, errno.ENOENT):
            return "{}: there is none: {}".format(self._label, _CABLE)
        if number in (None, errno.EACCES, errno.EPERM):
            return "{}: it is there, but this user may not command it yet: {}".format(
                self._label, _NOT_READY
            )
        return str(self._fault(error))


class Ev3Battery(Battery):
    """The brick's battery.

    Args:
        root: Where the kernel's classes of devices are.

    Raises:
        OSError: There is none.
    """

    def __init__(self, root=SYSFS):
        folder = os.path.join(root, "power_supply", "lego-ev3-battery")
        with open(os.path.join(folder, "technology"), "rb") as file:
            lithium = file.read().strip() == b"Li-ion"
        self.warn_v = LITHIUM_WARN_V if lithium else OTHER_WARN_V
        self.stop_v = LITHIUM_STOP_V if lithium else OTHER_STOP_V
        self._voltage = os.open(os.path.join(folder, "voltage_now"), os.O_RDONLY)

    def voltage_v(self):
        try:
            return int(os.pread(self._voltage, READ_BYTES, 0)) / 1e6
        except (OSError, ValueError):  # ValueError: the file is empty
            return None
