"""The plane of two constants in which the study `lines` works."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from host.theory.analysis.cycle_lines import Window
from host.theory.model.wheel import Array, Wheel, wheel_of

# The plane begins at this part of its greatest x and y: lines run to infinity towards 0.
_FROM = 1e-2
# The greatest value of an axis, unless it is given: for k and tau as in the phase diagram, for
# others this many times the wheel's own value.
_MOST, _TIMES = {"k": 20.0, "tau": 1.5}, 4.0


class Plane(NamedTuple):
    """A plane.

    Attributes:
        wheel: the wheel; its values of the two constants do not matter.
        x: the field of Wheel on the axis x.
        y: the field of Wheel on the axis y.
        window: the part of the plane that is looked at.
    """

    wheel: Wheel
    x: str
    y: str
    window: Window

    def at(self, x: float, y: float) -> Wheel:
        """The wheel at a point."""
        return self.wheel._replace(**{self.x: x, self.y: y})

    def at_logarithms(self, point: Array) -> Wheel:
        """The wheel at (ln x, ln y), (2,)."""
        return self.at(*np.exp(point).tolist())

    def band(self, number: int, count: int) -> Plane:
        """One of `count` bands of equal ratio in y, the first at the top."""
        whole = self.window
        edges = np.geomspace(whole.y_to, whole.y_from, count + 1).tolist()
        own = whole._replace(y_from=edges[number + 1], y_to=edges[number])
        return self._replace(window=own)


def plane_of(options: dict[str, Any]) -> Plane:
    """The plane that the options of the study name."""
    wheel = wheel_of(options)

    def most(axis: str) -> float:
        letter = options[axis]
        default = _MOST.get(letter, _TIMES * getattr(wheel, letter))
        return float(options[f"{axis}_to"] or default)

    x_to, y_to = most("x"), most("y")
    window = Window(_FROM * x_to, x_to, _FROM * y_to, y_to)
    return Plane(wheel, options["x"], options["y"], window)
