"""The route to locomotion of a car with one rod for each wheel.

Rest, forth-and-back, rolling, over k, for some neurons.

Beside it the speed at which the mean of the rod's torque over a turn makes up for drag, where the
potential is small: omega* = sqrt(a k R tau / (4 f) - 1) / tau, with f the drag that a wheel bears.
It exists above k = 4 f / (a R tau) only.
"""

from __future__ import annotations

from collections import Counter
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.experiments.bodies.stage import made, ran
from host.runs.contract import Cell, Findings, Options, Row, Setting
from sim_motor.bodies.presets import PUSHED, Preset, preset

# Gain and time constant (s) of the neurons: the presets', slower ones, and the paper's of section
# 'Analytic modeling'.
NEURONS = ((2.0, 0.05), (2.0, 0.25), (4.0, 0.25))
KS = (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2)
LATE_S, SWING_RAD = 3.0, 0.1
REST, SWING, SPIN, ROLL, LOST = (
    "rests",
    "forth and back",
    "turns on the spot",
    "rolls",
    "thrown over",
)
KINDS = (REST, SWING, SPIN, ROLL, LOST)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """All starts of a car with these neurons and this k."""
    return [{"a": a, "tau": tau, "k": k} for a, tau in NEURONS for k in KS]


def car(cell: Cell) -> Preset:
    """The paper's, with the cell's neurons and k."""
    return preset("paper")._replace(**cell)


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """For each start, the first pushed off and the others at random phases.

    What the car does in the last LATE_S, and its mean |omega|.
    """
    rows: list[Row] = []
    for number in range(setting.options["seeds"]):
        phases = np.full(2, PUSHED) if number == 0 else None
        body = made(car(cell), cars=1, seed=setting.seed_of({"number": number}), phases=phases)
        did = ran(body, setting.options["seconds"])
        late = did.last(LATE_S)
        lost = did.broke_s is not None or float(did.moved.lean_rad.max()) > 1.0
        omega, dt_s = did.moved.omega[late], float(did.moved.t_s[1])
        rows.append(
            {
                "number": number,
                "kind": LOST if lost else kind_of(omega, dt_s),
                "omega_rad_s": float(np.abs(omega).mean()),
            }
        )
    return rows


def kind_of(omega: NDArray[np.float64], dt_s: float) -> str:
    """What two wheels do that turn at omega (rad/s), (times, 2), dt_s apart.

    The livelier one decides between rest and forth and back.
    """
    angles = np.cumsum(omega, axis=0) * dt_s
    if (np.ptp(angles, axis=0) > 2 * np.pi).any():
        ways = np.sign(angles[-1]) * (np.ptp(angles, axis=0) > 2 * np.pi)
        return ROLL if ways[0] == ways[1] else SPIN
    return SWING if (np.ptp(angles, axis=0) > SWING_RAD).any() else REST


def rolling_rad_s(own: Preset) -> float | None:
    """The formula's speed; None where there is none. A wheel bears half of the body's drag."""
    drag = own.body_drag * own.wheel_radius**2 / 2 + own.wheel_drag * own.wheel_radius
    surplus = own.a * own.k * own.wheel_radius * own.tau / (4 * drag) - 1.0
    return sqrt(surplus) / own.tau if surplus > 0.0 else None


def report(rows: list[Row], setting: Setting) -> Findings:
    """By neurons and k: how many starts came to what, and the speed of those that roll beside the formula's."""
    routes = []
    for cell in cells(setting.options, batch=True):
        own = [row for row in rows if all(row[name] == value for name, value in cell.items())]
        speeds = [row["omega_rad_s"] for row in own if row["kind"] == ROLL]
        formula = rolling_rad_s(car(cell))
        routes.append(
            {
                **cell,
                "kinds": dict(Counter(row["kind"] for row in own)),
                "rolling_rad_s": speeds,
                "formula_rad_s": formula,
            }
        )
    return Findings([], {"route": routes, "largest_deviation_from_formula": _deviation(routes)})


def _deviation(routes: list[dict[str, Any]]) -> float | None:
    """Of the rolling speed from the formula's, at k of more than 8 times its onset.

    Nearer to it the potentials are not small.
    """
    known = [
        (route["formula_rad_s"], route["rolling_rad_s"])
        for route in routes
        if (route["formula_rad_s"] or 0.0) * route["tau"] > sqrt(7.0)
    ]
    return max(
        (abs(speed / formula - 1.0) for formula, speeds in known for speed in speeds), default=None
    )
