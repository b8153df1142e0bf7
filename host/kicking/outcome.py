"""Kicks a robot and watches its wheels until they have settled again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from host.client.robot import Robot
from host.errors import NotDone, RobotFault
from host.kicking.steps import Steps, Wait, play
from host.logs.log import Log
from host.logs.motion import HEADINGS, heading, settled, settling_s
from robot.kicks import DIRECTION_TICKS, PHASE, POSITION, PULSE, PULSED, WHEELS
from robot.record import Record
from sim_motor.settling import WINDOW_S

SETTLE_PATIENCE_S = 15.0
UNSETTLED = f"the wheels do not move evenly, even after {SETTLE_PATIENCE_S:g} s"
OTHER_PARAMETERS = "with this k and tau_s they may never do: take others, as k=8 and tau_s=0.25"
WATCH_S = 6.0
# How far `motion.settled` looks back, and a tick or two. All of this must lie behind a kick.
JUDGED_S = 2 * WINDOW_S + 0.1

FORWARD, BACKWARD, STOPPED = (HEADINGS[way] for way in (1, -1, 0))
OPPOSITE = {FORWARD: BACKWARD, BACKWARD: FORWARD}
DIRECTIONS = {word: way for way, word in HEADINGS.items() if way}
RESULTS = REVERSES, CONTINUES, STOPS = "reverses", "continues", "stops"


def compare(before: str, after: str) -> str:
    """What a wheel did: one of RESULTS.

    It continues if its heading stays; a wheel at rest continues if it stays at rest. It stops if it
    rests afterwards, but not before. Else it reverses: it goes another way than before, which for a
    wheel from rest is either way.
    """
    if after == before:
        return CONTINUES
    return STOPS if after == STOPPED else REVERSES


@dataclass(frozen=True)
class Outcome:
    """What a kick did.

    Attributes:
        mode: The kick's mode.
        ticks: Its length, control periods.
        shift_rad: The shift of a phase kick or pulse: a number, or one for each wheel if their
            signs differ; None for other modes.
        wheel: left, right or both.
        applied_tick: The tick in which the kick began.
        before: The heading of each wheel before the kick.
        after: The heading of each wheel once it has settled.
        reversed: Whether each kicked wheel reversed.
        settling_s: How long the slower kicked wheel took to settle, s; None if one never did.
    """

    mode: str
    ticks: int
    shift_rad: float | dict[str, float] | None
    wheel: str
    applied_tick: int
    before: dict[str, str]
    after: dict[str, str]
    reversed: bool
    settling_s: float | None

    @property
    def results(self) -> dict[str, str]:
        """What each wheel did, in the words of RESULTS."""
        return {side: compare(self.before[side], self.after[side]) for side in WHEELS}

    def as_dict(self) -> dict[str, Any]:
        """Plain data, as the command line answers it."""
        return asdict(self)


def is_settled(records: list[Record], side: str) -> bool:
    """Whether a wheel turns evenly or rests at the end of these records."""
    return settled(
        [getattr(record, side + "_phi_rad") for record in records],
        [record.t_s for record in records],
    )


def all_settled(robot: Robot) -> bool:
    """Whether both wheels have settled."""
    records = robot.recent()
    begin = records[-1].t_s - JUDGED_S if records else 0.0
    recent = [record for record in records if record.t_s >= begin]
    return all(is_settled(recent, side) for side in WHEELS)


def until_settled(robot: Robot, patience_s: float = SETTLE_PATIENCE_S) -> Wait:
    """A wait until both wheels have settled, for at most patience_s of the robot's time."""
    return Wait(patience_s, lambda: all_settled(robot))


def wait_settled(robot: Robot, patience_s: float = SETTLE_PATIENCE_S) -> bool:
    """Wait until both wheels have settled, at most patience_s of the robot's time.

    Returns whether they have.
    """
    return robot.wait(*until_settled(robot, patience_s))


def require_no_fault(status: dict[str, Any]) -> None:
    """Raise RobotFault if a robot with this status is in fault."""
    if status["state"] == "fault":
        raise RobotFault(
            f"the robot is in fault: {status['reason']}",
            "mend the cause, then: kickctl clear, kickctl start",
        )


def require_running(robot: Robot) -> None:
    """Raise NotDone if the robot does not run, and RobotFault if it is in fault."""
    status = robot.status()
    require_no_fault(status)
    if status["state"] != "running":
        raise NotDone(
            f"the robot does not run: it is {status['state']} ({status['reason']})",
            "start it first: kickctl start",
        )


def require_control(robot: Robot) -> None:
    """Take control before a wait, so that a refusal comes before it.

    Nobody else controls an embedded robot, and to ask it would cost a tick of its time.

    Raises:
        RefusedByRobot: Another host controls the robot, or this machine does not have its token.
    """
    if not robot.link.virtual:
        robot.require_control()


def kick_and_watch(
    robot: Robot, log: Log, mode: str, *, wheel: str = "both", **details: Any
) -> Outcome:
    """Kick now and watch the wheels until they have settled.

    Args:
        robot: A robot that runs.
        log: A log that records the robot already. In the end it holds the whole kick.
        mode: The kick's mode.
        wheel: left, right or both.
        details: The kick's other fields, as robot.kick_requests.parse takes them.

    Raises:
        KickctlError: The robot does not run, refuses the kick, or cannot be reached.
    """
    return play(robot, kick_steps(robot, log, mode, wheel=wheel, **details))


