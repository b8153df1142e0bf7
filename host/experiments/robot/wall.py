"""A robot at k = 2 runs against a wall and turns back by itself, or does not (R13).

No sensor and no kick tells it of the wall.

A trial sets both wheels going forward at once and watches them. What came of it is read from the
log alone: the wall is where the wheels slow down, and a bounce is where the torque M of both wheels
has changed its sign, and both run the other way, for good.

A floor without grip cannot stop the wheels: they turn on. A wheel that is stopped obeys the rods
alone, which draw it to the next of four angles: forward or backward, as its phase wills. If it is
drawn forward, it presses against the wall until the wall's spring, or the other wheel, throws it
over that point; or it rests there. If one wheel goes before the other, the robot turns on the spot.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from math import ceil, pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.client.robot import Robot
from host.experiments.robot import unattended
from host.kicking.outcome import FORWARD
from host.kicking.primitives import SHIFT_TOWARD
from host.kicking.robot_claims import WHEEL_RADIUS_M
from host.logs.log import Log
from host.logs.motion import directions, travels
from host.runs.claims import Claim, too_few
from host.runs.contract import Cell, Findings, Options, Row, Setting
from host.util.intervals import fraction, wilson
from robot.kicks import DIRECTION_TICKS, PHASE, WHEELS
from robot.loop import Loop
from sim_motor.brick import SimBrick
from sim_motor.motor import GRAVITY, data
from sim_motor.world import Scene

Array = NDArray[Any]

ROBOT = {name: float(entry[0]) for name, entry in data()["robot"].items()}
CARPET, SMOOTH = ROBOT["grip_on_carpet"], ROBOT["grip"]
WIDE_M, SPRINGY = 0.4, 1000.0
# The paper's: on a rough surface, with wheels in phase, as the start of the robot's program leaves
# them.
PAPER: Cell = {
    "k": 2.0,
    "grip": CARPET,
    "stiffness": ROBOT["wall_stiffness"],
    "bumper": ROBOT["body_width"],
    "apart": 0.0,
}
ON_SMOOTH, WITH_BUMPER = (
    {**PAPER, "grip": SMOOTH},
    {**PAPER, "bumper": WIDE_M, "stiffness": SPRINGY},
)
KS, GRIPS = (1.5, 2.0, 2.5, 3.0, 4.0), (0.7, 1.0, 1.34, 1.7, 2.0, 2.5)
STIFFNESSES, BUMPERS = (500.0, 1000.0, 2000.0, 20000.0, 100000.0), (0.1, 0.16, 0.2, 0.3, 0.4)
APARTS = (0.0, 0.2, 0.4, 0.8, 1.6, 2.4, 3.14)
MAP_HITS = 12

# So far apart at least are the walls; and a turn of the wheels farther, that all phases come to
# them.
NEAREST_M, TURN_M = 1.2, 2 * pi * WHEEL_RADIUS_M
REST_S, SETTLE_S, WATCH_S, LOOK_S, SERIES_S = 1.5, 0.5, 8.0, 0.6, 40.0
MEAN_S, LASTS_S = 0.5, 0.6
SLOWED = 0.85
# What part of how many hits the paper has to bounce.
TARGET, BOUNCES = 0.95, 50

BOUNCED, NO_WALL = "bounced", "met no wall"
SPUN, TURNED, ROUNDED, RESTED, UNSURE = (
    "tyres spin",
    "turns on the spot",
    "turns around one wheel",
    "rests at the wall",
    "undecided",
)


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """A cell is a condition with all its hits for the simulation, and one hit on a robot, whose floor and body are as they are."""
    hits = options["bounces"]
    if not batch:
        return [{"k": PAPER["k"], "hit": hit} for hit in range(hits)]
    claimed = [PAPER, ON_SMOOTH, WITH_BUMPER]
    mapped = [{**PAPER, "grip": grip, "k": k} for grip in GRIPS for k in KS]
    mapped += [
        {**PAPER, "stiffness": stiffness, "bumper": bumper}
        for stiffness in STIFFNESSES
        for bumper in BUMPERS
    ]
    mapped += [{**PAPER, "apart": apart} for apart in APARTS]
    once = {
        tuple(condition.values()): condition for condition in mapped if condition not in claimed
    }
    shown: list[Cell] = [{"part": "series", **condition} for condition in (PAPER, WITH_BUMPER)]
    return (
        [{"part": "claim", **condition, "hits": hits} for condition in claimed]
        + [{"part": "map", **condition, "hits": MAP_HITS} for condition in once.values()]
        + shown
    )


def world(cell: Cell) -> dict[str, str]:
    """Walls, farther apart for each hit. To a real robot.

    A wall ahead that it meets squarely, half a metre away or more.
    """
    walls = NEAREST_M + 2 * TURN_M * cell.get("hit", 0) / cell.get("hits", 1)
    scene = {
        str(name): str(cell[name])
        for name in ("grip", "stiffness", "bumper", "apart")
        if name in cell
    }
    return {"walls": f"{walls:.4f}", **scene}


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """Each hit of a robot of its own, in the robot's whole loop."""
    if cell["part"] == "series":
        return _series(*_watched(_run_into_wall(cell, setting, stop=False)))
    hits = [{**cell, "hit": hit} for hit in range(cell["hits"])]
    return [{"hit": hit["hit"], **told(*_watched(_run_into_wall(hit, setting)))} for hit in hits]


