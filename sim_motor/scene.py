"""What a robot may have around it, in numbers: a floor and walls."""

from dataclasses import dataclass
from math import pi


@dataclass(frozen=True)
class Scene:
    """A robot on a floor, with or without walls. What is None else is as in motors.toml.

    Attributes:
        walls: The distance between two parallel walls, m; None for none.
        across: That between two more, at right angles to them, m; None for none.
        grip: The tyres' friction coefficient, 1.
        stiffness: That of a wall at one corner of the body, N/m.
        bumper: The width of the body's front and rear, m.
        axle: The stiffness of the axle from each motor to its wheel, at the rim, N/m.
        apart: How far the right wheel is ahead of the left one, rad, when the left one stands at
            zero in the beginning. The robot's own program resets both when it starts.

    Raises:
        ValueError: A number is out of its LIMITS.
    """

    walls: float | None = None
    across: float | None = None
    grip: float | None = None
    stiffness: float | None = None
    bumper: float | None = None
    axle: float | None = None
    apart: float = 0.0

    def __post_init__(self) -> None:
        for name, (least, most, unit) in LIMITS.items():
            value = getattr(self, name)
            if value is not None and not least <= value <= most:
                bounds = f"from {least:g} to {most:g} {unit}".rstrip()
                raise ValueError(f"{name} cannot be {value!r}: give a number {bounds}")


# Walls that leave room for the body, and springs that the steps can follow.
LIMITS = {
    "walls": (0.4, 100.0, "m"),
    "across": (0.4, 100.0, "m"),
    "grip": (0.0, 10.0, ""),
    "stiffness": (100.0, 100000.0, "N/m"),
    "bumper": (0.05, 0.4, "m"),
    "axle": (50.0, 100000.0, "N/m"),
    "apart": (-pi, pi, "rad"),
}
