"""An engineer's own motors: python3 -m robot --motors MODULE:FACTORY.

FACTORY is a function without arguments. It returns the left and the right motor, each a subclass of
robot.motors.Motor, and if there is one a robot.motors.Battery. docs/own-motors.md is about it.
"""

import importlib
import os
import traceback

from robot.kicks import WHEELS
from robot.motors import Battery, Motor, MotorFault, is_number

_MOTOR_NEEDS = ("angle_rad", "write_duty", "stop")


class NoMotors(Exception):
    """These motors cannot be used; the message says why, and what to do."""


def load(text):
    """The motors that a factory makes, after each has answered once. They are stopped.

    Args:
        text: MODULE:FACTORY, for example 'toy:motors' for the function motors in toy.py.

    Returns:
        (motors, battery, faults): the left and the right motor, the battery or None, and what the
        motors themselves say is wrong with them now, as a list of lines.

    Raises:
        NoMotors: There are none, or they cannot do what a motor has to do.
    """
    factory = _factory(text)
    try:
        parts = _call(text, factory)
    except MotorFault as fault:
        raise NoMotors(str(fault)) from None
    if not isinstance(parts, (tuple, list)) or len(parts) not in (2, 3):
        raise NoMotors(
            "{} returned {!r}: let it return the left and the right motor, and a battery if there"
            " is one".format(text, parts)
        )
    motors = tuple(parts[:2])
    battery = parts[2] if len(parts) == 3 else None
    for side, motor in zip(WHEELS, motors):
        _require("the {} motor of {}".format(side, text), motor, Motor, _MOTOR_NEEDS)
    if motors[0] is motors[1]:
        raise NoMotors(
            "{} returned the same motor twice: let it make one for each wheel".format(text)
        )
    if battery is not None:
        _require("the battery of {}".format(text), battery, Battery, ("voltage_v",))
        _read_once(battery)
    faults = []
    for side, motor in zip(WHEELS, motors):
        try:
            _try_out(side, motor)
        except MotorFault as fault:
            faults.append(str(fault))
    return motors, battery, faults


def unwatched(motors):
    """The sides, 'left' and 'right', whose motor the watchdog cannot stop."""
    return [side for side, motor in zip(WHEELS, motors) if motor.emergency_stop is None]


def stop_all(motors):
    """Stop the motors from the watchdog's process, even if some of them do not obey.

    Args:
        motors: The left and the right motor.

    Returns:
        A list with a line for each motor that could not be stopped: which, and why.
    """
    failed = []
    for side, motor in zip(WHEELS, motors):
        try:
            if motor.emergency_stop is not None:
                motor.emergency_stop()
        except (Exception, SystemExit) as error:  # noqa: BLE001 - the other motor has to stop too
            failed.append("{} motor: {}".format(side, _words(error)))
    return failed


def _factory(text):
    """The function that a MODULE:FACTORY names. Raises NoMotors."""
    name, _, attribute = text.partition(":")
    words = name.split(".") + [attribute]
    if words[-2] == "py" or not all(word.isidentifier() for word in words):
        raise NoMotors(
            "--motors {} names no factory: write MODULE:FACTORY, as in toy:motors for the function"
            " motors in toy.py".format(text)
        )
    try:
        module = importlib.import_module(name)
    except ImportError as error:
        if error.name is None or not (name + ".").startswith(error.name + "."):
            raise _broken("{} cannot be imported".format(name), error) from error
        raise NoMotors(
            "there is no module {} in {} or elsewhere on Python's path: start the program in the"
            " folder of {}.py, or add that folder to PYTHONPATH".format(
                name, os.getcwd(), name.replace(".", "/")
            )
        ) from None
    except (Exception, SystemExit) as error:
        raise _broken("{} cannot be imported".format(name), error) from error
    factory = getattr(module, attribute, None)
    if not callable(factory):
        raise NoMotors(
            "{} has no function {}: write one that returns the left and the right motor, or name"
            " another".format(getattr(module, "__file__", None) or name, attribute)
        )
    return factory


def _require(what, thing, kind, names):
    """Raise NoMotors if a thing is not of a kind, or lacks one of the kind's methods."""
    if not isinstance(thing, kind):
        raise NoMotors(
            "{} is {!r}: let its class be a subclass of robot.motors.{}".format(
                what, thing, kind.__name__
            )
        )
    missing = [
        name
        for name in names
        if getattr(getattr(thing, name, None), "__func__", None) is getattr(kind, name)
        or not callable(getattr(thing, name, None))
    ]
    if missing:
        raise NoMotors(
            "{} has no method {}: write it in class {}, as robot.motors.{} describes it".format(
                what, " and no ".join(missing), type(thing).__name__, kind.__name__
            )
        )


def _try_out(side, motor):
    """Use each method of a motor once, and leave it stopped. Raises MotorFault and NoMotors."""
    for name, arguments in (("find", ()), ("write_duty", (0,)), ("stop", ())):
        _call("{} of the {} motor".format(name, side), getattr(motor, name), *arguments)
    what = "angle_rad of the {} motor".format(side)
    angle = _call(what, motor.angle_rad)
    if not is_number(angle):
        raise NoMotors(
            "{} returned {!r}: let it return the angle in rad, as a float".format(what, angle)
        )
    if not isinstance(motor.model, str):
        raise NoMotors(
            "the model of the {} motor is {!r}: make it a name, or leave it out".format(
                side, motor.model
            )
        )
    if motor.emergency_stop is not None and not callable(motor.emergency_stop):
        raise NoMotors(
            "emergency_stop of the {} motor is {!r}: make it a method, or leave it out".format(
                side, motor.emergency_stop
            )
        )


def _read_once(battery):
    """Read a battery, and its limits. Raises NoMotors."""
    try:
        volts = _call("voltage_v of the battery", battery.voltage_v)
    except MotorFault as fault:
        raise NoMotors("voltage_v of the battery failed: {}".format(fault)) from None
    if volts is not None and not is_number(volts):
        raise NoMotors(
            "voltage_v of the battery returned {!r}: let it return the voltage in V, as a float, or"
            " None if it cannot be read".format(volts)
        )
    for name in ("warn_v", "stop_v"):
        limit = getattr(battery, name)
        if not is_number(limit):
            raise NoMotors(
                "{} of the battery is {!r}: make it a voltage in V, or leave it out".format(
                    name, limit
                )
            )


def _call(what, function, *arguments):
    """What a function of the engineer's returns. Raises MotorFault, and NoMotors if it fails."""
    try:
        return function(*arguments)
    except MotorFault:
        raise
    except (Exception, SystemExit) as error:
        raise _broken("{} failed".format(what), error) from error


def _broken(what, error):
    """The NoMotors for an error in the engineer's own code: what it is, and where to mend it."""
    if isinstance(error, SyntaxError):
        place = "{}, line {}".format(error.filename, error.lineno)
    else:
        place = "{}, line {}".format(*traceback.extract_tb(error.__traceback__)[-1][:2])
    return NoMotors("{}: {} ({}); mend it, and start again".format(what, _words(error), place))


def _words(error):
    """An error's kind and its message."""
    return "{}: {}".format(type(error).__name__, error).rstrip(": ")
