"""Motion primitives, and how to reach them from each other.

Kicks alone lead from locomotion to locomotion. A wheel that turns the wrong way gets the quenched
kick that is planned for the robot's parameters. If there is no plan, or planned kicks fail several
times, it gets a membrane inversion, which always reverses it. A wheel that rests gets a phase kick
with the sign that makes it roll the right way.

A pulse of the spring constant k to zero brings the robot to rest. It stays there where rest
coexists with locomotion. Elsewhere k is halved, and the pulse is repeated, until the robot stays at
rest; k then stays low.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from host.client.robot import Robot
from host.errors import NotDone
from host.kicking.outcome import (
    BACKWARD,
    DIRECTIONS,
    FORWARD,
    STOPPED,
    WATCH_S,
    Outcome,
    kick_steps,
    until_settled,
)
from host.kicking.planning import Plan, reversal
from host.kicking.robot_motor import motor_of
from host.kicking.steps import Steps, Wait, play
from host.logs.log import Log
from host.logs.motion import heading
from robot.kicks import (
    DEFAULT_SHIFT_RAD,
    DEFAULT_TICKS,
    DIRECTION_TICKS,
    MEMBRANE,
    PHASE,
    PULSE,
    WHEELS,
)
from sim_motor.constants import Constants

PRIMITIVES = {
    "forward": (FORWARD, FORWARD),
    "backward": (BACKWARD, BACKWARD),
    "spin-left": (BACKWARD, FORWARD),
    "spin-right": (FORWARD, BACKWARD),
    "stopped": (STOPPED, STOPPED),
}
UNSETTLED = "unsettled"
MAX_KICKS = 6
PLANNED_KICKS = 3
# How long to wait for the moment of a planned kick: some turns of a slow wheel.
MOMENT_PATIENCE_S = 3.0
# Long enough for the wheels to brake (0.3 s) and for the membrane potentials to forget the motion
# (four tau).
STOP_PULSE_S = 1.5
LEAST_K = 0.01
SHIFT_TOWARD = {FORWARD: -DEFAULT_SHIFT_RAD, BACKWARD: DEFAULT_SHIFT_RAD}


def headings(robot: Robot, log: Log) -> dict[str, str]:
    """The heading of each wheel once both have settled.

    It is UNSETTLED for both if they do not settle, as when they roll forth and back.
    """
    return play(robot, _headings(robot, log))


def _headings(robot: Robot, log: Log) -> Steps[dict[str, str]]:
    if not (yield until_settled(robot)):
        return dict.fromkeys(WHEELS, UNSETTLED)
    yield Wait(WATCH_S, lambda: len(log) > DIRECTION_TICKS)
    return {side: heading(log, side, log.records[-1].tick) for side in WHEELS}


def drive(
    robot: Robot,
    log: Log,
    primitive: str,
    motor: Constants | None = None,
    *,
    planned: bool = True,
) -> dict[str, Any]:
    """Bring a robot that runs into a primitive.

    Args:
        robot: The robot.
        log: A log that records it already.
        primitive: A key of PRIMITIVES.
        motor: The constants of its motors; by default those of the motor that the robot says it
            has. To stop it, nobody has to know them.
        planned: Whether to plan kicks, for which a map of their effects may have to be computed
            first; else every wheel that turns the wrong way gets a membrane inversion.

    Returns:
        {primitive, reached, before, after, kicks, k, k_before}: whether the robot reached it, the
        headings of the wheels before and after, each kick's Outcome as plain data, and k.

    Raises:
        KickctlError: The robot does not run, or cannot be reached, or its motor is not known.
    """
    return play(robot, drive_steps(robot, log, primitive, motor, planned=planned))


def drive_steps(
    robot: Robot,
    log: Log,
    primitive: str,
    motor: Constants | None = None,
    *,
    planned: bool = True,
) -> Steps[dict[str, Any]]:
    """The steps of `drive`."""
    stops = primitive == "stopped"
    if not planned or stops:
        motor = None
    elif motor is None:
        motor = motor_of(robot)
    wanted = dict(zip(WHEELS, PRIMITIVES[primitive], strict=True))
    before = yield from _headings(robot, log)
    k_before = float(robot.status()["params"]["k"])
    kicks = yield from _stop(robot, log) if stops else _roll(robot, log, wanted, motor)
    after = yield from _headings(robot, log)
    return {
        "primitive": primitive,
        "reached": after == wanted,
        "before": before,
        "after": after,
        "kicks": [outcome.as_dict() for outcome in kicks],
        "k": float(robot.status()["params"]["k"]),
        "k_before": k_before,
    }


def _roll(
    robot: Robot, log: Log, wanted: dict[str, str], motor: Constants | None
) -> Steps[list[Outcome]]:
    """Kick the wheels that do not head as wanted until they do."""
    yield from _restore_k(robot, log)
    kicks: list[Outcome] = []
    while len(kicks) < MAX_KICKS:
        present = yield from _headings(robot, log)
        wrong = [side for side in WHEELS if present[side] != wanted[side]]
        if not wrong:
            break
        plans = motor is not None and len(kicks) < PLANNED_KICKS
        params = robot.status()["params"] if plans else None
        chosen = {side: plan(robot, present[side], wanted[side], params, motor) for side in wrong}
        kicks.append((yield from _kick(robot, log, chosen)))
    return kicks


def plan(
    robot: Robot, present: str, wanted: str, params: dict[str, Any] | None, motor: Constants | None
) -> Plan:
    """The kick that turns a wheel from one heading to another.

    Args:
        robot: The robot, which hears a message if a map must be computed.
        present: The wheel's heading.
        wanted: The other heading.
        params: The robot's parameters by name; None for a kick that needs no map.
        motor: The constants of the robot's motors; None for a kick that needs no map.
    """
    if present == STOPPED:
        return Plan(PHASE, DEFAULT_TICKS[PHASE], SHIFT_TOWARD[wanted])
    planned = (
        reversal(DIRECTIONS[present], params, robot.on_trouble, motor)
        if params and motor is not None and present in DIRECTIONS
        else None
    )
    return planned or Plan(MEMBRANE, DEFAULT_TICKS[MEMBRANE])


def _kick(robot: Robot, log: Log, plans: dict[str, Plan]) -> Steps[Outcome]:
    """Kick both wheels at once if they have the same plan, at any phase; else kick the first."""
    side, chosen = next(iter(plans.items()))
    if chosen.window_rad is not None:
        robot.lease()  # to take it together with the kick would cost a tick
        yield _moment(robot, side, chosen.meets)
    elif len(plans) == 2 and all(
        own.window_rad is None and own.request() == chosen.request() for own in plans.values()
    ):
        side = "both"
    return (yield from kick_steps(robot, log, wheel=side, **chosen.request()))


def await_phase(robot: Robot, side: str, meets: Callable[[float], bool]) -> bool:
    """Wait until a wheel will have an angle (rad) in the next tick that `meets` takes.

    Returns whether that came within MOMENT_PATIENCE_S. For a plan, a kick at any moment is better
    than none.
    """
    robot.lease()  # to take it together with the kick would cost a tick
    return robot.wait(*_moment(robot, side, meets))


def _moment(robot: Robot, side: str, meets: Callable[[float], bool]) -> Wait:
    """A wait until a wheel will have an angle (rad) in the next tick that `meets` takes."""
    return Wait(MOMENT_PATIENCE_S, lambda: meets(sum(course(robot, side))))


def course(robot: Robot, side: str) -> tuple[float, float]:
    """The latest angle of a wheel (rad), and its mean turn in a tick (rad) over DIRECTION_TICKS."""
    angles = [
        float(getattr(record, side + "_phi_rad"))
        for record in robot.recent()[-1 - DIRECTION_TICKS :]
    ]
    return angles[-1], (angles[-1] - angles[0]) / max(1, len(angles) - 1)


def _restore_k(robot: Robot, log: Log) -> Steps[None]:
    """Raise k to its default if an earlier stop has lowered it and the robot does not roll.

    Near k_c and below, no kick makes a wheel roll for long.
    """
    k = robot.status()["params"]["k"]
    default = {row["name"]: row["default"] for row in robot.describe("params")}["k"]
    if k < default:
        present = yield from _headings(robot, log)
        if not set(present.values()) <= {FORWARD, BACKWARD}:
            robot.set(k=default)


def _stop(robot: Robot, log: Log) -> Steps[list[Outcome]]:
    """Bring the robot to rest by a pulse of k to zero.

    While it starts again by itself, halve k and repeat the pulse.
    """
    status = robot.status()["params"]
    k, ticks = float(status["k"]), max(1, round(STOP_PULSE_S / status["tick_s"]))
    kicks: list[Outcome] = []
    while set((yield from _headings(robot, log)).values()) != {STOPPED}:
        if k < LEAST_K:
            raise NotDone(
                "the wheels turn without any drive", "is something else moving the robot?"
            )
        if kicks:
            k /= 2.0
            robot.set(k=k)
        pulse = kick_steps(robot, log, PULSE, param="k", value=0.0, ticks=ticks)
        kicks.append((yield from pulse))
    return kicks
