"""kickctl drive."""

import argparse
from pathlib import Path
from typing import Any

from host.commands._motor import add_motor
from host.commands._options import add_take_over
from host.commands._recording import conclude, recorded
from host.commands._terminal import robot_of, say
from host.errors import NotDone

HELP = (
    "bring the robot into a motion primitive by kicks, to rest by the spring constant k, or into a"
    " mode of the paper by its parameters"
)
PRIMITIVES = ("forward", "backward", "spin-left", "spin-right", "stopped")
MODES = ("chaos", "wall-turner")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The primitive or mode."""
    parser.add_argument(
        "primitive",
        choices=(*PRIMITIVES, *MODES),
        help="where to go. chaos sets k = 15, tau_s = 1 s and rod_lag_s = 6 ms; wall-turner sets"
        " k = 2. From both, a primitive first gives the robot its own parameters back",
    )
    add_motor(parser)
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Start the robot if it does not run, and drive there. Raises NotDone if it gets nowhere."""
    from host.kicking.modes import MODES as PARAMETERS
    from host.kicking.modes import enter, leave
    from host.kicking.outcome import require_control, require_running
    from host.kicking.primitives import drive
    from host.kicking.robot_motor import motor_of

    with robot_of(options, moves=True, sends="kick") as robot:
        # Before anything moves. To stop the robot, or to leave it to itself, nobody has to know.
        unplanned = options.primitive in ("stopped", "chaos")
        motor = None if unplanned else motor_of(robot, options.motor)
        require_control(robot)
        if robot.status()["state"] in ("idle", "stopped"):
            robot.start()
        require_running(robot)
        if options.primitive in MODES:
            mode = PARAMETERS[options.primitive]
            say(f"{options.primitive}: {mode.advice}.")
            if robot.link.virtual:
                say(f"A simulated robot does it best as --brick '{mode.address}'.")
        with recorded(robot, f"drive-{options.primitive}") as recording:
            if options.primitive in MODES:
                result = enter(robot, recording.log, options.primitive, motor)
            else:
                back = leave(robot)
                driven = drive(robot, recording.log, options.primitive, motor)
                result = {**driven, "restored": back.params}
                if back.params and back.known:
                    say(f"The robot has its own parameters back: {in_words(back.params)}.")
                elif back.params:
                    say(
                        "What the robot had before chaos is not known here. It has the defaults:"
                        f" {in_words(back.params)}."
                    )
        if not result.get("kept", True):
            say(
                "This computer cannot keep the robot's own parameters. Note them for later:"
                f" {in_words(result['own'])}."
            )
        result.update(brick=robot.link.uri, seed=robot.hello["seed"])
    how = f"{len(result['kicks'])} kick{'' if len(result['kicks']) == 1 else 's'}"
    if options.primitive in MODES:
        how += f", with {in_words(result['params'])}"
    elif result["k"] != result["k_before"]:
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


def in_words(params: dict[str, Any]) -> str:
    """Parameters as text, as in 'k = 2, tau_s = 1'."""
    from robot.params import TABLE

    units = {name: TABLE[name].unit.replace("1", "") for name in params}
    return ", ".join(f"{name} = {value:g} {units[name]}".rstrip() for name, value in params.items())
