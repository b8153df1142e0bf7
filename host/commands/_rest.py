"""Why wheels rest although the robot runs, and what frees them."""

from __future__ import annotations

from host.client.robot import Robot
from robot.kicks import REST_TRAVEL_RAD, WHEELS
from robot.params import TABLE

# How long a wheel is watched, s. A wheel that swings slowly shows itself in this time.
WATCH_S = 0.5
# Below this k wheels with the default a and tau_s always come to rest (experiment bifurcation).
LEAST_K = 0.5


def explain_rest(robot: Robot, k: float) -> list[str]:
    """Watch a running robot, and say of each wheel that rests why it does.

    Args:
        robot: The robot; half a second of its time passes.
        k: The spring constant in force.

    Returns:
        Lines for people; none if both wheels turn.
    """
    robot.wait(WATCH_S)
    now = robot.recent()[-1]
    watched = [record for record in robot.recent() if now.t_s - record.t_s <= WATCH_S]
    torques = {}
    for side in WHEELS:
        angles = [getattr(record, side + "_phi_rad") for record in watched]
        if max(angles) - min(angles) <= REST_TRAVEL_RAD:
            torques[side] = abs(getattr(now, side + "_torque"))
    if not torques:
        return []
    from host.kicking.robot_claims import STALL_TORQUE

    lines = [
        f"the {side} wheel rests, with a torque of |M| = {torque:.2f}"
        for side, torque in torques.items()
    ]
    if min(torques.values()) > STALL_TORQUE:
        lines.append(
            "  That should turn it. Is it blocked, or the battery weak? See kickctl doctor"
        )
    elif k < LEAST_K:
        lines.append(
            f"  k = {k:g} is too small for wheels that roll: kickctl params set"
            f" k={TABLE['k'].default:g}, then kickctl drive forward"
        )
    else:
        lines.append(
            f"  Friction holds a motor at rest up to |M| = {STALL_TORQUE:g}, and a larger k alone"
            " does not free it.\n"
            "  A kick does: kickctl drive forward. Or turn the wheel a little by hand"
        )
    return lines
