"""Which motor a robot has: the constants with which its kicks are planned."""

from __future__ import annotations

from host.client.robot import Robot
from host.errors import WrongUse
from sim_motor.constants import Constants, load

# What the robot's program calls the EV3's large motor, and its published entry.
EV3 = "lego-ev3-l-motor"
EV3_ENTRY = "pybricks"

MEASURE = (
    "measure it (kickctl experiment calibrate) and install the file that this writes; kickctl plan"
    " and kickctl drive also take an entry that fits: --motor NAME; docs/own-motors.md says how"
)


def model_of(robot: Robot) -> str:
    """The model that a robot's program gives its motors; empty if it gives none.

    Programs of older releases do not say it. They drive the EV3's.
    """
    model = robot.hello.get("motor", EV3)
    return model if isinstance(model, str) else ""


def known_entry(model: str) -> str | None:
    """The entry of a motors file for a model; None if this computer has none that can be used."""
    name = EV3_ENTRY if model == EV3 else model
    try:
        load(name)
    except ValueError:
        return None
    return name


def motor_of(robot: Robot, entry: str | None = None) -> Constants:
    """The constants of a robot's motors.

    Args:
        robot: The robot.
        entry: The name of an entry of a motors file; by default that of the robot's own model.

    Raises:
        WrongUse: There is no entry of this name, or the robot has a motor that this computer does
            not know.
    """
    if entry is not None:
        try:
            return load(entry)
        except ValueError as error:
            raise WrongUse(str(error), "name one of these: --motor NAME") from error
    model = model_of(robot)
    if not model:
        raise WrongUse(
            "the robot does not say which motor it has, so nobody can compute which kicks turn it",
            MEASURE,
        )
    try:
        return load(EV3_ENTRY if model == EV3 else model)
    except ValueError as error:
        raise WrongUse(
            f"which kicks turn this robot follows from its motor, '{model}', and {error}", MEASURE
        ) from error
