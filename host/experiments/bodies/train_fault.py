"""Does a train with a faulty wheel still go one way?

One wheel is weaker than the others, or dead; or the wheels have different sizes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import (
    Array,
    EditScene,
    Position,
    build_pushed_train,
    run_body,
)
from host.runs.contract import Findings, Options, Setting
from sim_motor.bodies.presets import preset

if TYPE_CHECKING:
    import mujoco

Part = Literal["weaker", "dead", "sizes"]

# One wheel's k is varied, by this many percent.
WEAK = "car2_left"
WEAKER = (0, -10, -20, -30, -40, -50, -60, -70, -80, -90, -100)
# One of these wheels is dead.
DEAD = ("car0_left", "car1_left", "car3_left", "car4_left")
# Radii differ by up to this many percent, evenly distributed.
SIZES = 5.0
# Positions are this far apart (s); a train is judged by this last part of its time.
EVERY_S, LATE = 0.1, 0.5


class Fault(TypedDict):
    """What is wrong with a train.

    Attributes:
        part: the kind of fault.
        wheel: the faulty wheel; None if all radii differ.
        percent: by how much its k differs, or by how much radii differ at most (%).
    """

    part: Part
    wheel: str | None
    percent: float


class Cell(Fault):
    """One train.

    Attributes:
        number: number of the random start (a slight bend) and of the wheels' random radii.
    """

    number: int


class Run(TypedDict):
    """The second half of a run.

    Attributes:
        order: mean order parameter (1).
        speed_m_s: speed along the path (m/s).
        turning_rad_s: how fast the train turns, to the left above 0 (rad/s).
        omega_rad_s: mean |omega| of all wheels (rad/s).
        own_rad_s: mean |omega| of the faulty wheel (rad/s); None if there is none.
    """

    order: float
    speed_m_s: float
    turning_rad_s: float
    omega_rad_s: float
    own_rad_s: float | None


@final
class RunRow(Cell, Run):
    """A line of the table about a whole run."""


@final
class PositionRow(Cell, Position):
    """A line of the table about where the train's head is at one time."""


Row = RunRow | PositionRow


class FaultNumbers(Fault):
    """All runs of trains with one fault.

    Means over them, or the value of each; see `Run`.

    Attributes:
        own_of_all: |omega| of the faulty wheel as a part of all wheels'.
    """

    runs: int
    order: float
    lowest_order: float
    speed_m_s: float
    turning_rad_s: list[float]
    own_of_all: float | None


class Numbers(TypedDict):
    """What the experiment found: an entry for each fault."""

    faults: list[FaultNumbers]


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one train, which starts with all wheels pushed forward."""
    faults: list[Fault] = []
    faults += [{"part": "weaker", "wheel": WEAK, "percent": percent} for percent in WEAKER]
    faults += [{"part": "dead", "wheel": wheel, "percent": -100} for wheel in DEAD]
    faults += [{"part": "sizes", "wheel": None, "percent": SIZES}]
    return [{**fault, "number": number} for fault in faults for number in range(options["seeds"])]


def simulate(cell: Cell, setting: Setting) -> list[Run | Position]:
    """The run, and for number 0 also the head's positions, every EVERY_S."""
    seconds, own = setting.options["seconds"], preset(setting.options["preset"])
    seed = setting.seed_of({"number": cell["number"]})  # the same start for all faults
    radii = np.ones(10)
    if cell["part"] == "sizes":
        radii += np.random.default_rng(seed).uniform(-SIZES / 100, SIZES / 100, len(radii))
    body = build_pushed_train(own, seed=seed, edit=scale_wheels(radii))
    body.neurons.radius_m[:] *= radii
    faulty = None if cell["wheel"] is None else body.wheels.index(cell["wheel"])
    if faulty is not None:
        body.neurons.k[faulty] *= 1 + cell["percent"] / 100
    run = run_body(body, seconds)
    late, t = run.last(LATE * seconds), run.course.t_s
    heading = np.unwrap(run.head[late, 2])
    path_m = np.hypot(*np.diff(run.course.centre_m[late, :2], axis=0).T).sum()
    omega, late_s = np.abs(run.course.omega[late]), t[late][-1] - t[late][0]
    rows: list[Run | Position] = [
        {
            "order": float(run.order[late].mean()),
            "speed_m_s": float(path_m / late_s),
            "turning_rad_s": float((heading[-1] - heading[0]) / late_s),
            "omega_rad_s": float(omega.mean()),
            "own_rad_s": None if faulty is None else float(omega[:, faulty].mean()),
        }
    ]
    if cell["number"] == 0:
        rows += run.positions(run.head, EVERY_S)
    return rows


def scale_wheels(factors: Sequence[float] | Array) -> EditScene:
    """For `edit`: multiply each wheel's radius by its factor, in the order of a Body's wheels."""

    def edit(spec: mujoco.MjSpec) -> None:
        wheels = [
            f"car{car}_{side}_wheel"
            for car in range(len(factors) // 2)
            for side in ("left", "right")
        ]
        for name, factor in zip(wheels, factors, strict=True):
            spec.geom(name).size[0] *= factor

    return edit


def whole_runs(rows: list[Row]) -> list[RunRow]:
    """The rows about whole runs."""
    return [row for row in rows if "order" in row]


def positions(rows: list[Row]) -> list[PositionRow]:
    """The rows about single moments."""
    return [row for row in rows if "t_s" in row]


def report(rows: list[Row], setting: Setting) -> Findings:
    """Means over the runs with each fault; no claim of the paper."""
    runs = whole_runs(rows)
    kinds = dict.fromkeys((row["part"], row["wheel"], row["percent"]) for row in runs)
    numbers: Numbers = {
        "faults": [
            _summarize_fault(
                {"part": part, "wheel": wheel, "percent": percent},
                [
                    row
                    for row in runs
                    if (row["part"], row["wheel"], row["percent"]) == (part, wheel, percent)
                ],
            )
            for part, wheel, percent in kinds
        ]
    }
    return Findings([], numbers)


def _summarize_fault(fault: Fault, runs: list[RunRow]) -> FaultNumbers:
    own = [row["own_rad_s"] for row in runs if row["own_rad_s"] is not None]
    omega = float(np.mean([row["omega_rad_s"] for row in runs]))
    return {
        **fault,
        "runs": len(runs),
        "order": float(np.mean([row["order"] for row in runs])),
        "lowest_order": min(row["order"] for row in runs),
        "speed_m_s": float(np.mean([row["speed_m_s"] for row in runs])),
        "turning_rad_s": [row["turning_rad_s"] for row in runs],
        "own_of_all": float(np.mean(own)) / max(omega, 1e-9) if own else None,
    }
