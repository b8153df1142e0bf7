"""A start after which the robot drives straight, as the exercise at the wall needs it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from host.kicking.outcome import FORWARD
from host.kicking.primitives import SHIFT_TOWARD
from host.kicking.steps import Steps, Wait
from robot.kicks import DEFAULT_TICKS, PHASE

if TYPE_CHECKING:
    from host.client.robot import Robot

# The name by which the command `primitive` knows it.
STRAIGHT = "straight"
# Until the neurons know where the resting wheels are: six times the usual tau (s).
SETTLE_S = 1.5


def start_straight(robot: Robot) -> Steps[dict[str, Any]]:
    """The steps that start a standing robot: both wheels begin to roll forward in the same tick.

    After an ordinary start half of all robots turn on the spot, and who kicks one wheel then faces
    no wall any more. Here the wheels rest with k = 0 until nothing is left of the random start, and
    one phase kick makes both of them roll.

    Args:
        robot: The robot. Its k must be one at which it stays at rest until it is kicked.

    Returns:
        {reached}, as the primitives have it.

    Raises:
        KickctlError: The robot does not stand, or was stopped meanwhile. It has its own k.
    """
    k = float(robot.status()["params"]["k"])
    robot.set(k=0.0)
    try:
        robot.start()
        yield Wait(SETTLE_S)
    finally:
        robot.set(k=k)
    robot.kick(PHASE, ticks=DEFAULT_TICKS[PHASE], shift=SHIFT_TOWARD[FORWARD])
    return {"reached": True}
