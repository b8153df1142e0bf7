"""The wiggling of a fast train on a flat floor.

How far does each joint yaw, how often, and how much later than the joint before it?

Beside it stands what the authors' program of 2019 did. A train that starts quite straight wiggles
late, and meanwhile gets faster than it can stay. So its highest speed is shown against how much its
joints were bent at the start.
"""

from __future__ import annotations

from typing import Literal, NotRequired, TypedDict, final

import numpy as np

from host.experiments.bodies.simulation import BENT, Array, build_pushed_train, run_body
from host.runs.contract import Findings, Options, Setting
from sim_motor.bodies.presets import preset

JOINTS = 4
# The authors' engine limits friction by a box. These are its limit along an axis, that of a circle
# of the same area, the mean of all directions, and the corners. The late speed depends on it.
FRICTIONS = (0.64, 0.722, 0.815, 0.905)
BENTS = (0.0, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1)
# The last seconds are shown, with angles this far apart (s).
SHOWN_S, EVERY_S = 1.5, 0.01
# A joint that yaws less (degrees) does not wiggle.
STILL_DEG = 0.1
# The lag of the authors' joints, from one to the next (degrees).
AUTHORS_LAG_DEG = (-150.0, -110.0)


Part = Literal["wiggle", "friction", "bent"]


class AuthorsRun(TypedDict):
    """What the authors' program did in 60 s.

    Attributes:
        std_deg: standard deviation of each yaw joint (degrees).
        hz: their frequency (Hz).
        peak_rad_s: highest and late speed of the wheels (rad/s).
        late_rad_s: highest and late speed of the wheels (rad/s).
    """

    std_deg: list[float]
    hz: float
    peak_rad_s: float
    late_rad_s: float


class Train(TypedDict):
    """One kind of train.

    Attributes:
        preset: name of the preset.
        drag: of wheels (N s/rad) for snake2019, of bodies (N s/m) for paper.
    """

    preset: str
    drag: float


class Cell(Train):
    """One train.

    Attributes:
        part: what it is run for.
        bent: how much its joints are bent at the start, as a standard deviation (rad).
        friction: of its tyres (1), for part 'friction' only; else the preset's.
    """

    part: Part
    bent: float
    friction: NotRequired[float]


class Speeds(TypedDict):
    """The wheels' mean speed.

    Attributes:
        peak_rad_s: its peak (rad/s).
        late_rad_s: its mean in the second half of the run (rad/s).
    """

    peak_rad_s: float
    late_rad_s: float


class Wiggle(TypedDict):
    """How one joint wiggles in the second half of the run.

    Attributes:
        joint: its number from the head, from 1 on.
        std_deg: standard deviation of its yaw (degrees).
        hz: frequency (Hz); None if the train does not wiggle.
        lag_deg: its phase minus that of the joint before (degrees, below 0 is later); None for
            the first.
    """

    joint: int
    std_deg: float
    hz: float | None
    lag_deg: float | None


class JointAngle(TypedDict):
    """One joint at one time.

    Attributes:
        joint: its number from the head, from 1 on.
        t_s: time since the start (s).
        deg: yaw (degrees).
    """

    joint: int
    t_s: float
    deg: float


@final
class SpeedsRow(Cell, Speeds):
    """A line of the table about a train's speeds."""


@final
class WiggleRow(Cell, Wiggle):
    """A line of the table about the wiggling of one joint."""


@final
class JointAngleRow(Cell, JointAngle):
    """A line of the table about one joint at one time."""


Row = SpeedsRow | WiggleRow | JointAngleRow


class TrainNumbers(Train, Speeds):
    """One train of part 'wiggle'.

    Attributes:
        std_deg: of each joint.
        lag_deg: of each but the first.
        hz: of the last.
        authors: what the authors' program did with this drag, or None.
    """

    std_deg: list[float]
    lag_deg: list[float | None]
    hz: float | None
    authors: AuthorsRun | None


class FrictionNumbers(TypedDict):
    """One train of part 'friction'.

    Attributes:
        hz: of the last joint.
        std_deg: of the last joint.
    """

    friction: float
    late_rad_s: float
    hz: float | None
    std_deg: float


class Numbers(TypedDict):
    """What the experiment found.

    Attributes:
        bent_rad_peak_late_rad_s: for each train of part 'bent', how much it is bent (rad), and
            its highest and late speed (rad/s).
    """

    trains: list[TrainNumbers]
    authors_lag_deg: list[float]
    bent_rad_peak_late_rad_s: list[list[float]]
    by_friction: list[FrictionNumbers]


