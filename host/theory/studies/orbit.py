"""The study `orbit`: the orbit diagram over a constant, on a Poincare section, up and down.

Each value of the constant begins with the state in which the wheel has ended at the value before,
a little disturbed. Where the ways up and down differ, attractors coexist.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.analysis.attractors import KINDS, REST, random_starts
from host.theory.engine.crossings import Surface, crossings
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies.lyapunov_pieces import require_slow
from host.theory.studies.orbit_report import report
from host.theory.studies.orbit_rows import WAYS, OrbitCell, OrbitPoint, Way
from host.theory.studies.section_pieces import Settled, follow_wheels, settle_longer, swing_s
from host.theory.studies.section_rows import MotionColumns
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

# Values of the constant in a cell.
BAND = 20
# Looks at a wheel, each SWINGS slowest swings long; it has settled when it repeats itself in one.
LOOKS, SWINGS = 2, 10.0
# A cell comes to its first value by the values before, each for this number of slowest swings.
APPROACH_SWINGS = 0.5
# What a state is disturbed by.
DISTURBANCE = np.array([[1e-3], [-1e-3], [1e-3], [1e-3]])
# Steps per unit of a wheel's rate (see host.theory.engine.flow): moments to about 2e-11 s.
FINENESS = 2.0
# Points of a wheel that does not repeat itself.
MOST = 64


def cells(options: dict[str, Any], *, batch: bool = True) -> list[OrbitCell]:
    """Bands of values, up and down.

    Raises WrongUse if there is no range, or wheels in it do not swing, or are too fast for long.
    """
    require_two_rods(options)
    values = values_of(options)
    for value in values[[0, -1]].tolist():
        wheel = wheel_of({**options, options["over"]: value})
        require_slow(wheel)
        swing_s(wheel)
    return [{"way": way, "first": first} for way in WAYS for first in range(0, len(values), BAND)]


def values_of(options: dict[str, Any]) -> Array:
    """The values of the constant, ascending. Raises WrongUse if there is no range."""
    name = options["over"]
    high = options["to"] or (20.0 if name == "k" else 4.0 * options[name])
    low = high / 20.0 if options["from"] is None else options["from"]
    if low >= high:
        raise WrongUse(f"{name} cannot go from {low:g} to {high:g}", "give --from less than --to")
    return np.linspace(low, high, options["values"])


def simulate(cell: OrbitCell, setting: Setting) -> list[OrbitPoint]:
    """The points at the values of a cell."""
    options = setting.options
    name, surface, way = options["over"], options["on"], cell["way"]
    values = values_of(options)
    if way == "down":
        values = values[::-1]
    wheels = [wheel_of({**options, name: value}) for value in values.tolist()]
    state = _begin(setting, way)
    for wheel in wheels[: cell["first"]]:
        seconds = APPROACH_SWINGS * swing_s(wheel)
        state = crossings(state + DISTURBANCE, wheel.columns(1), seconds, most=0).ended
    own = slice(cell["first"], cell["first"] + BAND)
    settled = []
    for wheel in wheels[own]:
        settled.append(_settle(wheel, state + DISTURBANCE, surface))
        state = settled[-1].ended[:, None]
    motions = settle_longer(wheels[own], settled, surface, FINENESS)
    return [
        {
            **motion,
            "value": value,
            "number": number,
            "section_x2": x2,
            "section_phi": phi,
            "section_omega": omega,
        }
        for value, one, motion in zip(values[own].tolist(), settled, motions, strict=True)
        for number, (x2, phi, omega) in enumerate(_points(one, motion))
    ]


def _begin(setting: Setting, way: Way) -> Array:
    """The state, (4, 1), in which a way begins: a random one."""
    return random_starts(1, np.random.default_rng(setting.seed_of({"way": way})))


def _settle(wheel: Wheel, state: Array, surface: Surface) -> Settled:
    """The wheel when it repeats itself, or after all looks."""
    seconds = SWINGS * swing_s(wheel)
    for _ in range(LOOKS):
        (found,) = follow_wheels([wheel], state, seconds, surface, FINENESS)
        if found.motion is not None:
            break
        state = found.ended[:, None]
    return found


def _points(settled: Settled, motion: MotionColumns) -> list[Any]:
    """(x2, phi, omega) of a period, or of the last crossings; one without numbers for none."""
    points = settled.points.states[-(motion["period"] or MOST) :, 1:].tolist()
    return points if points and motion["kind"] != KINDS[REST] else [(None, None, None)]
