"""The numbers of the cars, from presets.toml, where their sources stand."""

from __future__ import annotations

import tomllib
from math import isfinite, pi
from pathlib import Path
from typing import Any, NamedTuple

HERE = Path(__file__).parent
# Where the program of 2019 starts all wheels (rad): the rod pulls them forward.
PUSHED = -pi / 3


class Preset(NamedTuple):
    """A car, its coupling to the next, and its controller, in SI units; k is a force."""

    body_mass: float
    wheel_mass: float
    wheel_radius: float
    body_radius: float
    body_height: float
    wheel_width: float
    body_drag: float
    wheel_drag: float
    friction: float
    slip: float
    pitch: float
    spring: float
    spring_damping: float
    joint_range: float
    a: float
    tau: float
    k: float

    def with_drag(self, drag: float) -> Preset:
        """The same car with this drag, in place of the preset's.

        It acts on the body, in N s/m, or on the wheels, in N s/rad.
        """
        return self._replace(body_drag=drag) if self.body_drag else self._replace(wheel_drag=drag)

    def checked(self) -> Preset:
        """The same preset. Raises ValueError if a car cannot have one of its numbers."""
        for name, value in self._asdict().items():
            if not isfinite(value) or value < 0.0 or (value == 0.0 and name not in _MAY_BE_0):
                raise ValueError(
                    f"{name} cannot be {value!r}: give a finite number,"
                    f" {'0 or more' if name in _MAY_BE_0 else 'above 0'}"
                )
        return self


_MAY_BE_0 = ("body_drag", "wheel_drag", "friction", "spring", "spring_damping", "a", "k")
_TABLE: dict[str, dict[str, Any]] = tomllib.loads(
    (HERE / "presets.toml").read_text(encoding="utf-8")
)
NAMES = tuple(_TABLE)


def preset(name: str) -> Preset:
    """The preset of this name. Raises KeyError."""
    numbers = _TABLE[name]
    return Preset(**{field: float(numbers[field]) for field in Preset._fields}).checked()
