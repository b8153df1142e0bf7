"""Whose basins are to be computed, and where a start can lead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from sim_motor.constants import Constants

# The parameters that decide where a wheel ends.
DECISIVE = ("a", "tau_s", "k", "rods", "rod_lag_s", "duty_scale", "max_duty_pct", "tick_s")
ENDS = ("forward", "backward", "rest", "neither")


class Question(NamedTuple):
    """Whose basins to compute.

    Attributes:
        params: The parameters in force, by name; those of DECISIVE.
        motor: The robot's motors.
        battery_v: The battery's voltage, V; None if it is not known.
        side: How many starts there are along lag, and along speed.
        rows: Which rows of equal speed to compute: the first one, and the one after the last.
        radius: Of the circle of the starts' membrane potentials; None if it has to be found.
    """

    params: Mapping[str, Any]
    motor: Constants
    battery_v: float | None
    side: int
    rows: tuple[int, int]
    radius: float | None = None
