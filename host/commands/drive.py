"""kickctl drive."""

import argparse
from pathlib import Path

from host.commands._motor import add_motor
from host.commands._options import add_take_over
from host.commands._recording import conclude, recorded
from host.commands._terminal import robot_of
from host.errors import NotDone

HELP = "bring the robot into a motion primitive by kicks, or to rest by the spring constant k"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The primitive."""
    parser.add_argument(
        "primitive", choices=("forward", "backward", "spin-left", "spin-right", "stopped")
    )
    add_motor(parser)
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Start the robot if it does not run, and drive there. Raises NotDone if it gets nowhere."""
    from host.kicking.outcome import require_control, require_running
    from host.kicking.primitives import drive
    from host.kicking.robot_motor import motor_of

    with robot_of(options, moves=True, sends="kick") as robot:
        # Before anything moves.
        motor = None if options.primitive == "stopped" else motor_of(robot, options.motor)
        require_control(robot)
        if robot.status()["state"] in ("idle", "stopped"):
            robot.start()
        require_running(robot)
        with recorded(robot, f"drive-{options.primitive}") as recording:
            result = drive(robot, recording.log, options.primitive, motor)
        result.update(brick=robot.link.uri, seed=robot.hello["seed"])
    how = f"{len(result['kicks'])} kick{'' if len(result['kicks']) == 1 else 's'}"
    if result["k"] != result["k_before"]:
        how += f", and k from {result['k_before']:g} to {result['k']:g}"
    verdict = (
        f"The robot reached {options.primitive}"
        if result["reached"]
        else f"The robot did NOT reach {options.primitive}"
    )
    sentence = (
        f"{verdict}: left {result['after']['left']}, right {result['after']['right']}, by {how}."
    )

    def draw(path: Path) -> Path:
        from host.figures.robot.kick import draw

        return draw(recording.log, path, f"Driven to {options.primitive}: {how}")

    conclude(options, result, sentence, recording, draw)
    if not result["reached"]:
        raise NotDone(f"the robot did not reach {options.primitive}", "try again")
    return 0
