"""Which start leads to which motion, and which kick, of which length, at which phase of rolling.

The continuous model and the sampled one.

Wheels start with the potentials that belong to rest where they are. Wheels that are kicked roll
forward.
"""

from __future__ import annotations

from collections import Counter
from itertools import groupby
from math import degrees, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis import outcomes
from host.theory.analysis.outcomes import (
    BACK,
    BACKWARD,
    FORWARD,
    OUTCOMES,
    QUARTER,
    REST,
    SETTLED,
    WATCHED,
    mirrored,
    started,
    watched,
)
from host.theory.engine.ensemble import FINE, rate_per_s
from host.theory.engine.kicked import KICKS, Continuous, Model, Sampled, memory_s
from host.theory.engine.sampled import Clock, as_robot, ticks_in
from host.theory.model.wheel import PHI, Array, Wheel, numpy_rates, wheel_of
from robot.kicks import FROZEN_MODES
from robot.params import Params

CLOCK = Clock(Params().tick_s)
CONTINUOUS, SAMPLED = "continuous", "sampled"
MODELS: dict[str, Model] = {CONTINUOUS: Continuous(), SAMPLED: Sampled(CLOCK)}
# The greatest omega that is tried, in parts of the speed that the springs can give.
FASTEST = 2.0
# Grid lines in a cell; wheels of a check, and those of them that another method follows, for how
# many of the wheel's memories.
BAND, CHECKED, FOLLOWED, FOLLOWED_FOR = 16, 400, 12, 4.0
PHASES = 180
# At the paper's constants it takes 2000 to see what becomes of a wheel, and a minute for all of
# them.
MOST_STEPS = 200_000
LENGTHS_S = {
    CONTINUOUS: [round(0.005 * number, 3) for number in range(81)],
    SAMPLED: [CLOCK.tick_s * ticks for ticks in range(13)],
}


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """Bands of the grid of starts, kinds of kicks, and a check, of either model.

    Raises WrongUse of wheels that take too long.
    """
    wheel = wheel_of(options)
    steps = memory_s(wheel) * (SETTLED + 2 * WATCHED) * float(rate_per_s(wheel.columns(1))[0])
    if not steps <= MOST_STEPS:
        raise WrongUse(
            f"to see what becomes of one such wheel takes {steps:.1e} steps: it is too stiff, or"
            " settles too slowly",
            "choose more friction f, another tau, or a moment of inertia I nearer to f tau",
        )
    found: list[Cell] = []
    for model in MODELS:
        found += [
            {"part": "starts", "model": model, "band": band}
            for band in range(0, options["points"], BAND)
        ]
        found += [
            {"part": "kicks", "model": model, "mode": mode, "sign": sign} for mode, sign in KICKS
        ]
        found.append({"part": "check", "model": model})
    return found


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """A row for each start or kick, or of a check."""
    wheel, model, points = (
        wheel_of(setting.options),
        MODELS[cell["model"]],
        setting.options["points"],
    )
    if cell["part"] == "starts":
        lines = omegas(wheel, points)[cell["band"] : cell["band"] + BAND]
        phi, omega = (grid.ravel() for grid in np.meshgrid(angles(points), lines))
        return _starts(model, wheel, phi, omega)
    if cell["part"] == "kicks":
        frozen = cell["mode"] in FROZEN_MODES
        return _kicks(
            model, wheel, cell["mode"], cell["sign"], [0.0] if frozen else LENGTHS_S[cell["model"]]
        )
    return [_check(model, wheel, points, np.random.default_rng(setting.seed_of(cell)))]


def angles(points: int) -> Array:
    """Where wheels start, (points,).

    The middles of as many equal parts of -pi to pi, lest any starts at a fixpoint.
    """
    return np.asarray((2 * np.arange(points) + 1 - points) * (pi / points))


def omegas(wheel: Wheel, points: int) -> Array:
    """How fast wheels start, (points,), in rad/s.

    In scale with the springs, or with the wheel's memory where there are none.
    """
    greatest = FASTEST * outcomes.free_speed(wheel) or pi / memory_s(wheel)
    return np.asarray((2 * np.arange(points) + 1 - points) * (greatest / points))


