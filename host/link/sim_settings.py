"""The settings of `sim://`, in one table: what the address takes, its help and its page say."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

from sim_motor.axle import stiffness_range
from sim_motor.brick import HIGHEST_BATTERY_V, HIGHEST_DITHER_DEG
from sim_motor.constants import data, names
from sim_motor.scene import LIMITS


class Setting(NamedTuple):
    """A setting.

    Attributes:
        name: As it stands in the address.
        unit: Of a number; empty for one without a unit, and for words.
        span: What it may be.
        default: What it is if it is left out.
        doc: What it does.
    """

    name: str
    unit: str
    span: str
    default: str
    doc: str


def settings() -> tuple[Setting, ...]:
    """All of them, in the order of the page docs/simulated-robot.md."""
    floor = data()["robot"]
    volts = f"more than 0, to {HIGHEST_BATTERY_V:g}"
    smooth, carpet = floor["grip"][0], floor["grip_on_carpet"][0]
    softest, stiffest = stiffness_range()
    dither = f"{floor['encoder_dither'][0]:g}"
    return (
        Setting(
            "seed",
            "",
            "0 or more",
            "another one each time",
            "random seed: the same seed gives the same run; a whole number",
        ),
        Setting("idle", "", "0 or 1", "0", "1: the motors are off until `kickctl start`"),
        Setting(
            "motor",
            "",
            f"{', '.join(names())}, or a name of your own",
            names()[0],
            "which motor is simulated; `kickctl experiment calibrate` writes one of your own",
        ),
        Setting(
            "battery",
            "V",
            volts,
            f"{floor['battery_voltage'][0]:g}",
            "voltage of the battery without load",
        ),
        Setting(
            "dither",
            "degrees",
            f"0 to {HIGHEST_DITHER_DEG:g}",
            dither,
            "standard deviation of the random errors of the angles that are read",
        ),
        _of_scene("walls", "none", "distance of two parallel walls; the robot begins halfway"),
        _of_scene("across", "none", "distance of two more walls, at right angles to them"),
        _of_scene(
            "grip",
            f"{smooth:g}",
            f"friction coefficient of the tyres: 0 without any, {smooth:g} on a smooth floor,"
            f" {carpet:g} on carpet",
        ),
        _of_scene(
            "stiffness",
            f"{floor['wall_stiffness'][0]:g}",
            "how hard a wall springs back at one corner of the robot",
        ),
        _of_scene(
            "bumper", f"{floor['body_width'][0]:g}", "width of the robot's front and of its rear"
        ),
        _of_scene(
            "axle",
            "rigid",
            "stiffness of the axle from each motor to its wheel; LEGO's have"
            f" {softest:.0f} to {stiffest:.0f} N/m",
        ),
        _of_scene(
            "apart",
            "0",
            "how far the right wheel is turned ahead of the left one in the beginning",
        ),
    )


def _of_scene(name: str, default: str, doc: str) -> Setting:
    least, most, unit = LIMITS[name]
    return Setting(name, unit, f"{_shown(least)} to {_shown(most)}", default, doc)


def _shown(number: float) -> str:
    return {-pi: "-pi", pi: "pi"}.get(number, f"{number:g}")
