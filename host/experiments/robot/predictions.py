"""How well predictions of kicks come true (host.kicking.prediction).

Each cell is a kick at random: its mode, its length and strength, and the phase at which it meets
the wheels. The prediction gives the share of simulated wheels that reverse. It is calibrated if,
of all wheels with a predicted share of 70 %, 70 % reverse. A forecast of always the same share can
be calibrated too; so predictions are compared with that by their Brier score, the mean squared
difference between the predicted share and what happened (1 or 0). 0 is perfect.

A person's click reaches the robot a few ticks after the records that the person saw. So a
prediction gets the records up to 1, 2 or 3 ticks before the kick began, at random, and none that
are newer.
"""

from __future__ import annotations

from math import pi
from typing import Any, Literal, TypedDict, cast

import numpy as np

from host.client.robot import Robot
from host.kicking.kick_map import LENGTHS
from host.kicking.outcome import REVERSES, kick_and_watch, wait_settled
from host.kicking.prediction import DELAYS, predict
from host.kicking.robot_motor import motor_of
from host.logs.log import Log
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fraction, wilson
from robot.kicks import FROZEN_MODES, JUMP, MAX_JUMP, MODES, PHASE, PULSE, SMOOTH, WAVEFORM, WHEELS

simulate = None

TURN_S = 0.5
# Ranges of what is pulsed: they hold the default value, and go far beyond it.
PULSES = {
    "a": (0.1, 20.0),
    "tau_s": (0.1, 2.0),
    "k": (0.0, 30.0),
    "beta": (0.0, 1.0),
    "shift_rad": (-pi, pi),
}
# Predicted shares up to these fall into one bin of the reliability diagram. Certain ones have bins
# of their own.
EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 0.999, 1.0)

Wheel = Literal["left", "right"]


class Cell(TypedDict):
    """A kick.

    Attributes:
        kick: number of the kick, from 0.
    """

    kick: int


class Trial(TypedDict):
    """One wheel that was kicked.

    Attributes:
        mode: the kick's mode.
        ticks: its length.
        what: the parameter or variable that a pulse or a jump changes, else empty.
        value: its height, or the shift of a phase kick (rad); None if the mode says all.
        smooth: whether a pulse is sin^2 shaped.
        wheel: which wheel.
        delay: how many ticks after the newest record that the prediction got the kick began.
        before: the wheel's heading before the kick.
        result: what it did: reverses, continues or stops.
        settled: whether both wheels had settled when that was judged.
        reverses: how many simulated wheels reversed.
        stops: how many stopped.
        of: how many there were.
    """

    mode: str
    ticks: int
    what: str
    value: float | None
    smooth: bool
    wheel: Wheel
    delay: int
    before: str
    result: str
    settled: bool
    reverses: int
    stops: int
    of: int


class Row(Cell, Trial):
    """A wheel with the number of its kick."""


class Bin(TypedDict):
    """Wheels with about the same predicted share.

    Attributes:
        wheels: how many.
        predicted: the mean of the predicted shares.
        reversed: how many reversed.
        interval: the 95 % interval of the share that reverses, [low, high].
        fits: whether the predicted share lies in it, but for half a simulated wheel.
    """

    wheels: int
    predicted: float
    reversed: int
    interval: list[float]
    fits: bool


class Score(TypedDict):
    """Predictions of kicks of one mode, or of all.

    Attributes:
        wheels: how many.
        reversed: the share that reversed.
        brier: the Brier score of the predictions.
        always: that of the forecast that every kick reverses.
        same: that of the best forecast that is the same for all of these kicks: the share that
            reversed.
    """

    wheels: int
    reversed: float
    brier: float
    always: float
    same: float