# The authors' program of 2019, by its wheels' drag (N s/rad), run for this project. For the drag
# 0.01, in place of the highest speed, the one that is exceeded in a tenth of the time only.
AUTHORS: dict[float, AuthorsRun] = {
    0.002: {"std_deg": [6.9, 10.7, 16.3, 19.8], "hz": 3.80, "peak_rad_s": 49.2, "late_rad_s": 34.8},
    0.005: {"std_deg": [4.9, 7.4, 11.9, 15.0], "hz": 3.95, "peak_rad_s": 52.7, "late_rad_s": 38.4},
    0.01: {"std_deg": [4.4, 6.2, 8.9, 11.1], "hz": 4.10, "peak_rad_s": 38.6, "late_rad_s": 30.8},
}
# One train for each drag of the authors', and the paper's.
TRAINS: tuple[Train, ...] = (
    {"preset": "snake2019", "drag": 0.002},
    {"preset": "snake2019", "drag": 0.005},
    {"preset": "snake2019", "drag": 0.01},
    {"preset": "paper", "drag": 0.1},
)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """Each cell is one train.

    They start a little bent, for the wiggling; then the first of them with tyres of more and less
    friction, and more and less bent.
    """
    first, found = TRAINS[0], list[Cell]()
    found += [_cell("wiggle", train, BENT) for train in TRAINS]
    found += [{**_cell("friction", first, BENT), "friction": friction} for friction in FRICTIONS]
    found += [_cell("bent", first, bent) for bent in BENTS]
    return found


def _cell(part: Part, train: Train, bent: float) -> Cell:
    return {"part": part, "preset": train["preset"], "drag": train["drag"], "bent": bent}


def simulate(cell: Cell, setting: Setting) -> list[Speeds | Wiggle | JointAngle]:
    """The speeds, the wiggling of each joint, and the joints' angles in the last SHOWN_S."""
    seconds, own = setting.options["seconds"], preset(cell["preset"]).with_drag(cell["drag"])
    own = own._replace(friction=cell.get("friction", own.friction))
    run = run_body(build_pushed_train(own, seed=setting.seed, bent=cell["bent"]), seconds)
    speed, late = np.abs(run.course.omega.mean(axis=1)), run.last(seconds / 2)
    rows: list[Speeds | Wiggle | JointAngle] = [
        {"peak_rad_s": float(speed.max()), "late_rad_s": float(speed[late].mean())}
    ]
    if cell["part"] == "bent":
        return rows
    yaws = np.degrees(run.joints[:, : run.joints.shape[1] // 2])
    t, shown = run.course.t_s, run.last(SHOWN_S)
    rows += measure_wiggling(yaws[late], float(t[1] - t[0]))
    if cell["part"] == "friction":
        return rows
    rows += [
        {"joint": joint + 1, "t_s": float(t[at]), "deg": float(yaws[at, joint])}
        for joint in range(JOINTS)
        for at in run.every(EVERY_S)
        if shown[at]
    ]
    return rows


def measure_wiggling(yaws: Array, dt_s: float) -> list[Wiggle]:
    """Measure the wave along the joints.

    The frequency is the peak of the last joint's spectrum, as that joint swings the most.

    Args:
        yaws: (times, joints), in degrees.
        dt_s: time between rows (s).

    Returns:
        One entry for each joint.
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


def speeds(rows: list[Row]) -> list[SpeedsRow]:
    """The rows about speeds."""
    return [row for row in rows if "peak_rad_s" in row]


def wiggles(rows: list[Row]) -> list[WiggleRow]:
    """The rows about the wiggling of single joints."""
    return [row for row in rows if "std_deg" in row]


def joint_angles(rows: list[Row]) -> list[JointAngleRow]:
    """The rows about single joints at single times."""
    return [row for row in rows if "deg" in row]


def report(rows: list[Row], setting: Setting) -> Findings:
    """By drag, beside what the authors' program did; no claim of the paper."""
    numbers: Numbers = {
        "trains": [
            _summarize_train(train, [row for row in rows if row["part"] == "wiggle"])
            for train in TRAINS
        ],
        "authors_lag_deg": list(AUTHORS_LAG_DEG),
        "bent_rad_peak_late_rad_s": [
            [row["bent"], row["peak_rad_s"], row["late_rad_s"]]
            for row in speeds(rows)
            if row["part"] == "bent"
        ],
        "by_friction": [
            _summarize_friction(friction, [row for row in rows if row.get("friction") == friction])
            for friction in FRICTIONS
        ],
    }
    return Findings([], numbers)


def _summarize_train(train: Train, rows: list[Row]) -> TrainNumbers:
    rows = [row for row in rows if train.items() <= row.items()]
    (speed,), joints = speeds(rows), wiggles(rows)
    return {
        **train,
        "std_deg": [row["std_deg"] for row in joints],
        "lag_deg": [row["lag_deg"] for row in joints[1:]],
        "hz": joints[-1]["hz"],
        "peak_rad_s": speed["peak_rad_s"],
        "late_rad_s": speed["late_rad_s"],
        "authors": AUTHORS.get(train["drag"]) if train["preset"] == "snake2019" else None,
    }


def _summarize_friction(friction: float, rows: list[Row]) -> FrictionNumbers:
    (speed,), last = speeds(rows), wiggles(rows)[-1]
    return {
        "friction": friction,
        "late_rad_s": speed["late_rad_s"],
        "hz": last["hz"],
        "std_deg": last["std_deg"],
    }