def _starts(model: Model, wheel: Wheel, phi: Array, omega: Array) -> list[Row]:
    """quarters: of a wheel that is bound in the end, the number of its well, in quarter turns from phi = 0, full turns counted.

    Without springs, or with a = 0, there are no wells, and a wheel rests anywhere.
    """
    pulled = wheel.k * wheel.a > 0.0
    names, then = watched(model, model.begun(started(phi, omega)), wheel)
    wells = np.rint(then.states[PHI] / QUARTER)
    return [
        {
            "phi": start,
            "omega": speed,
            "outcome": str(name),
            "quarters": int(well) if pulled and name in (REST, BACK) else None,
        }
        for start, speed, name, well in zip(phi.tolist(), omega.tolist(), names, wells, strict=True)
    ]


def _kicks(model: Model, wheel: Wheel, mode: str, sign: int, lengths_s: list[float]) -> list[Row]:
    """A row for each length and phase; none if no wheel rolls."""
    begun = outcomes.rolling(model, wheel, PHASES)
    if begun is None:
        return []
    phases = [degrees(phi) for phi in (begun[PHI] % QUARTER).tolist()]
    return [
        {"length_s": length_s, "phase_deg": phase, "outcome": str(outcome)}
        for length_s, line in zip(
            lengths_s, outcomes.after_kicks(model, wheel, begun, mode, sign, lengths_s), strict=True
        )
        for phase, outcome in zip(phases, line, strict=True)
    ]


def _check(model: Model, wheel: Wheel, points: int, rng: np.random.Generator) -> Row:
    """Of starts on the grid, the share that comes to the same by other means.

    turned, mirrored: of wheels a quarter turn ahead, and in a mirror. finer: with half the step,
    None of a model without steps. angle_off: by how much (rad) the first few, followed for a short
    time by another program, are elsewhere.
    """
    states = model.begun(
        started(rng.choice(angles(points), CHECKED), rng.choice(omegas(wheel, points), CHECKED))
    )
    names, _ = watched(model, states, wheel)
    turned = (
        states[[1, 0, *range(2, len(states))]]
        * np.array([-1.0, *[1.0] * (len(states) - 1)])[:, None]
    )
    turned[PHI] += QUARTER
    opposite = {FORWARD: BACKWARD, BACKWARD: FORWARD}
    mirror = watched(model, mirrored(states), wheel)[0]
    finer = (
        watched(Continuous(2 * FINE), states, wheel)[0] if isinstance(model, Continuous) else None
    )
    seconds, few = FOLLOWED_FOR * memory_s(wheel), states[:, :FOLLOWED]
    others = [_angle_by_another_method(model, state.tolist(), wheel, seconds) for state in few.T]
    return {
        "turned": _same(names, watched(model, turned, wheel)[0]),
        "mirrored": _same(names, np.array([opposite.get(str(name), str(name)) for name in mirror])),
        "finer": None if finer is None else _same(names, finer),
        "angle_off": float(
            np.max(
                np.abs(model.averages(few, wheel.columns(FOLLOWED), seconds).states[PHI] - others)
            )
        ),
    }


def _same(names: NDArray[np.str_], others: NDArray[np.str_]) -> float:
    return float(np.mean(names == others))


def _angle_by_another_method(
    model: Model, state: list[float], wheel: Wheel, seconds: float
) -> float:
    """The angle after some seconds by scipy's integrator, or by the robot's own wheel."""
    if isinstance(model, Sampled):
        return float(as_robot(state, wheel, model.clock, ticks_in(seconds, model.clock) + 1)[0, -1])
    solved = solve_ivp(
        lambda _, y: numpy_rates(*y, *wheel),
        (0.0, seconds),
        state,
        "DOP853",
        rtol=1e-11,
        atol=1e-11,
    )
    return float(solved.y[PHI, -1])