class Numbers(TypedDict):
    """What was found.

    Attributes:
        in_words: the scores and the calibration in lines for people.
        kicks: how many kicks.
        expected: how many reversals the predictions add up to.
        reversed: how many there were.
        spread: the standard deviation of that number if the predictions are right.
        bins: the reliability diagram.
        scores: of each mode, and of `all`.
    """

    in_words: str
    kicks: int
    expected: float
    reversed: int
    spread: float
    bins: list[Bin]
    scores: dict[str, Score]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """One cell for each kick."""
    return [{"kick": number} for number in range(options["kicks"])]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def random_kick(number: int, rng: np.random.Generator) -> dict[str, Any]:
    """A kick, as robot.kick_requests.parse takes it. Modes take turns; the rest is by chance."""
    mode = MODES[number % len(MODES)]
    kick: dict[str, Any] = {"mode": mode}
    if mode == WAVEFORM:
        kick["param"] = str(rng.choice(list(PULSES)))
        values = rng.uniform(*PULSES[kick["param"]], int(rng.choice(LENGTHS)))
        kick["waveform"] = values.tolist()
    elif mode not in FROZEN_MODES:
        kick["ticks"] = int(rng.choice(LENGTHS))
        if rng.random() < 0.25:
            kick["shape"] = SMOOTH
    if mode == PHASE and rng.random() < 0.5:  # else its sign is that which reverses a wheel
        kick["shift"] = float(rng.uniform(-pi, pi))
    if mode == PULSE:
        kick["param"] = str(rng.choice(list(PULSES)))
        kick["value"] = float(rng.uniform(*PULSES[kick["param"]]))
    if mode == JUMP:
        kick["variable"] = str(rng.choice(["x1", "x2"]))
        kick["delta"] = float(rng.uniform(-MAX_JUMP, MAX_JUMP))
    return kick


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Trial]:
    """Kick both wheels of a robot that has settled, and predict that from records of before."""
    rng = np.random.default_rng(setting.seed_of(cell))
    kick = random_kick(cell["kick"], rng)
    wait_settled(robot)
    robot.wait(float(rng.uniform(0.0, TURN_S)))
    status = robot.status()
    outcome = kick_and_watch(robot, log, **kick)
    delay = int(rng.choice(DELAYS))
    found = predict(
        [record for record in robot.recent() if record.tick <= outcome.applied_tick - delay],
        status["params"],
        kick,
        motor_of(robot),
        status["battery_v"],
        seed=int(rng.integers(2**32)),
    )
    value = next((kick[name] for name in ("shift", "value", "delta") if name in kick), None)
    return [
        {
            "mode": outcome.mode,
            "ticks": outcome.ticks,
            "what": kick.get("param", kick.get("variable", "")),
            "value": value,
            "smooth": "shape" in kick,
            "wheel": cast("Wheel", side),
            "delay": delay,
            "before": outcome.before[side],
            "result": outcome.results[side],
            "settled": outcome.settling_s is not None,
            "reverses": found.shares[side]["reverses"],
            "stops": found.shares[side]["stops"],
            "of": found.of,
        }
        for side in WHEELS
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """The scores and the reliability diagram. The paper makes no claim about predictions."""
    modes = [mode for mode in MODES if any(row["mode"] == mode for row in rows)]
    scores = {mode: score([row for row in rows if row["mode"] == mode]) for mode in modes}
    shares = [row["reverses"] / row["of"] for row in rows]
    numbers: Numbers = {
        "in_words": "",
        "kicks": len({row["kick"] for row in rows}),
        "expected": sum(shares),
        "reversed": sum(row["result"] == REVERSES for row in rows),
        "spread": sum(share * (1 - share) for share in shares) ** 0.5,
        "bins": bins(rows),
        "scores": {"all": score(rows), **scores},
    }
    numbers["in_words"] = in_words(numbers)
    return Findings([], numbers)


def score(rows: list[Row]) -> Score:
    """The Brier scores of some predictions, and of forecasts that know less."""
    happened = np.array([row["result"] == REVERSES for row in rows], dtype=float)
    predicted = np.array([row["reverses"] / row["of"] for row in rows])
    share = fraction(happened.sum(), len(rows))
    return {
        "wheels": len(rows),
        "reversed": float(share),
        "brier": float(np.mean((predicted - happened) ** 2)),
        "always": 1.0 - float(share),
        "same": float(share * (1.0 - share)),
    }


def bins(rows: list[Row]) -> list[Bin]:
    """The reliability diagram: what wheels did whose predicted shares are about the same."""
    found: list[Bin] = []
    low = -1.0
    for high in EDGES:
        some = [row for row in rows if low < row["reverses"] / row["of"] <= high]
        low = high
        if not some:
            continue
        predicted = sum(row["reverses"] / row["of"] for row in some) / len(some)
        done = sum(row["result"] == REVERSES for row in some)
        least, most = wilson(done, len(some))
        half = 0.5 / some[0]["of"]
        found.append(
            {
                "wheels": len(some),
                "predicted": predicted,
                "reversed": done,
                "interval": [least, most],
                "fits": least - half <= predicted <= most + half,
            }
        )
    return found


def in_words(numbers: Numbers) -> str:
    """The numbers in lines for people."""
    wheels = f"{numbers['expected']:.0f} +- {numbers['spread']:.0f}"
    lines = [
        f"{numbers['kicks']} kicks: {numbers['reversed']} wheels reversed, predicted were {wheels}",
        "Brier score (0 is perfect): of the prediction; of 'always reverses'; of the share of all",
    ]
    lines += [
        f"  {name}: {one['brier']:.3f}; {one['always']:.3f}; {one['same']:.3f}"
        for name, one in numbers["scores"].items()
    ]
    fitting = sum(one["fits"] for one in numbers["bins"])
    lines.append(
        f"in {fitting} of {len(numbers['bins'])} groups of like predictions the predicted share"
        " lies in the 95 % interval of what happened"
    )
    return "\n".join(lines)
