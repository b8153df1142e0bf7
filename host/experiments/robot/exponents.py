"""The largest Lyapunov exponent over k and tau: of the robot, and of the paper's model of a wheel.

The robot's is the growth rate of a small jump of x1 in pairs of robots that are the same otherwise,
both wheels on one body, over the first GROWTH_S after the jump. Where motion is regular, the rate
is 0 or less; twins whose potentials come nearer than LEAST count as that near. The model's is that
of its tangent vectors, as in `theory lyapunov-plane`.
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from host.errors import WrongUse
from host.experiments.robot.switching import OLDER, OLDER_S
from host.runs.contract import Findings, Options, Setting
from host.runs.robot_options import params_with
from host.theory.analysis.series_exponents import from_twins
from host.theory.model.wheel import Wheel
from host.theory.studies.lyapunov_pieces import from_both_starts
from host.theory.studies.lyapunov_rows import ANY
from robot.kick_requests import parse
from robot.kicks import JUMP
from sim_motor.batch import CHANNELS
from sim_motor.robots import run
from sim_motor.scene import Scene
from sim_motor.world import alone

KS = (1.0, 2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 15.0, 18.0, 20.0)
TAUS_S = (0.1, 0.25, 0.5, 0.75, 1.0, 1.5)
FRESH, MODEL = "robot", "model"
# Whose exponent, and for a robot how much older its rods are (s).
WHOSE = {FRESH: 0.0, f"robot, {OLDER}": OLDER_S, MODEL: None}
JUMP_S, JUMP_SIZE, GROWTH_S, LEAST = 30.0, 1e-3, 2.0, 1e-6
MODEL_WHEELS = 4
_POTENTIALS = [CHANNELS.index("x1"), CHANNELS.index("x2")]


class Cell(TypedDict):
    """Exponents at one time constant.

    Attributes:
        whose: one of WHOSE.
        tau_s: the neurons' time constant (s).
    """

    whose: str
    tau_s: float


class Rate(TypedDict):
    """The largest exponent at one k.

    Attributes:
        k: spring constant (1).
        exponent: growth rate (1/s).
        low: lower end of its 95 % interval (1/s); None for the model.
        high: upper end (1/s); None for the model.
    """

    k: float
    exponent: float
    low: float | None
    high: float | None


class Row(Cell, Rate):
    """A row of the table."""


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each time constant, for the robot, the robot with older rods, and the model."""
    if not batch:
        raise WrongUse(
            "exponents runs only on the simulated robot: it compares pairs that are exactly alike",
            "leave --brick out",
        )
    return [{"whose": whose, "tau_s": tau_s} for whose in WHOSE for tau_s in TAUS_S]


def simulate(cell: Cell, setting: Setting) -> list[Rate]:
    """The exponents for all k."""
    lag_s = WHOSE[cell["whose"]]
    if lag_s is None:
        return _of_model(cell["tau_s"], setting.seed_of(cell))
    return [_of_robot(k, cell, lag_s, setting) for k in KS]


def _of_robot(k: float, cell: Cell, lag_s: float, setting: Setting) -> Rate:
    params = params_with(k=k, tau_s=cell["tau_s"], rod_lag_s=lag_s)
    tick, after = round(JUMP_S / params.tick_s), round(GROWTH_S / params.tick_s)
    request = {"id": "jump", "mode": JUMP, "variable": "x1", "delta": JUMP_SIZE}
    rng = np.random.default_rng(setting.seed_of(cell))
    motors = setting.constants.specimens(2 * setting.options["pairs"], rng)
    plain, other = (
        run(
            setting.options["pairs"],
            tick + after + 1,
            setting.seed_of({**cell, "k": k}),
            Scene(),
            params=params,
            kick=kick,
            motors=[alone(motor) for motor in motors],
            battery_v=setting.battery_v,
        ).records[:, :, :, _POTENTIALS]
        for kick in (None, parse(request, (0, 0), params, tick))
    )
    # The first tick of the jump, and GROWTH_S later; both wheels of a pair together.
    apart = np.sqrt(((plain - other)[:, :, [tick, tick + after]] ** 2).sum(axis=(1, 3)))
    first, last = np.maximum(apart, LEAST).T
    rate = from_twins(first, last, GROWTH_S)
    low, high = rate.interval or (None, None)
    return {"k": k, "exponent": rate.rate, "low": low, "high": high}


def _of_model(tau_s: float, seed: int) -> list[Rate]:
    columns = Wheel(tau=tau_s).columns(len(KS), k=np.array(KS))
    found = from_both_starts(columns, MODEL_WHEELS, np.random.default_rng(seed))
    return [
        {
            "k": k,
            "exponent": float(
                np.mean([one["exponent"] for one in found if (one["k"], one["start"]) == (k, ANY)])
            ),
            "low": None,
            "high": None,
        }
        for k in KS
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """Where the exponents are above 0; a robot's with their interval. No claim of the paper."""
    chaotic = [
        {"whose": row["whose"], "tau_s": row["tau_s"], "k": row["k"], "exponent": row["exponent"]}
        for row in rows
        if (row["exponent"] > 0.05 if row["low"] is None else row["low"] > 0)
    ]
    return Findings([], {"chaotic": chaotic})