def report(rows: list[Row], setting: Setting) -> Findings:
    """No claim of the paper's: how large the basins are, which kicks reverse a wheel, and where the two models differ."""
    starts = {model: part_of(rows, "starts", model) for model in MODELS}
    kicks = [
        (mode, sign, {model: of_kick(rows, model, mode, sign) for model in MODELS})
        for mode, sign in KICKS
    ]
    unlike = [
        (one["outcome"], one["quarters"]) != (two["outcome"], two["quarters"])
        for one, two in zip(*starts.values(), strict=True)
    ]
    checks = {model: part_of(rows, "check", model)[0] for model in MODELS}
    numbers = {
        "tick_s": CLOCK.tick_s,
        "basins": {model: _basins(own) for model, own in starts.items()},
        "starts_that_end_otherwise_if_sampled": float(np.mean(unlike)),
        "kicks": [
            {"model": model, "mode": mode, "sign": sign, **_reversals(own[model])}
            for mode, sign, own in kicks
            for model in MODELS
            if own[model]
        ],
        "kicks_that_end_otherwise_if_sampled": [
            {"mode": mode, "sign": sign, "share": _unlike(own)}
            for mode, sign, own in kicks
            if all(own.values())
        ],
        "no_wheel_rolls": [model for model in MODELS if not kicks[0][2][model]],
        "accuracy": {
            "same_outcome": {
                model: {name: check[name] for name in ("turned", "mirrored", "finer")}
                for model, check in checks.items()
            },
            "angle_off_rad": {model: check["angle_off"] for model, check in checks.items()},
            "kick_length_s": LENGTHS_S[CONTINUOUS][1],
            "phases": PHASES,
        },
    }
    return Findings([], numbers)


def part_of(rows: list[Row], part: str, model: str) -> list[Row]:
    """The rows of a part of the study, of one model."""
    return [row for row in rows if row["part"] == part and row["model"] == model]


def of_kick(rows: list[Row], model: str, mode: str, sign: int) -> list[Row]:
    """The rows of a kind of kick, sorted by length and phase."""
    return [
        row for row in part_of(rows, "kicks", model) if (row["mode"], row["sign"]) == (mode, sign)
    ]


def reversals(kicks: list[Row]) -> dict[float, float]:
    """The share of phases at which a kick of each length (s) reverses a wheel."""
    lines = groupby(kicks, lambda row: float(row["length_s"]))
    return {
        length_s: float(np.mean([row["outcome"] == BACKWARD for row in line]))
        for length_s, line in lines
    }


def _basins(starts: list[Row]) -> dict[str, Any]:
    """shares: of outcomes. wells: of the wells of wheels that are bound. turned_around.

    Of those that roll, rolling against the start.
    """
    counts, wells = (Counter(row[name] for row in starts) for name in ("outcome", "quarters"))
    rolling_starts = [row for row in starts if row["outcome"] in (FORWARD, BACKWARD)]
    around = [(row["outcome"] == FORWARD) != (row["omega"] > 0.0) for row in rolling_starts]
    return {
        "shares": {outcome: counts[outcome] / len(starts) for outcome in OUTCOMES},
        "wells": {
            str(well): wells[well] / len(starts)
            for well in sorted(well for well in wells if well is not None)
        },
        "turned_around": float(np.mean(around)) if around else None,
    }


def _reversals(kicks: list[Row]) -> dict[str, Any]:
    """sure_s: the ranges of lengths, shortest and longest, at which a wheel is reversed whatever its phase."""
    shares = reversals(kicks)
    stretches = [
        [length_s for length_s, _ in line]
        for sure, line in groupby(shares.items(), lambda item: item[1] == 1.0)
        if sure
    ]
    return {
        "reversed": [{"length_s": length_s, "share": share} for length_s, share in shares.items()],
        "sure_s": [[stretch[0], stretch[-1]] for stretch in stretches],
    }


def _unlike(kicks: dict[str, list[Row]]) -> float:
    """The share of kicks of the sampled wheel that end otherwise than those of the continuous one of the next length and phase."""
    lines = {
        length_s: list(line)
        for length_s, line in groupby(kicks[CONTINUOUS], lambda row: float(row["length_s"]))
    }
    unlike = []
    for length_s, line in groupby(kicks[SAMPLED], lambda row: float(row["length_s"])):
        near = lines[min(lines, key=lambda other, of=length_s: abs(other - of))]  # type: ignore[misc]
        phases = np.array([row["phase_deg"] for row in near])
        for row in line:
            away = np.abs((phases - row["phase_deg"] + 45.0) % 90.0 - 45.0)
            unlike.append(near[int(np.argmin(away))]["outcome"] != row["outcome"])
    return float(np.mean(unlike))