def _run_into_wall(cell: Cell, setting: Setting, *, stop: bool = True) -> Log:
    """The log of a simulated robot that is sent off, until it has bounced.

    Or, if it is not to stop there, of SERIES_S.
    """
    seed = setting.seed_of(cell)
    scene = Scene(**{name: float(value) for name, value in world(cell).items()})
    brick = SimBrick(seed, motor=setting.motor, battery_v=setting.battery_v, scene=scene)
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    log = Log()

    def run(seconds: float) -> None:
        log.take_records(unattended.run(loop, ceil(seconds / loop.params.tick_s)))

    loop.set_params({"k": 0.0})
    loop.start()
    run(REST_S)
    log.records.clear()
    loop.set_params({"k": cell["k"]})
    loop.kick({"id": "off", "mode": PHASE, "shift": SHIFT_TOWARD[FORWARD]})
    if not stop:
        run(SERIES_S)
        return log
    while log.seconds < WATCH_S and not bounces(*_watched(log)):
        run(LOOK_S)
    return log


def _series(t: Array, phi: Array, torque: Array) -> list[Row]:
    """Every tick, and whether the robot had bounced by then."""
    turned = set(bounces(t, phi, torque))
    rows = zip((t - t[0]).tolist(), torque.tolist(), strict=True)
    return [
        {"t_s": t_s, "left_torque": left, "right_torque": right, "bounce": tick in turned}
        for tick, (t_s, (left, right)) in enumerate(rows)
    ]


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
    """One hit of a robot that is there.

    It is let rest for REST_S first, in which its user may face it to the wall.
    """
    robot.set(k=0.0)
    robot.wait(REST_S)
    robot.set(k=cell["k"])
    begin = robot.kick(PHASE, shift=SHIFT_TOWARD[FORWARD])
    robot.wait(
        WATCH_S,
        until=lambda: len(log) % DIRECTION_TICKS == 0 and bool(bounces(*_watched(log, begin))),
    )
    return [told(*_watched(log, begin))]


def _watched(log: Log, begin: int = 0) -> tuple[Array, Array, Array]:
    """Times, and angles and torques of both wheels, (ticks, 2), since a tick."""
    rows = log.column("tick") >= begin
    angles, torques = (
        np.stack([log.column(f"{side}_{name}") for side in WHEELS], axis=1)
        for name in ("phi_rad", "torque")
    )
    return log.column("t_s")[rows], angles[rows], torques[rows]


def _lasting(t: Array, phi: Array, torque: Array) -> list[tuple[int, int]]:
    """(first tick, 1 or -1) of each stretch of LASTS_S or more in which both wheels run, and are driven, one way."""
    both = np.concatenate([directions(phi), np.sign(torque)], axis=1)
    way = np.where((both == both[:, :1]).all(axis=1), both[:, 0], 0).astype(int)
    edges = [0, *(np.flatnonzero(np.diff(way)) + 1).tolist(), len(way)]
    return [
        (first, int(way[first]))
        for first, end in pairwise(edges)
        if way[first:end].any() and t[end - 1] - t[first] >= LASTS_S
    ]


def bounces(t: Array, phi: Array, torque: Array) -> list[int]:
    """The ticks from which on both wheels run the other way than before, for LASTS_S at least.

    t: (ticks,) in s; phi, torque: (ticks, 2) in rad and M of the left and the right wheel.
    """
    stretches = _lasting(t, phi, torque)
    return [first for (_, before), (first, after) in pairwise(stretches) if after == -before]


def told(t: Array, phi: Array, torque: Array) -> Row:
    """What these ticks (as for `bounces`) tell of one hit.

    ended: BOUNCED, or how else; before, after: mean M of both wheels in the last MEAN_S before the
    wall and in the end; took_s: from the wall to the bounce; apart_rad: how far the right wheel's
    phase was ahead at the wall. What there was not is None.
    """
    stretches, turned = _lasting(t, phi, torque), bounces(t, phi, torque)
    wall = _wall(t, phi, stretches[0][0]) if stretches else None
    row: Row = {
        "ended": NO_WALL,
        "reversed": False,
        "before": None,
        "after": None,
        "took_s": None,
        "apart_rad": None,
    }
    if wall is None:
        return row
    apart = float(phi[wall, 1] - phi[wall, 0])
    return {
        "ended": BOUNCED if turned else _stuck(directions(phi)[-1].tolist()),
        "reversed": bool(turned),
        "before": float(torque[(t < t[wall]) & (t >= t[wall] - MEAN_S)].mean()),
        "after": float(torque[t >= t[-1] - MEAN_S].mean()),
        "took_s": float(t[turned[0]] - t[wall]) if turned else None,
        "apart_rad": (apart + pi) % (2 * pi) - pi,
    }


