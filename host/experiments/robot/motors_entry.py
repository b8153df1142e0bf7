"""The entry of a motors file with which sim:// behaves as a measured robot does."""

from __future__ import annotations

from math import degrees
from typing import TypedDict

import numpy as np

from host.experiments.robot.calibrate_rows import Row, base
from host.experiments.robot.identification import Found
from host.experiments.robot.motor_traits import Traits, constants_of
from host.kicking.robot_motor import EV3
from sim_motor.constants import load, names

NAME = "mine"
ADOPT = "install -D -m 644 motors.toml ~/.config/kickctl/motors.toml"
APPEND = "cat motors.toml >>~/.config/kickctl/motors.toml"


class Check(TypedDict):
    """How well the model predicts a run that was not fitted.

    Attributes:
        rms_deg: rms error of its angles (degrees).
        way: by what share of the travelled way it is too far (1).
    """

    rms_deg: float
    way: float


def name_of(model: str) -> str:
    """The name of a measured motor's table: its model, under which `plan` looks for it.

    It is NAME for the EV3's motor and for published ones, whose own numbers stay in force, and for
    a model that is no name for a table.
    """
    known = model == EV3 or model in names()
    return model if model.isidentifier() and model.isascii() and not known else NAME


def entry(
    found: dict[str, Found], check: dict[str, Check], rows: list[Row], battery_v: float
) -> str:
    """The table of a motors file: the mean of both wheels, and where each number comes from."""
    name, date, published = name_of(rows[0]["motor"]), rows[0]["date"], load(base(rows))
    mean = Traits(*np.mean([one.traits for one in found.values()], axis=0).tolist())
    c = constants_of(mean, published, battery_v)

    def seen(trait: str, unit: str) -> str:
        each = [
            f"{side} {one.intervals[trait][0]:.4g} to {one.intervals[trait][1]:.4g}"
            for side, one in found.items()
        ]
        return (
            f"identified {date} by kickctl experiment calibrate from {trait}: {', '.join(each)}"
            f" {unit}, 95 %"
        )

    unseen = f"as of {base(rows)}: a log of duties and angles does not show it by itself"
    numbers = {
        "torque_constant": (c.torque_constant, "N m/A", unseen),
        "emf_constant": (c.emf_constant, "V s/rad", seen("speed_per_v", "rad/s/V")),
        "resistance": (c.resistance, "ohm", unseen),
        "inductance": (c.inductance, "H", unseen),
        "inertia": (c.motor_inertia, "kg m2", seen("time_constant_s", "s")),
        "viscous_friction": (c.viscous, "N m s/rad", seen("viscous_part", "of the damping")),
        "coulomb_friction": (c.kinetic, "N m", seen("kinetic_pct", "% duty")),
        "break_away_duty": (mean.static_pct, "%", seen("static_pct", "% duty")),
        "backlash": (degrees(c.backlash), "deg", seen("backlash_deg", "deg")),
        "latency": (c.latency_s, "s", seen("delay_ms", "ms with the coil's L/R")),
        "source_resistance": (c.source_resistance, "ohm", seen("sag", "of half the resistance")),
        "battery_voltage": (battery_v, "V", f"the battery at rest, {date}"),
    }
    lines = [
        f'{key} = [{value:.6g}, "{unit}", "{source}"]'
        for key, (value, unit, source) in numbers.items()
    ]
    worst = max(one.rms_deg for one in found.values())
    ahead = max(one["rms_deg"] for one in check.values())
    adopt = f"# sim://?motor={name} is this robot, once you have said, in this folder: {ADOPT}"
    append = f"# If you have that file already, this adds to it: {APPEND}"
    off = (
        f"# Off by {worst:.2f} degrees (rms; one count of the encoder makes 0.29) where it was"
        f" fitted, by {ahead:.2f} where it was not."
    )
    return "\n".join([adopt, append, off, f"[{name}]", *lines, ""])
