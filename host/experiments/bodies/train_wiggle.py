"""The wiggling of a fast train on a flat floor.

How far each joint yaws, how often, and how much later than the one before it.

Beside it what the authors' program of 2019 did. A train that begins quite straight wiggles late,
and meanwhile gets faster than it can stay; so its highest speed is shown against how much its
joints were bent at the start.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.experiments.bodies.stage import BENT, pushed_off, ran
from host.runs.contract import Cell, Findings, Options, Row, Setting
from sim_motor.bodies.presets import preset

Array = NDArray[np.float64]

# What the authors' program of 2019 does in 60 s, by its wheels' drag (N s/rad): standard deviations
# of the yaw joints (degrees), their frequency (Hz), and of the wheels the highest and the late
# speed (rad/s). Run for this project; of the drag 0.01 the speed that is exceeded in a tenth of the
# time only, in place of the highest.
AUTHORS: dict[float, dict[str, Any]] = {
    0.002: {"std_deg": [6.9, 10.7, 16.3, 19.8], "hz": 3.80, "peak_rad_s": 49.2, "late_rad_s": 34.8},
    0.005: {"std_deg": [4.9, 7.4, 11.9, 15.0], "hz": 3.95, "peak_rad_s": 52.7, "late_rad_s": 38.4},
    0.01: {"std_deg": [4.4, 6.2, 8.9, 11.1], "hz": 4.10, "peak_rad_s": 38.6, "late_rad_s": 30.8},
}
# Their joints' lag, from one to the next (degrees).
AUTHORS_LAG_DEG = (-150.0, -110.0)
TRAINS: tuple[Cell, ...] = (
    *({"preset": "snake2019", "drag": drag} for drag in AUTHORS),
    {"preset": "paper", "drag": 0.1},
)
# Between what the authors' engine holds along an axis of its box of friction, the same area as a
# circle, the mean of all directions, and the box's corners: the late speed depends on it.
FRICTIONS = (0.64, 0.722, 0.815, 0.905)
BENTS = (0.0, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1)
SHOWN_S, EVERY_S = 1.5, 0.01
# A joint that yaws less (degrees) does not wiggle.
STILL_DEG = 0.1


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Trains that begin a little bent, for the wiggling.

    And one with tyres that hold more and less, and more and less bent.
    """
    wiggling: list[Cell] = [{"part": "wiggle", **train, "bent": BENT} for train in TRAINS]
    held: list[Cell] = [
        {"part": "friction", **TRAINS[0], "bent": BENT, "friction": friction}
        for friction in FRICTIONS
    ]
    return wiggling + held + [{"part": "bent", **TRAINS[0], "bent": bent} for bent in BENTS]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """The wheels' highest and late mean speed (late.

    The second half), the wiggling of each joint in it, and the joints in its end.
    """
    own = preset(cell["preset"]).with_drag(cell["drag"])
    own = own._replace(friction=cell.get("friction", own.friction))
    did = ran(pushed_off(own, seed=setting.seed, bent=cell["bent"]), setting.options["seconds"])
    speed, late = np.abs(did.moved.omega.mean(axis=1)), did.last(setting.options["seconds"] / 2)
    rows: list[Row] = [{"peak_rad_s": float(speed.max()), "late_rad_s": float(speed[late].mean())}]
    if cell["part"] == "bent":
        return rows
    yaws = np.degrees(did.joints[:, : did.joints.shape[1] // 2])
    t, shown = did.moved.t_s, did.last(SHOWN_S)
    rows += wiggling(yaws[late], float(t[1] - t[0]))
    if cell["part"] == "friction":
        return rows
    series = [
        {"joint": joint + 1, "t_s": float(t[at]), "deg": float(yaws[at, joint])}
        for joint in range(4)
        for at in did.every(EVERY_S)
        if shown[at]
    ]
    return rows + series


def wiggling(yaws: Array, dt_s: float) -> list[Row]:
    """Of each joint: its standard deviation, its frequency, and its phase less that of the joint before (degrees; below 0 is later).

    yaws: (times, joints), in degrees. The frequency is where the spectrum of the last joint, which
    swings the most, has its peak.
    """
    std = yaws.std(axis=0)
    window = np.hanning(len(yaws))[:, None]
    spectrum = np.fft.rfft((yaws - yaws.mean(axis=0)) * window, axis=0)
    peak = int(np.abs(spectrum[1:, -1]).argmax()) + 1
    hz = float(np.fft.rfftfreq(len(yaws), dt_s)[peak])
    wiggles = bool(std[-1] > STILL_DEG)
    lags = np.degrees(np.angle(spectrum[peak, 1:] * spectrum[peak, :-1].conj()))
    return [
        {
            "joint": joint + 1,
            "std_deg": float(value),
            "hz": hz if wiggles else None,
            "lag_deg": float(lags[joint - 1]) if joint and wiggles else None,
        }
        for joint, value in enumerate(std)
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """By drag, beside what the authors' program did; no claim of the paper."""
    trains = []
    for train in TRAINS:
        own = [
            row
            for row in rows
            if row["part"] == "wiggle" and all(row[name] == value for name, value in train.items())
        ]
        joints, (speeds,) = (
            [row for row in own if "std_deg" in row],
            [row for row in own if "peak_rad_s" in row],
        )
        theirs = AUTHORS.get(train["drag"]) if train["preset"] == "snake2019" else None
        trains.append(
            {
                **train,
                "std_deg": [row["std_deg"] for row in joints],
                "lag_deg": [row["lag_deg"] for row in joints[1:]],
                "hz": joints[-1]["hz"],
                "peak_rad_s": speeds["peak_rad_s"],
                "late_rad_s": speeds["late_rad_s"],
                "authors": theirs,
            }
        )
    held = []
    for friction in FRICTIONS:
        own = [row for row in rows if row.get("friction") == friction]
        (speeds,), joints = (
            [row for row in own if "peak_rad_s" in row],
            [row for row in own if "std_deg" in row],
        )
        held.append(
            {
                "friction": friction,
                "late_rad_s": speeds["late_rad_s"],
                "hz": joints[-1]["hz"],
                "std_deg": joints[-1]["std_deg"],
            }
        )
    bent = [
        [row["bent"], row["peak_rad_s"], row["late_rad_s"]] for row in rows if row["part"] == "bent"
    ]
    return Findings(
        [],
        {
            "trains": trains,
            "authors_lag_deg": list(AUTHORS_LAG_DEG),
            "bent_rad_peak_late_rad_s": bent,
            "by_friction": held,
        },
    )
