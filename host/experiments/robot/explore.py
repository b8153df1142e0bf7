"""How a robot covers a floor between walls: in chaos, straight on, with pauses, as a random walk.

The floor is a square, FLOOR_M from wall to wall, and the body is the same in all ways of moving. A
wall is a stiff, damped spring that pushes the corners of the body; wheels stand on long axles on a
carpet, where a wall reverses a robot with k = 2 (R13). Encoders dither by DITHER_DEG.

The area that the body's centre can reach is divided into square cells, as long as the body. A cell
is visited if the centre is in it at one of the times of the table, which are STEP_S apart.

- chaos: the mode `chaos`, k = 15 and tau = 1 s.
- straight: k = 2, started straight on. Only walls turn the robot.
- kicked: the same, with pulses k = 0 of PAUSE_S at random times, about every WALK_S. Each wheel
  then stops and starts anew either way. All robots are kicked at the same times.
- random walk: a point, no robot. It goes at the straight robot's speed, and turns to a random
  heading about every WALK_S and at the walls.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.experiments.robot.wall_rows import ON_AXLES, ROBOT
from host.kicking.modes import CHAOS, MODES, WALL_TURNER
from host.runs.contract import Findings, Options, Part, Setting
from host.runs.contract import Row as RunRow
from host.runs.robot_options import params_with
from host.util.intervals import bootstrap_interval
from sim_motor.batch import random_times
from sim_motor.robots import Start, random_robots, run
from sim_motor.scene import Scene
from sim_motor.world import alone

Array = NDArray[np.float64]

CHAOTIC, STRAIGHT, KICKED, WALK = "chaos", "straight", "kicked", "random walk"
WAYS = (CHAOTIC, STRAIGHT, KICKED, WALK)
FLOOR_M = 2.0
CELL_M = ROBOT["body_length"]
SIDE = round((FLOOR_M - CELL_M) / CELL_M)
# Robots whose ten minutes are computed at once: they take some seconds.
ROBOTS_OF_A_PART = 4
STEP_S, PAUSE_S, WALK_S = 0.3, 1.0, 5.0
STUCK_M, DITHER_DEG = 0.05, 0.2
# The speed (m/s) of a robot that drives straight on at k = 2.
SPEED_M_S = 0.286


class Cell(TypedDict):
    """All robots with one way of moving.

    Attributes:
        way: one of WAYS.
    """

    way: str


class Place(TypedDict):
    """Where the centre of one robot is at one time.

    Attributes:
        number: number of the robot, from 0.
        t_s: time (s).
        x_m: x from the middle of the floor (m).
        y_m: y from the middle of the floor (m).
    """

    number: int
    t_s: float
    x_m: float
    y_m: float


class Row(Cell, Place):
    """A row of the table."""


class Cover(Cell):
    """How robots with one way of moving cover the floor; intervals are of 95 % over robots.

    Attributes:
        visited: mean share of the cells visited in the end (1).
        half_s: median time until half of the cells were visited (s); None if most robots never got
            so far.
        stuck: how many robots moved by less than STUCK_M in the last quarter of the time.
        returns_s: mean over robots of the median time from leaving a cell to its next visit (s).
    """

    visited: float
    visited_interval: tuple[float, float] | None
    half_s: float | None
    stuck: int
    returns_s: float | None
    returns_interval: tuple[float, float] | None


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """One for each way of moving."""
    if not batch:
        raise WrongUse(
            "explore runs only on the simulated robot: a real one does not know where it is",
            "leave --brick out",
        )
    return [{"way": way} for way in WAYS]


def simulate(cell: Cell, setting: Setting) -> list[RunRow]:
    """Let all robots of one way move about."""
    return [row for part in parts(cell, setting, None) for row in part.rows]


def parts(cell: Cell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """The same, some robots at a time."""
    robots, seconds = setting.options["robots"], 60 * setting.options["minutes"]
    rng = np.random.default_rng(setting.seed_of(cell))
    way = cell["way"]
    if way == WALK:
        steps = round(seconds / STEP_S)
        yield Part(_places([random_walk(steps, rng) for _ in range(robots)]))
        return
    drive = _drive_of(way, robots, seconds, rng, setting)
    first = begun.state if begun else 0
    for end in [*range(first + ROBOTS_OF_A_PART, robots, ROBOTS_OF_A_PART), robots]:
        yield Part(_places(drive(slice(first, end)), first), end, end / robots)
        first = end


def _places(paths: Iterable[Array], first: int = 0) -> list[RunRow]:
    """The rows of robots whose numbers begin with `first`."""
    return [
        {"number": number, "t_s": at * STEP_S, "x_m": float(x), "y_m": float(y)}
        for number, path in enumerate(paths, first)
        for at, (x, y) in enumerate(path)
    ]


def _drive_of(
    way: str, robots: int, seconds: float, rng: np.random.Generator, setting: Setting
) -> Callable[[slice], Array]:
    """A function that says where some of the robots are every STEP_S.

    It returns x and y (m), (robots, times, 2). All chances are drawn here, for all robots.
    """
    motor, seed = alone(setting.constants), int(rng.integers(2**30))
    params = params_with(**MODES[CHAOS if way == CHAOTIC else WALL_TURNER].params)
    ticks, start = round(seconds / params.tick_s), random_robots(robots, rng, motor)
    pulses = []
    if way == KICKED:
        now = rng.exponential(WALK_S)
        while now < seconds:
            pulses.append((round(now / params.tick_s), params_with(k=0.0)))
            now += PAUSE_S
            pulses.append((round(now / params.tick_s), params))
            now += rng.exponential(WALK_S) + params.tick_s
    if way != CHAOTIC:
        start = both_alike(start)
    times = random_times(robots, ticks, params.tick_s, np.random.default_rng(seed))

    def drive(some: slice) -> Array:
        dithers = (seed + side * robots + some.start for side in range(2))  # one for each wheel
        course = run(
            some.stop - some.start,
            ticks,
            seed,
            Scene(FLOOR_M, FLOOR_M, ON_AXLES["grip"], None, ON_AXLES["bumper"], ON_AXLES["axle"]),
            params=params,
            then=pulses,
            motors=tuple(motor.with_dither(DITHER_DEG, dither) for dither in dithers),
            battery_v=setting.battery_v,
            start=Start(start.states[some], start.potentials[some], start.headings[some]),
            times=times[some],
        )
        return course.places[:, :: round(STEP_S / params.tick_s), :2]

    return drive


def both_alike(start: Start) -> Start:
    """The start, with the right wheel as the left: such a robot drives straight on."""
    states, potentials = start.states.copy(), start.potentials.copy()
    states[:, 1], potentials[:, 1] = states[:, 0], potentials[:, 0]
    return Start(states, potentials, start.headings)


def random_walk(steps: int, rng: np.random.Generator) -> Array:
    """A point that starts in the middle and walks within the area that a centre can reach.

    Args:
        steps: How many times STEP_S apart.
        rng: Source of its headings.

    Returns:
        x and y (m), (steps, 2).
    """
    edge, stride = (FLOOR_M - CELL_M) / 2, SPEED_M_S * STEP_S
    path, heading = np.zeros((steps, 2)), rng.uniform(-np.pi, np.pi)
    for at in range(1, steps):
        if rng.random() < STEP_S / WALK_S:
            heading = rng.uniform(-np.pi, np.pi)
        while True:
            there = path[at - 1] + stride * np.array([np.cos(heading), np.sin(heading)])
            if np.abs(there).max() <= edge:
                break
            heading = rng.uniform(-np.pi, np.pi)
        path[at] = there
    return path


def cells_of(path: Array) -> NDArray[np.int64]:
    """The number of the floor's cell in which each place (m), (times, 2), lies."""
    column, line = np.clip(np.floor(path / CELL_M + SIDE / 2), 0, SIDE - 1).astype(int).T
    return np.asarray(SIDE * line + column)