def kick_steps(
    robot: Robot, log: Log, mode: str, *, wheel: str = "both", **details: Any
) -> Steps[Outcome]:
    """The steps of `kick_and_watch`."""
    yield Wait(WATCH_S, lambda: len(log) > DIRECTION_TICKS)
    tick = robot.kick(mode, wheel=wheel, **details)
    yield Wait(WATCH_S, lambda: bool(log.kicks()) and log.kicks()[-1][1]["begin"] == tick)
    kick = log.kicks()[-1][1]
    tick_s = float(log.info["params"]["tick_s"])

    def settling() -> list[float | None]:
        return [settling_s(log, side, tick) for side in kick["wheels"]]

    yield Wait(kick["ticks"] * tick_s + JUDGED_S)
    # Slow wheels already move evenly while they still gain speed; only later is it known when they
    # had settled.
    yield Wait(WATCH_S, lambda: all_settled(robot) and None not in settling())
    if robot.newest is not None and robot.newest.state != 1:
        require_running(robot)
    last = log.records[-1].tick
    return judge(
        kick,
        before={side: heading(log, side, tick - 1) for side in WHEELS},
        after={side: heading(log, side, last) for side in WHEELS},
        settling_s=settling(),
    )


def judge(
    kick: Mapping[str, Any],
    before: dict[str, str],
    after: dict[str, str],
    settling_s: Sequence[float | None],
) -> Outcome:
    """The outcome of a kick.

    Args:
        kick: The kick as the robot's event gives it.
        before: The heading of each wheel before the kick.
        after: The heading of each wheel afterwards.
        settling_s: How long each kicked wheel took to settle, s; None if it has not.
    """
    times = [time for time in settling_s if time is not None]
    return Outcome(
        mode=kick["mode"],
        ticks=kick["ticks"],
        shift_rad=_shift(kick),
        wheel="both" if len(kick["wheels"]) == len(WHEELS) else kick["wheels"][0],
        applied_tick=kick["begin"],
        before=before,
        after=after,
        reversed=all(after[side] == OPPOSITE.get(before[side]) for side in kick["wheels"]),
        settling_s=max(times) if len(times) == len(settling_s) else None,
    )


def _shift(kick: Mapping[str, Any]) -> float | dict[str, float] | None:
    if kick["mode"] != PHASE and (kick["mode"], kick["pulse"]) != (PULSE, PULSED["shift_rad"]):
        return None
    shifts = {side: float(kick["values"][WHEELS.index(side)]) for side in kick["wheels"]}
    values = set(shifts.values())
    return values.pop() if len(values) == 1 else shifts


def title(outcome: Outcome) -> str:
    """The title of a figure of the outcome."""
    length = f"{outcome.ticks} tick{'s' if outcome.ticks > 1 else ''}"
    settling = (
        ""
        if outcome.settling_s is None or not outcome.reversed
        else f", settled after {outcome.settling_s:.2f} s"
    )
    return (
        f"{outcome.mode.capitalize()} kick of {length}:"
        f" {'reversed' if outcome.reversed else 'not reversed'}{settling}"
    )


def require_done(outcome: Outcome) -> None:
    """Raise NotDone if the kick did not reverse the robot."""
    if not outcome.reversed:
        raise NotDone("the robot did not reverse", advice(outcome))


def advice(outcome: Outcome) -> str:
    """What may help after a kick that did not reverse the robot; empty if that is not clear."""
    kicked = WHEELS if outcome.wheel == "both" else (outcome.wheel,)
    resting = [side for side in kicked if outcome.before[side] == STOPPED]
    if resting:
        return (
            f"the {' and '.join(resting)} wheel rested before the kick, so there was nothing to"
            " reverse; `kickctl drive forward` makes it roll"
        )
    if outcome.mode in (PHASE, POSITION) and not 3 <= outcome.ticks <= 5:
        return (
            f"a {outcome.mode} kick can be too short or too long: try another --ticks;"
            " `kickctl experiment reliability --quick` tries 1 to 10"
        )
    return ""


def _turn(before: str, after: str) -> str:
    return f"stayed {before}" if before == after else f"went from {before} to {after}"


def describe(outcome: Outcome) -> str:
    """The outcome as a sentence."""
    kicked = WHEELS if outcome.wheel == "both" else (outcome.wheel,)
    turns = {side: _turn(outcome.before[side], outcome.after[side]) for side in kicked}
    if len(kicked) > 1 and len(set(turns.values())) == 1:
        motion = f"both wheels {turns[kicked[0]]}"
    else:
        motion = " and ".join(f"the {side} wheel {turn}" for side, turn in turns.items())
    verdict = (
        "The kick reversed the robot" if outcome.reversed else "The kick did NOT reverse the robot"
    )
    length = f"{outcome.ticks} tick{'s' if outcome.ticks > 1 else ''}"
    settling = f", settled after {outcome.settling_s:.2f} s" if outcome.settling_s else ""
    return (
        f"{verdict}: a {outcome.mode} kick of {length} at tick {outcome.applied_tick};"
        f" {motion}{settling}."
    )