def _wall(t: Array, phi: Array, first: int) -> int | None:
    """The last tick before a wheel, settled since tick `first`, is slowed down."""
    speed = np.abs(travels(phi))
    cruising = (t >= t[first] + SETTLE_S) & (t < t[first] + 2 * SETTLE_S)
    slowed = (
        (speed < SLOWED * np.median(speed[cruising], axis=0)).any(axis=1)
        if cruising.any()
        else np.zeros(len(t), dtype=bool)
    )
    late = np.flatnonzero(slowed & (t >= t[first] + SETTLE_S))
    return int(late[0]) - 1 if len(late) else None


def _stuck(ways: list[int]) -> str:
    """What a robot does that has not bounced, from the ways of its wheels."""
    left, right = ways
    if left == right:
        return {1: SPUN, 0: RESTED}.get(left, UNSURE)
    return TURNED if left == -right else ROUNDED


def of(rows: list[Row], condition: Cell) -> list[Row]:
    """The hits under a condition; a real robot's, which do not say theirs, count as the paper's."""
    hits = [row for row in rows if "hit" in row]
    return [
        row
        for row in hits
        if all(row.get(name, PAPER[name]) == value for name, value in condition.items())
    ]


def rate(rows: list[Row]) -> tuple[int, int]:
    """(bounces, hits)."""
    return sum(row["reversed"] for row in rows), len(rows)


def report(rows: list[Row], setting: Setting) -> Findings:
    """R13."""
    hits = of(rows, PAPER)
    done, tried = rate(hits)
    signs = [row["before"] * row["after"] < 0 for row in hits if row["reversed"]]
    share = fraction(done, tried)
    claim = Claim(
        "R13",
        "at k = 2 a robot that hits a wall reverses by itself, with no sensor for it",
        ">= 95 % of 50 bounces, M changes sign",
        share,
        "1",
        wilson(done, tried),
        share >= TARGET and all(signs),
        _note(rows, hits),
    )
    few = too_few(tried, BOUNCES, "hits")
    return Findings([claim.doubted(setting.elsewhere(), few)], _numbers(rows, hits))


def _note(rows: list[Row], hits: list[Row]) -> str:
    failed = Counter(row["ended"] for row in hits if not row["reversed"])
    notes = ["{} of {}".format(*rate(hits))]
    if failed:
        notes.append(
            "the others: " + ", ".join(f"{how} ({count})" for how, count in failed.most_common())
        )
    most = SMOOTH * ROBOT["mass"] / 2 * GRAVITY * ROBOT["wheel_radius"]
    for condition, words in (
        (
            WITH_BUMPER,
            (
                f"with a bumper {WIDE_M:g} m wide that gives way by {1000 / SPRINGY:g} mm to 1 N at"
                " each end:"
            ),
        ),
        (
            ON_SMOOTH,
            (
                f"on a smooth floor of grip {SMOOTH:g}, which holds a wheel with {most:.2f} N m"
                " only, so that it turns on at the wall:"
            ),
        ),
    ):
        done, tried = rate(of(rows, condition))
        if tried:
            notes.append(f"{words} {done} of {tried}")
    return "; ".join(notes)


def _numbers(rows: list[Row], hits: list[Row]) -> dict[str, Any]:
    bounced = [row for row in hits if row["reversed"]]

    def median(name: str) -> float | None:
        return float(np.median([row[name] for row in bounced])) if bounced else None

    grid = {
        "grip_and_k": [
            [[grip, k], *rate(of(rows, {**PAPER, "grip": grip, "k": k}))]
            for grip in GRIPS
            for k in KS
        ],
        "stiffness_and_bumper": [
            [
                [stiffness, bumper],
                *rate(of(rows, {**PAPER, "stiffness": stiffness, "bumper": bumper})),
            ]
            for stiffness in STIFFNESSES
            for bumper in BUMPERS
        ],
        "apart": [[apart, *rate(of(rows, {**PAPER, "apart": apart}))] for apart in APARTS],
    }
    return {
        "torque_before": median("before"),
        "torque_after": median("after"),
        "took_s": median("took_s"),
        "ended": dict(Counter(row["ended"] for row in hits)),
        "bounces_of_hits": grid,
    }
