"""Which way a robot goes when it is started from rest, many times: spontaneous symmetry breaking.

The equations of a wheel prefer no direction: with forward and backward exchanged they are the same.
A wheel that rests exactly at a fixed point - it stands at a multiple of 45 degrees, and its
potentials are those of this angle - feels no force and stays there for ever. A start breaks the
symmetry by chance: it sets the potentials of each wheel to those of an angle at random. The rods
push the wheel away from this remembered angle. If the wheel stands ahead of it, it goes forward,
else backward, and keeps its direction. The encoder, which rounds the wheel's angle to whole
degrees, and the motor decide only where the push is weak. So both directions come equally often,
unless a wheel or its motor is not symmetric.

On the simulated robot each start is that of a new robot. The random seed fixes its potentials, the
angles of its wheels, and the small differences between its motors. A real robot draws the
potentials from its own seed, and its wheels stand where they came to rest.
"""

from __future__ import annotations

from math import atan2, degrees, remainder
from typing import Literal, TypedDict, cast

from host.client.robot import Robot
from host.errors import NotDone
from host.kicking.outcome import DIRECTIONS, JUDGED_S, wait_settled
from host.logs.log import Log
from host.logs.motion import heading
from host.runs.contract import Findings, Options, Setting
from host.util.intervals import fair_p, fraction, wilson
from robot.kicks import WHEELS

simulate = None

# Long enough for the wheels to brake.
REST_S = 1.5
# From here on only motion after the start counts for the judgement whether a wheel has settled.
AWAY_S = JUDGED_S + 0.5

Wheel = Literal["left", "right"]


class Cell(TypedDict):
    """A start.

    Attributes:
        start: number of the start, from 0.
    """

    start: int


class Trial(TypedDict):
    """One wheel that was started.

    Attributes:
        wheel: which one.
        phi_deg: the angle at which it rested (degrees).
        ahead_deg: how far it then stood ahead of the angle that its potentials remember (degrees,
            from -180 to 180).
        direction: where it went: 1 forward, -1 backward, 0 stayed at rest; None if it moved but did
            not settle.
    """

    wheel: Wheel
    phi_deg: float
    ahead_deg: float
    direction: int | None


class Row(Cell, Trial):
    """A wheel with the number of its start."""


class Counts(TypedDict):
    """What wheels did.

    Attributes:
        forward: how many went forward.
        backward: how many went backward.
        rest: how many stayed at rest.
        unsettled: how many moved without settling.
        forward_share: forward / (forward + backward); None if none moved.
        interval: the 95 % interval of that share, [low, high].
        p: how probable a split at least as uneven is if both directions are equally likely
            (two-sided, exact binomial test).
    """

    forward: int
    backward: int
    rest: int
    unsettled: int
    forward_share: float | None
    interval: list[float]
    p: float


class Numbers(TypedDict):
    """What was counted.

    Attributes:
        starts: how many starts.
        in_words: the counts of each wheel, and of both, in lines for people.
        left: the left wheel.
        right: the right wheel.
        both: both wheels together.
        same_way: how often both wheels went the same way.
        as_pushed: which part of the wheels that moved went away from the angle remembered.
    """

    starts: int
    in_words: str
    left: Counts
    right: Counts
    both: Counts
    same_way: int
    as_pushed: float


def cells(options: Options, *, batch: bool) -> list[Cell]:
    """One cell for each start."""
    return [{"start": number} for number in range(options["starts"])]


def world(cell: Cell) -> dict[str, str]:
    """The robot alone on the floor."""
    return {}


def trial(cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Trial]:
    """Stop the robot, let it come to rest, start it, and see where its wheels go."""
    robot.stop()
    robot.wait(REST_S)
    robot.start()
    robot.wait(AWAY_S)
    is_settled = wait_settled(robot)
    begins = [event for event in log.events if event["event"] == "start"]
    if not begins:
        raise NotDone("the log does not show the robot's start", "run the same command again")
    tick, potentials = begins[-1]["tick"], begins[-1]["x"]
    place = next(i for i, record in enumerate(log.records) if record.tick >= tick)
    rows: list[Trial] = []
    for side, (x1, x2) in zip(WHEELS, potentials, strict=True):
        phi_deg = degrees(float(log.column(side + "_phi_rad")[place]))
        way = DIRECTIONS.get(heading(log, side, log.records[-1].tick), 0)
        rows.append(
            {
                "wheel": cast("Wheel", side),
                "phi_deg": round(phi_deg % 360, 3),
                "ahead_deg": round(remainder(phi_deg - degrees(atan2(x2, x1)), 360), 3),
                "direction": way if is_settled else None,
            }
        )
    return rows


def count(rows: list[Row]) -> Counts:
    """Count where wheels went."""
    ways = [row["direction"] for row in rows]
    forward, backward = ways.count(1), ways.count(-1)
    moved = forward + backward
    return {
        "forward": forward,
        "backward": backward,
        "rest": ways.count(0),
        "unsettled": ways.count(None),
        "forward_share": forward / moved if moved else None,
        "interval": list(wilson(forward, moved)),
        "p": fair_p(forward, moved),
    }


def in_words(name: str, counts: Counts) -> str:
    """The counts of a wheel in words, and how they compare with those of a coin."""
    low, high = counts["interval"]
    others = "".join(
        f", {number} {words}"
        for number, words in ((counts["rest"], "at rest"), (counts["unsettled"], "not settled"))
        if number
    )
    share = (
        f"\n  the share of forward is {100 * counts['forward_share']:.0f} % (95 % interval"
        f" {100 * low:.0f} to {100 * high:.0f} %); a fair coin is as uneven as this, or more, in"
        f" {100 * counts['p']:.2g} % of all tries"
        if counts["forward_share"] is not None
        else ""
    )
    return f"{name}: {counts['forward']} forward, {counts['backward']} backward{others}{share}"


def report(rows: list[Row], setting: Setting) -> Findings:
    """The counts of each wheel. The paper makes no claim about them."""
    by_wheel = {side: [row for row in rows if row["wheel"] == side] for side in WHEELS}
    left, right, both = count(by_wheel["left"]), count(by_wheel["right"]), count(rows)
    moved = [row for row in rows if row["direction"]]
    pairs = zip(by_wheel["left"], by_wheel["right"], strict=True)
    total = len({row["start"] for row in rows})
    same_way = sum(bool(a["direction"]) and a["direction"] == b["direction"] for a, b in pairs)
    numbers: Numbers = {
        "starts": total,
        "in_words": (
            f"{in_words('left wheel', left)}\n{in_words('right wheel', right)}\n"
            f"both wheels went the same way in {same_way} of {total} starts"
        ),
        "left": left,
        "right": right,
        "both": both,
        "same_way": same_way,
        "as_pushed": fraction(
            sum((row["ahead_deg"] > 0) == (row["direction"] == 1) for row in moved), len(moved)
        ),
    }
    return Findings([], numbers)