def visited_shares(path: Array) -> Array:
    """The share of the floor's cells visited until each time, (times,)."""
    cell = cells_of(path)
    first = np.zeros(len(cell))
    first[np.unique(cell, return_index=True)[1]] = 1
    return np.asarray(first.cumsum() / SIDE**2)


def return_times(path: Array) -> Array:
    """The times (s) from leaving a cell until the next visit to it."""
    cell = cells_of(path)
    left: dict[int, int] = {}
    times = []
    for at in range(1, len(cell)):
        before, now = int(cell[at - 1]), int(cell[at])
        if now != before:
            left[before] = at
            if now in left:
                times.append(STEP_S * (at - left[now]))
    return np.array(times)


def paths_of(rows: list[Row], way: str) -> Array:
    """The places (m) of all robots with one way of moving, (robots, times, 2)."""
    own = [row for row in rows if row["way"] == way]
    robots = 1 + max(row["number"] for row in own)
    return np.array([(row["x_m"], row["y_m"]) for row in own]).reshape(robots, -1, 2)


def report(rows: list[Row], setting: Setting) -> Findings:
    """How much of the floor each way of moving covers. No claim of the paper."""
    return Findings([], {"cover": [_cover(way, paths_of(rows, way)) for way in WAYS]})


def _cover(way: str, paths: Array) -> Cover:
    shares = np.array([visited_shares(path) for path in paths])
    half = [STEP_S * int(np.argmax(own >= 0.5)) if own[-1] >= 0.5 else np.inf for own in shares]
    half_s = float(np.median(half))
    returns = [float(np.median(times)) for path in paths if len(times := return_times(path))]
    late = paths[:, -(paths.shape[1] // 4) :]
    ends = shares[:, -1].tolist()
    return {
        "way": way,
        "visited": float(np.mean(ends)),
        "visited_interval": bootstrap_interval(ends),
        "half_s": half_s if np.isfinite(half_s) else None,
        "stuck": int(np.count_nonzero(np.ptp(late, axis=1).max(axis=1) < STUCK_M)),
        "returns_s": float(np.mean(returns)) if returns else None,
        "returns_interval": bootstrap_interval(returns),
    }
