"""A robot with k = 2 runs against a wall and reverses by itself, or does not (R13).

No sensor and no kick reports the wall. A trial sets both wheels going forward at once and watches
them; the log alone says how the hit went (see wall_hits).

On a floor without grip the wheels do not stop at the wall: they turn on. A wheel that does stop
obeys its rods alone. They draw it to the next of four angles, forward or backward, as its phase
decides. If that is forward, the wheel presses against the wall and rests there, or the other wheel
goes first and the robot turns on the spot. On a soft axle the blocked motor, which has most of the
robot's kinetic energy, winds the axle up and springs back over that point.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import ceil, pi
from typing import TypedDict

import numpy as np

from host.client.robot import Robot
from host.experiments.registry import claimed
from host.experiments.robot import unattended
from host.experiments.robot.wall_hits import Motion, bounces, motion_since, read_hit, read_series
from host.experiments.robot.wall_rows import (
    ON_AXLES,
    ON_SMOOTH,
    PAPER,
    ROBOT,
    SMOOTH,
    Condition,
    Hit,
    HitRow,
    HitsCell,
    OneHit,
    RunTick,
    SeriesCell,
    SeriesRun,
    TrialCell,
    WallCell,
    WallRow,
    count_bounces,
    hits_under,
)
from host.kicking.outcome import FORWARD
from host.kicking.primitives import SHIFT_TOWARD
from host.kicking.robot_claims import WHEEL_RADIUS_M
from host.logs.log import Log
from host.runs import presets
from host.runs.answers import Answer, share
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim, too_few
from host.runs.contract import Findings, Options, Part, Row, Setting, as_rows
from host.runs.presets import OPTION
from host.util.intervals import fraction, wilson
from robot.kicks import DIRECTION_TICKS, PHASE
from robot.loop import Loop
from sim_motor.axle import stiffness_range
from sim_motor.brick import SimBrick
from sim_motor.constants import GRAVITY
from sim_motor.scene import Scene

# The values that the maps vary: axles from the softest to the stiffest and a rigid one (N/m), grips
# of carpets and beyond (1), fronts (m), and batteries (V).
AXLES = (220.0, 300.0, 400.0, 600.0, 900.0, 1500.0, 3000.0, None)
GRIPS = (1.34, 1.5, 1.6, 1.71, 1.83, 2.0, 2.5)
BUMPERS, BATTERIES = (0.1, 0.16, 0.2, 0.25, 0.3, 0.4), (6.5, 7.0, 7.5, 8.0, 8.4)
MAP_HITS = 40
# Hits of one robot after the other that take some seconds.
HITS_OF_A_PART = 100

# The least distance between the walls. Over all hits it grows by what two turns of the wheels
# cover, so that the wheels come to the wall at all phases.
NEAREST_M, TURN_M = 1.2, 2 * pi * WHEEL_RADIUS_M
REST_S, WATCH_S, LOOK_S, SERIES_S = 1.5, 8.0, 0.6, 40.0
# How many runs are tried for a series that shows a reversal.
RUNS = 10
# The paper asks that this share of this many hits bounces.
TARGET, BOUNCES = 0.95, 50
BEST_HITS = 4
RANGE = stiffness_range()

# Planes of conditions around the best one, by the name of what varies beside the axle. Some
# conditions stand in two of them.
MAPS: dict[str, list[Condition]] = {
    "grip": [{**ON_AXLES, "axle": axle, "grip": grip} for grip in GRIPS for axle in AXLES],
    "bumper": [
        {**ON_AXLES, "axle": axle, "bumper": bumper} for bumper in BUMPERS for axle in AXLES
    ],
    "battery_v": [
        {**ON_AXLES, "axle": axle, "battery_v": volts} for volts in BATTERIES for axle in AXLES
    ],
}


def cells(options: Options, *, batch: bool) -> list[WallCell]:
    """All hits under one condition for the simulation, one hit for a robot."""
    hits, k = options["bounces"], options["k"]
    if not batch:
        return [{"k": k, "hit": hit} for hit in range(hits)]
    if options.get(OPTION.name) == presets.PAPER:
        return [{"part": "claim", "k": k, **ON_AXLES, "hits": BEST_HITS * hits}]
    # To tell the best condition from one at TARGET takes more hits.
    counts = [(PAPER, hits), (ON_SMOOTH, hits), (ON_AXLES, BEST_HITS * hits)]
    work: list[WallCell] = [
        {"part": "claim", "k": k, **where, "hits": count} for where, count in counts
    ]
    done = [condition for condition, _ in counts]
    for condition in (condition for plane in MAPS.values() for condition in plane):
        if condition not in done:
            work.append({"part": "map", "k": k, **condition, "hits": MAP_HITS})
            done.append(condition)
    work += [{"part": "series", "k": k, **condition} for condition in (PAPER, ON_AXLES)]
    return work


def world(cell: OneHit | SeriesRun) -> dict[str, str]:
    """Two walls, farther apart for each hit or run.

    A real robot needs a wall ahead that it meets squarely, half a metre away or more.
    """
    part = cell["run"] / RUNS if cell["part"] == "series" else cell["hit"] / cell["hits"]
    farther_m = 2 * TURN_M * part
    axle = {} if cell["axle"] is None else {"axle": str(cell["axle"])}
    return {
        "walls": f"{NEAREST_M + farther_m:.4f}",
        "grip": str(cell["grip"]),
        "bumper": str(cell["bumper"]),
        **axle,
    }


def simulate(cell: HitsCell | SeriesCell, setting: Setting) -> list[Row]:
    """Run the robot's whole loop against the wall, with a robot of its own for each hit."""
    return [row for part in parts(cell, setting, None) for row in part.rows]


