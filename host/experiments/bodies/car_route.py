"""The route to locomotion of a car with one rod for each wheel.

Over k, for three kinds of neurons: rest, forth and back, rolling.

Beside it stands the speed at which the rod's mean torque over a turn balances drag, for small
potentials: omega* = sqrt(a k R tau / (4 f) - 1) / tau, where f is the drag on one wheel. It exists
only above k = 4 f / (a R tau).
"""

from __future__ import annotations

from collections import Counter
from math import sqrt
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from host.experiments.bodies.simulation import build_body, run_body
from host.runs.contract import Findings, Options, Setting
from sim_motor.bodies.presets import PUSHED, Preset, preset

# Gain and time constant (s) of the neurons: those of the presets, slower ones, and those of the
# paper's section 'Analytic modeling'.
NEURONS = ((2.0, 0.05), (2.0, 0.25), (4.0, 0.25))
KS = (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.8, 1.2)
# A motion is classified by the last seconds. A wheel that swings by less than SWING_RAD rests, and
# a car that leans by more than LEAN_RAD was thrown over.
LATE_S, SWING_RAD, LEAN_RAD = 3.0, 0.1, 1.0
REST = "rests"
SWING = "forth and back"
SPIN = "turns on the spot"
ROLL = "rolls"
LOST = "thrown over"
KINDS = (REST, SWING, SPIN, ROLL, LOST)


class Cell(TypedDict):
    """All starts of one car.

    Attributes:
        a: gain of its neurons (1).
        tau: their time constant (s).
        k: spring constant of its rods (N).
    """

    a: float
    tau: float
    k: float


class Start(TypedDict):
    """What came of one start.

    Attributes:
        number: 0 is pushed off, the others have random phases.
        kind: one of KINDS.
        omega_rad_s: mean |omega| of the wheels in the last LATE_S s (rad/s).
    """

    number: int
    kind: str
    omega_rad_s: float


class Row(Cell, Start):
    """One line of the table: the cell, and one of its starts."""


class Route(Cell):
    """All starts of one car.

    Attributes:
        kinds: how many starts ended in each kind of motion.
        rolling_rad_s: the speeds of those that roll.
        formula_rad_s: the formula's speed; None below its onset.
    """

    kinds: dict[str, int]
    rolling_rad_s: list[float]
    formula_rad_s: float | None


class Numbers(TypedDict):
    """What the experiment found.

    Attributes:
        route: an entry for each cell.
        largest_deviation_from_formula: of the rolling speeds, as a part of the formula's (1).
    """

    route: list[Route]
    largest_deviation_from_formula: float | None


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is all starts of a car with these neurons and this k."""
    return [{"a": a, "tau": tau, "k": k} for a, tau in NEURONS for k in KS]


def car_preset(cell: Cell) -> Preset:
    """The paper's car, with the cell's neurons and k."""
    return preset("paper")._replace(**cell)


def simulate(cell: Cell, setting: Setting) -> list[Start]:
    """Start the car several times: the first time pushed off, then at random phases."""
    starts: list[Start] = []
    for number in range(setting.options["seeds"]):
        phases = np.full(2, PUSHED) if number == 0 else None
        seed = setting.seed_of({"number": number})
        run = run_body(
            build_body(car_preset(cell), cars=1, seed=seed, phases=phases),
            setting.options["seconds"],
        )
        omega = run.course.omega[run.last(LATE_S)]
        if run.unstable_s is not None or float(run.course.lean_rad.max()) > LEAN_RAD:
            kind = LOST
        else:
            kind = classify_motion(omega, float(run.course.t_s[1]))
        starts.append(
            {"number": number, "kind": kind, "omega_rad_s": float(np.abs(omega).mean())},
        )
    return starts


def classify_motion(omega: NDArray[np.float64], dt_s: float) -> str:
    """Say what a car does, by the omega (rad/s) of its two wheels.

    Args:
        omega: (times, 2). The livelier wheel decides between rest and forth and back.
        dt_s: time between rows (s).
    """
    angles = np.cumsum(omega, axis=0) * dt_s
    swings = np.ptp(angles, axis=0)
    turns = swings > 2 * np.pi
    if turns.any():
        ways = np.sign(angles[-1]) * turns
        return ROLL if ways[0] == ways[1] else SPIN
    return SWING if (swings > SWING_RAD).any() else REST


def rolling_rad_s(own: Preset) -> float | None:
    """The formula's speed (rad/s), or None below its onset.

    A wheel bears half of the body's drag.
    """
    drag = own.body_drag * own.wheel_radius**2 / 2 + own.wheel_drag * own.wheel_radius
    surplus = own.a * own.k * own.wheel_radius * own.tau / (4 * drag) - 1.0
    return sqrt(surplus) / own.tau if surplus > 0.0 else None


def report(rows: list[Row], setting: Setting) -> Findings:
    """By neurons and k: what the starts came to, and their speed beside the formula's.

    No claim of the paper.
    """
    routes: list[Route] = []
    for cell in cells(setting.options, batch=True):
        starts = [row for row in rows if cell.items() <= row.items()]
        routes.append(
            {
                **cell,
                "kinds": dict(Counter(row["kind"] for row in starts)),
                "rolling_rad_s": [row["omega_rad_s"] for row in starts if row["kind"] == ROLL],
                "formula_rad_s": rolling_rad_s(car_preset(cell)),
            }
        )
    numbers: Numbers = {"route": routes, "largest_deviation_from_formula": _deviation(routes)}
    return Findings([], numbers)


def _deviation(routes: list[Route]) -> float | None:
    """How far rolling speeds deviate from the formula's, where k is over 8 times its onset.

    Nearer to the onset the potentials are not small.
    """
    deviations = [
        abs(speed / formula - 1.0)
        for route in routes
        for formula in [route["formula_rad_s"]]
        if formula is not None and formula * route["tau"] > sqrt(7.0)
        for speed in route["rolling_rad_s"]
    ]
    return max(deviations, default=None)
