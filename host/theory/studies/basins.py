"""The study `basins`: which start leads to which motion, and what kicks lead to.

Kicks come at any phase of rolling and have any length. Everything is computed with the continuous
model and with the sampled one. Wheels start with the potentials of rest at their angle; wheels that
are kicked roll forward.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import degrees, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.analysis.outcomes import (
    BACK,
    BACKWARD,
    FORWARD,
    QUARTER,
    REST,
    SETTLE,
    WINDOW,
    Outcome,
    acts_at_once,
    free_speed,
    mirror,
    outcomes_after_kicks,
    rolling_states,
    settle_and_classify,
    starting_states,
)
from host.theory.analysis.sure_kicks import sure_ranges
from host.theory.engine.ensemble import FINE, rate_per_s
from host.theory.engine.kicked import KICKS, Continuous, Model, Sampled, memory_s
from host.theory.engine.sampled import as_robot, ticks_in
from host.theory.model.laws import rates_of, require_friction
from host.theory.model.wheel import PHI, Array, Wheel, wheel_of
from host.theory.studies.basins_report import report
from host.theory.studies.basins_rows import (
    CLOCK,
    CONTINUOUS,
    LENGTHS_S,
    MODEL_NAMES,
    PHASES,
    SAMPLED,
    BasinsCell,
    Check,
    Kick,
    KicksCell,
    Measured,
    ModelName,
    Start,
    Sure,
)
from host.theory.studies.variants import require_two_rods

__all__ = ["cells", "report", "simulate"]

MODELS: dict[ModelName, Model] = {CONTINUOUS: Continuous(), SAMPLED: Sampled(CLOCK)}
# The greatest omega of a start, in units of the speed that the springs can give.
FASTEST = 2.0
# Grid lines in a cell.
BAND = 16
# Wheels of a check. Another program follows the first FOLLOWED of them for FOLLOWED_FOR memories.
CHECKED, FOLLOWED, FOLLOWED_FOR = 400, 12, 4.0
# With the paper's constants a wheel takes 2000 steps to settle, all of them together a minute.
MOST_STEPS = 200_000


def cells(options: dict[str, Any], *, batch: bool = True) -> list[BasinsCell]:
    """For each model: bands of the grid of starts, kinds of kicks, and a check.

    Raises WrongUse if wheels take too many steps to settle.
    """
    require_two_rods(options)
    require_settling(wheel_of(options))
    found: list[BasinsCell] = [
        {"part": "sure", "model": CONTINUOUS, "mode": mode, "sign": sign}
        for mode, sign in KICKS
        if not acts_at_once(mode)
    ]
    for model in MODEL_NAMES:
        bands = range(0, options["points"], BAND)
        found += [{"part": "starts", "model": model, "band": band} for band in bands]
        found += [
            {"part": "kicks", "model": model, "mode": mode, "sign": sign} for mode, sign in KICKS
        ]
        found.append({"part": "check", "model": model})
    return found


def require_settling(wheel: Wheel) -> None:
    """Raise WrongUse for a wheel that takes too many steps to settle."""
    require_friction(wheel)
    steps = memory_s(wheel) * (SETTLE + 2 * WINDOW) * float(rate_per_s(wheel.columns(1))[0])
    if not steps <= MOST_STEPS:
        raise WrongUse(
            f"a wheel with these constants takes {steps:.1e} steps to settle: it is too stiff, or"
            " settles too slowly",
            "choose more friction f, another tau, or a moment of inertia I nearer to f tau",
        )


def rolls(options: Mapping[str, Any]) -> bool:
    """Whether a wheel of either model rolls, so that it can be kicked; for options with cells."""
    wheel = wheel_of(options)
    return any(rolling_states(model, wheel, 1) is not None for model in MODELS.values())


def simulate(cell: BasinsCell, setting: Setting) -> Measured:
    """A row for each start, for each length and phase of a kick, or for a check."""
    wheel, points = wheel_of(setting.options), setting.options["points"]
    model = MODELS[cell["model"]]
    if cell["part"] == "starts":
        lines = omegas(wheel, points)[cell["band"] : cell["band"] + BAND]
        phi, omega = np.meshgrid(angles(points), lines)
        return simulate_starts(model, wheel, phi.ravel(), omega.ravel())
    if cell["part"] == "kicks":
        return _kicks(cell, wheel)
    if cell["part"] == "sure":
        lengths_s = LENGTHS_S[CONTINUOUS]
        ranges = sure_ranges(model, wheel, cell["mode"], cell["sign"], lengths_s, PHASES)
        found: list[Sure] = [{"from_s": from_s, "to_s": to_s} for from_s, to_s in ranges]
        return found
    return [_check(model, wheel, points, np.random.default_rng(setting.seed_of(cell)))]


def angles(points: int) -> Array:
    """The angles of starts, rad, (points,).

    The midpoints of equal parts of -pi to pi, so that none is a fixpoint.
    """
    return np.asarray((2 * np.arange(points) + 1 - points) * (pi / points))


def omegas(wheel: Wheel, points: int) -> Array:
    """The speeds of starts, rad/s, (points,).

    Scaled with the speed that the springs can give; without springs, with the wheel's memory.
    """
    greatest = FASTEST * free_speed(wheel) or pi / memory_s(wheel)
    return np.asarray((2 * np.arange(points) + 1 - points) * (greatest / points))


def simulate_starts(model: Model, wheel: Wheel, phi: Array, omega: Array) -> list[Start]:
    """What wheels come to from these angles (rad) and speeds (rad/s), (wheels,)."""
    has_wells = wheel.k * wheel.a > 0.0
    names, last = settle_and_classify(model, model.states_of(starting_states(phi, omega)), wheel)
    wells = np.rint(last.states[PHI] / QUARTER).tolist()
    columns = (phi.tolist(), omega.tolist(), names.tolist(), wells)
    return [
        {
            "phi": angle,
            "omega": speed,
            "outcome": outcome,
            "quarters": int(well) if has_wells and outcome in (REST, BACK) else None,
        }
        for angle, speed, outcome, well in zip(*columns, strict=True)
    ]


def _kicks(cell: KicksCell, wheel: Wheel) -> list[Kick]:
    """A row for each length and phase; none if the wheel does not roll."""
    model = MODELS[cell["model"]]
    lengths_s = [0.0] if acts_at_once(cell["mode"]) else LENGTHS_S[cell["model"]]
    states = rolling_states(model, wheel, PHASES)
    if states is None:
        return []
    found = outcomes_after_kicks(model, wheel, states, cell["mode"], cell["sign"], lengths_s)
    phases = [degrees(phi) for phi in (states[PHI] % QUARTER).tolist()]
    return [
        {"length_s": length_s, "phase_deg": phase, "outcome": outcome}
        for length_s, line in zip(lengths_s, found.tolist(), strict=True)
        for phase, outcome in zip(phases, line, strict=True)
    ]


def _check(model: Model, wheel: Wheel, points: int, rng: np.random.Generator) -> Check:
    """Random starts of the grid, by symmetry, with finer steps, and by another program."""
    phi, omega = rng.choice(angles(points), CHECKED), rng.choice(omegas(wheel, points), CHECKED)
    states = model.states_of(starting_states(phi, omega))
    names = _names(model, states, wheel)
    opposite: dict[Outcome, Outcome] = {FORWARD: BACKWARD, BACKWARD: FORWARD}
    in_mirror = _names(model, mirror(states), wheel).tolist()
    finer = None
    if isinstance(model, Continuous):
        finer = _same(names, _names(Continuous(2 * FINE), states, wheel))
    return {
        "turned": _same(names, _names(model, _turn(states), wheel)),
        "mirrored": _same(names, np.array([opposite.get(name, name) for name in in_mirror])),
        "finer": finer,
        "angle_off": _angle_off(model, states[:, :FOLLOWED], wheel),
    }


def _names(model: Model, states: Array, wheel: Wheel) -> NDArray[np.str_]:
    return settle_and_classify(model, states, wheel)[0]


def _turn(states: Array) -> Array:
    """The same wheels a quarter turn ahead."""
    x1, x2, *others = states
    found = np.array([-x2, x1, *others])
    found[PHI] += QUARTER
    return found


def _same(names: NDArray[np.str_], others: NDArray[np.str_]) -> float:
    return float(np.mean(names == others))


def _angle_off(model: Model, states: Array, wheel: Wheel) -> float:
    """The greatest difference (rad) of an angle to another program's after a short time."""
    seconds = FOLLOWED_FOR * memory_s(wheel)
    own = model.averages(states, wheel.columns(states.shape[1]), seconds).states[PHI]
    others = [_angle_elsewhere(model, state.tolist(), wheel, seconds) for state in states.T]
    return float(np.max(np.abs(own - others)))


def _angle_elsewhere(model: Model, state: list[float], wheel: Wheel, seconds: float) -> float:
    """The angle (rad) after some seconds, by scipy's integrator or by the robot's own wheel."""
    if isinstance(model, Sampled):
        ticks = ticks_in(seconds, model.clock) + 1
        return float(as_robot(state, wheel, model.clock, ticks)[0, -1])
    solved = solve_ivp(
        lambda _, y: rates_of(wheel)(*y, *wheel),
        (0.0, seconds),
        state,
        "DOP853",
        rtol=1e-11,
        atol=1e-11,
    )
    return float(solved.y[PHI, -1])