def parts(cell: HitsCell | SeriesCell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """The same, some hits at a time."""
    if cell["part"] == "series":
        yield Part(as_rows(_reversing_run(cell, setting)))
        return
    first = len(begun.rows) if begun else 0
    for end in [*range(first + HITS_OF_A_PART, cell["hits"], HITS_OF_A_PART), cell["hits"]]:
        yield Part(
            [
                {"hit": hit, **read_hit(*_run_into_wall({**cell, "hit": hit}, setting, stop=True))}
                for hit in range(first, end)
            ],
            share=end / cell["hits"],
        )
        first = end


def _reversing_run(cell: SeriesCell, setting: Setting) -> list[RunTick]:
    """The first run in which a wall reverses the robot; the last of RUNS if none does."""
    for number in range(RUNS):
        run: SeriesRun = {**cell, "run": number}
        ticks = read_series(*_run_into_wall(run, setting, stop=False))
        if any(tick["bounce"] for tick in ticks):
            break
    return [{**tick, "run": number} for tick in ticks]


def _run_into_wall(cell: OneHit | SeriesRun, setting: Setting, *, stop: bool) -> Motion:
    """Send a simulated robot off; to `stop`, end when it has bounced, else after SERIES_S."""
    seed = setting.seed_of(cell)
    scene = Scene(**{name: float(value) for name, value in world(cell).items()})
    battery_v = setting.battery_v if cell["battery_v"] is None else cell["battery_v"]
    brick = SimBrick(seed, motor=setting.constants, battery_v=battery_v, scene=scene)
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    log = Log()

    def run(seconds: float) -> None:
        log.take_records(unattended.run(loop, ceil(seconds / loop.params.tick_s)))

    loop.set_params({**setting.own_params(), "k": 0.0})
    loop.start()
    run(REST_S)
    log.records.clear()
    loop.set_params({"k": cell["k"]})
    loop.kick({"id": "off", "mode": PHASE, "shift": SHIFT_TOWARD[FORWARD]})
    if not stop:
        run(SERIES_S)
    while stop and log.seconds < WATCH_S and not bounces(*motion_since(log)):
        run(LOOK_S)
    return motion_since(log)


def trial(cell: TrialCell, robot: Robot, log: Log, setting: Setting) -> list[Hit]:
    """Do one hit on a robot. It rests for REST_S first; then its user may turn it to the wall."""
    robot.set(k=0.0)
    robot.wait(REST_S)
    robot.set(k=cell["k"])
    begin = robot.kick(PHASE, shift=SHIFT_TOWARD[FORWARD])

    def bounced() -> bool:
        return len(log) % DIRECTION_TICKS == 0 and bool(bounces(*motion_since(log, begin)))

    robot.wait(WATCH_S, until=bounced)
    return [read_hit(*motion_since(log, begin))]


def report(rows: list[WallRow], setting: Setting) -> Findings:
    """R13."""
    hits = hits_under(rows, PAPER) or hits_under(rows, ON_AXLES)
    done, tried = count_bounces(hits)
    part = fraction(done, tried)
    claim = Claim(
        "R13",
        SENTENCES["R13"],
        ">= 95 % of 50 bounces, M changes sign",
        part,
        "1",
        wilson(done, tried),
        part >= TARGET and all(_changes_sign(row) for row in hits if row["reversed"]),
        _note(rows, hits),
    )
    few = too_few(tried, BOUNCES, "hits")
    foreign = setting.elsewhere(**claimed("wall"))
    numbers = _numbers(rows, hits)
    answers = [
        share(f"hits that reverse the robot, {where}", *count_bounces(own))
        for where, own in (
            ("wheels fixed to the motors", hits_under(rows, PAPER)),
            ("smooth floor", hits_under(rows, ON_SMOOTH)),
            ("soft axles", hits_under(rows, ON_AXLES)),
        )
        if own
    ]
    answers += [
        Answer("torque M before a bounce (median)", numbers["torque_before"]),
        Answer("torque M after it (median)", numbers["torque_after"]),
        Answer("a bounce takes (median)", numbers["took_s"], None, "s"),
    ]
    return Findings([claim.doubted(foreign, few)], numbers, answers=answers)


def _changes_sign(row: HitRow) -> bool:
    before, after = row["before"], row["after"]
    return before is not None and after is not None and before * after < 0


def _note(rows: list[WallRow], hits: list[HitRow]) -> str:
    notes = ["the share of hits that reverse it: {} of {}".format(*count_bounces(hits))]
    failed = Counter(row["ended"] for row in hits if not row["reversed"])
    if failed:
        ways = ", ".join(f"{how} ({count})" for how, count in failed.most_common())
        notes.append("the others: " + ways)
    done, tried = count_bounces(hits_under(rows, ON_AXLES))
    if tried:
        low, high = wilson(done, tried)
        notes.append(
            f"with a front {ON_AXLES['bumper']:g} m wide, grip {ON_AXLES['grip']:g}, and wheels on"
            f" axles of {ON_AXLES['axle']:g} N/m (computed range {RANGE[0]:.0f} to"
            f" {RANGE[1]:.0f}): {done} of {tried} ({low:.1%} to {high:.1%})"
        )
    done, tried = count_bounces(hits_under(rows, ON_SMOOTH))
    if tried:
        most = SMOOTH * ROBOT["mass"] / 2 * GRAVITY * ROBOT["wheel_radius"]
        notes.append(
            f"on a smooth floor of grip {SMOOTH:g}, which holds a wheel with {most:.2f} N m only,"
            f" so that it turns on at the wall: {done} of {tried}"
        )
    return "; ".join(notes)


class Numbers(TypedDict):
    """What the hits of the claim came to, and the maps.

    Attributes:
        torque_before: median torque M before a bounce (1).
        torque_after: median torque M after it (1).
        took_s: median time that a bounce takes (s).
        ended: how many hits ended in each way.
        axle_range: what the stiffness of an axle may be (N/m).
        bounces_of_hits: by what a map varies beside the axle, [condition, bounces, hits] of each
            of its conditions.
    """

    torque_before: float | None
    torque_after: float | None
    took_s: float | None
    ended: dict[str, int]
    axle_range: tuple[float, float]
    bounces_of_hits: dict[str, list[tuple[Condition, int, int]]]


def _numbers(rows: list[WallRow], hits: list[HitRow]) -> Numbers:
    """Medians over the bounces (None without one), and the maps."""
    bounced = [row for row in hits if row["reversed"]]

    def median(values: list[float | None]) -> float | None:
        known = [value for value in values if value is not None]
        return float(np.median(known)) if known else None

    return {
        "torque_before": median([row["before"] for row in bounced]),
        "torque_after": median([row["after"] for row in bounced]),
        "took_s": median([row["took_s"] for row in bounced]),
        "ended": dict(Counter(row["ended"] for row in hits)),
        "axle_range": RANGE,
        "bounces_of_hits": {
            name: [(where, *count_bounces(hits_under(rows, where))) for where in conditions]
            for name, conditions in MAPS.items()
        },
    }
