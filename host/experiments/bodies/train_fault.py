"""Whether a train with a wheel that is weaker than the others, or dead, or one with wheels of different size, still goes one way."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from host.experiments.bodies.stage import pushed_off, ran
from host.runs.contract import Cell, Findings, Options, Row, Setting
from sim_motor.bodies.presets import preset

if TYPE_CHECKING:
    import mujoco

# Which wheel is weak while its k is varied, and by how much (%); and which is dead, one at a time.
WEAK = "car2_left"
WEAKER = (0, -10, -20, -30, -40, -50, -60, -70, -80, -90, -100)
DEAD = ("car0_left", "car1_left", "car3_left", "car4_left")
# By how much (%) radii differ, evenly distributed.
SIZES = 5.0
EVERY_S, LATE = 0.1, 0.5


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A train each, that is pushed off.

    Its chance is a slight bend at the start, and its wheels' radii.
    """
    numbers = range(options["seeds"])
    weak = [
        {"part": "weaker", "wheel": WEAK, "percent": percent, "number": number}
        for percent in WEAKER
        for number in numbers
    ]
    dead = [
        {"part": "dead", "wheel": wheel, "percent": -100, "number": number}
        for wheel in DEAD
        for number in numbers
    ]
    return (
        weak
        + dead
        + [
            {"part": "sizes", "wheel": None, "percent": SIZES, "number": number}
            for number in numbers
        ]
    )


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The run's second half in a row.

    Order parameter, speed, turning (left > 0), and omega of the faulty wheel and of all.

    Of each first also its head's way, every EVERY_S.
    """
    seconds, own = setting.options["seconds"], preset(setting.options["preset"])
    seed = setting.seed_of({"number": cell["number"]})  # the same start whatever the fault
    radii = np.ones(10)
    if cell["part"] == "sizes":
        radii += np.random.default_rng(seed).uniform(-SIZES / 100, SIZES / 100, len(radii))
    body = pushed_off(own, seed=seed, prepare=sized(radii))
    body.neurons.radius_m[:] *= radii
    if cell["wheel"] is not None:
        body.neurons.k[body.wheels.index(cell["wheel"])] *= 1 + cell["percent"] / 100
    did = ran(body, seconds)
    late, t = did.last(LATE * seconds), did.moved.t_s
    heading = np.unwrap(did.head[late, 2])
    way = np.hypot(*np.diff(did.moved.centre_m[late, :2], axis=0).T).sum()
    omega = did.moved.omega[late]
    rows: list[Row] = [
        {
            "order": float(did.order[late].mean()),
            "speed_m_s": float(way / (t[late][-1] - t[late][0])),
            "turning_rad_s": float((heading[-1] - heading[0]) / (t[late][-1] - t[late][0])),
            "omega_rad_s": float(np.abs(omega).mean()),
            "own_rad_s": (
                None
                if cell["wheel"] is None
                else float(np.abs(omega[:, body.wheels.index(cell["wheel"])]).mean())
            ),
        }
    ]
    if cell["number"] == 0:
        rows += [
            {"t_s": float(t[at]), "x_m": float(did.head[at, 0]), "y_m": float(did.head[at, 1])}
            for at in did.every(EVERY_S)
        ]
    return rows


def sized(factors: Any) -> Callable[[mujoco.MjSpec], None]:
    """For `prepare`: each wheel's radius, in the order of a Body's wheels, is its preset's times one of these."""

    def prepare(spec: mujoco.MjSpec) -> None:
        wheels = [
            f"car{car}_{side}_wheel"
            for car in range(len(factors) // 2)
            for side in ("left", "right")
        ]
        for name, factor in zip(wheels, factors, strict=True):
            spec.geom(name).size[0] *= factor

    return prepare


def report(rows: list[Row], setting: Setting) -> Findings:
    """Means over the runs of each fault; no claim of the paper."""
    runs = [row for row in rows if "order" in row]
    kinds = dict.fromkeys((row["part"], row["wheel"], row["percent"]) for row in runs)
    return Findings(
        [],
        {
            "faults": [
                _kind([row for row in runs if (row["part"], row["wheel"], row["percent"]) == kind])
                for kind in kinds
            ]
        },
    )


def _kind(own: list[Row]) -> dict[str, Any]:
    def mean(name: str) -> float:
        return float(np.mean([row[name] for row in own]))

    first = own[0]
    return {
        **{name: first[name] for name in ("part", "wheel", "percent")},
        "runs": len(own),
        "order": mean("order"),
        "lowest_order": min(row["order"] for row in own),
        "speed_m_s": mean("speed_m_s"),
        "turning_rad_s": [row["turning_rad_s"] for row in own],
        "own_of_all": (
            None if first["wheel"] is None else mean("own_rad_s") / max(mean("omega_rad_s"), 1e-9)
        ),
    }
