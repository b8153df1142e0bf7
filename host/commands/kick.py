"""kickctl kick."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.commands._options import add_take_over
from host.commands._recording import conclude, recorded
from host.commands._terminal import robot_of
from host.errors import NotDone, WrongUse
from host.util.angles import parse_angle
from host.util.numbers import Number, parse_number
from host.util.paths import path_argument
from robot.errors import Refused
from robot.kick_requests import CHANGED, parse
from robot.kicks import (
    DEFAULT_TICKS,
    MAX_JUMP,
    MAX_TICKS,
    MAX_WAVEFORM,
    MODES,
    RECTANGULAR,
    SMOOTH,
    WAVEFORM,
    WHEELS,
)
from robot.params import Params

if TYPE_CHECKING:
    from host.client.robot import Robot

FULL_TURN_DEG = 360.0
HELP = "kick the robot, and say whether it reversed"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The kick, and whether to wait until the wheels have settled."""
    lengths = ", ".join(f"{mode} {ticks}" for mode, ticks in DEFAULT_TICKS.items())
    parser.add_argument(
        "--mode", choices=MODES, help="which kick; with --waveform it may be left out"
    )
    parser.add_argument(
        "--ticks",
        type=Number("control periods", 1, MAX_TICKS, whole=True),
        metavar="N",
        help=f"how long, in control periods (default: {lengths})",
    )
    parser.add_argument(
        "--wheel",
        choices=(*WHEELS, "both"),
        default="both",
        help="which wheel (default %(default)s)",
    )
    parser.add_argument(
        "--shift",
        type=parse_angle,
        metavar="RAD",
        help="phase: the shift, rad, such as -3pi/4 (default: 3pi/4, with the sign that reverses)",
    )
    parser.add_argument(
        "--shape", choices=(RECTANGULAR, SMOOTH), help="shape of a pulse (default rectangular)"
    )
    parser.add_argument(
        "--param",
        choices=CHANGED,
        help="pulse, waveform: the parameter that it changes; a waveform may also add to x1 or x2",
    )
    parser.add_argument(
        "--waveform",
        type=path_argument,
        metavar="FILE",
        help=(
            f"waveform: a text or CSV file with 1 to {MAX_WAVEFORM} values, one for each of as many"
            " control periods, in the unit of the parameter; its first line may name that, as in"
            " shift_rad"
        ),
    )
    parser.add_argument(
        "--value",
        type=Number(),
        help=(
            "pulse: the value of the parameter at the height of the pulse, in the unit that"
            " `kickctl params list` shows"
        ),
    )
    parser.add_argument("--variable", choices=("x1", "x2"), help="jump: the membrane potential")
    parser.add_argument(
        "--delta",
        type=Number("", -MAX_JUMP, MAX_JUMP),
        help="jump: how far the potential jumps; potentials have no unit",
    )
    parser.add_argument(
        "--window",
        type=_window,
        metavar="FROM,TO",
        help=(
            "wait until the wheel's angle is between these (degrees), as `kickctl plan --search`"
            " gives them; a wheel looks the same after 90 degrees, with one rod after 180"
        ),
    )
    parser.add_argument(
        "--now",
        action="store_true",
        help="kick at once, without waiting until the wheels have settled",
    )
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Kick, and write a log and a figure. Raises NotDone if a kicked wheel did not reverse."""
    from host.kicking.outcome import (
        OTHER_PARAMETERS,
        UNSETTLED,
        describe,
        kick_and_watch,
        require_control,
        require_done,
        require_running,
        title,
        wait_settled,
    )

    details = _details(options)
    ticks = _check(options.mode, options.wheel, details)
    if options.window and options.wheel == "both":
        raise WrongUse(
            "--window is for one wheel, as both are never at the same angle",
            "add --wheel left or --wheel right",
        )
    with robot_of(options, moves=True, sends="kick") as robot:
        require_running(robot)
        require_control(robot)
        with recorded(robot, _in_name(options, ticks), of_kick=True) as recording:
            if not options.now and not wait_settled(robot):
                raise NotDone(
                    f"{UNSETTLED}, so the kick was not sent",
                    f"{OTHER_PARAMETERS}; --now kicks without waiting",
                )
            if options.window:
                _await_window(robot, options.wheel, options.window)
            outcome = kick_and_watch(
                robot, recording.log, options.mode, wheel=options.wheel, **details
            )
        brick, seed = robot.link.uri, robot.hello["seed"]

    def draw(path: Path) -> Path:
        # Nothing may fail here before the kick is made and answered, so matplotlib comes last.
        from host.figures.robot.kick import KICK_WINDOW_S, draw

        return draw(recording.log, path, title(outcome), KICK_WINDOW_S, outcome.applied_tick)

    result = {**outcome.as_dict(), "brick": brick, "seed": seed}
    conclude(options, result, describe(outcome), recording, draw)
    require_done(outcome)
    return 0


def in_one_line(result: dict[str, Any]) -> str:
    """The result in words, and the log."""
    done = "reversed" if result["reversed"] else "did not reverse"
    before, after = (", ".join(result[key].values()) for key in ("before", "after"))
    return f"{done}: {before} before the kick, {after} after it; log {result['log']}"


def _window(text: str) -> tuple[float, float]:
    """The two angles of a window, degrees. Raises argparse.ArgumentTypeError."""
    parts = (parse_number(part.strip()) for part in text.split(","))
    ends = [end for end in parts if end is not None]
    if len(ends) != 2 or text.count(",") != 1 or not 0.0 < ends[1] - ends[0] < FULL_TURN_DEG:
        raise argparse.ArgumentTypeError(
            f"cannot be '{text}'; give two angles in degrees, the first one smaller, as in 60,84"
        )
    return ends[0], ends[1]


def _await_window(robot: Robot, side: str, window: tuple[float, float]) -> None:
    """Wait until the wheel is in the window in the next tick. Raises NotDone."""
    from math import radians

    from host.kicking.kick_map import period_rad
    from host.kicking.primitives import await_phase

    first, last = map(radians, window)
    period = period_rad(robot.status()["params"]["rods"])
    if not await_phase(robot, side, lambda phi: (phi - first) % period <= last - first):
        raise NotDone(
            f"the {side} wheel did not come to an angle from {window[0]:g}° to {window[1]:g}°",
            "does it roll? kickctl drive forward makes it roll; or kick without --window",
        )


def _details(options: argparse.Namespace) -> dict[str, Any]:
    """The kick's fields beside its mode, which --waveform gives if nothing else does.

    Raises WrongUse.
    """
    names = ("ticks", "shift", "shape", "param", "value", "variable", "delta")
    details = {name: getattr(options, name) for name in names}
    if options.waveform is None:
        if options.mode is None:
            raise WrongUse("--mode is missing", f"it is one of {', '.join(MODES)}")
        if options.mode == WAVEFORM:
            raise WrongUse("the waveform is missing", "name its file: --waveform FILE")
        return details
    from host.kicking.waveform import read_waveform

    options.mode = options.mode or WAVEFORM
    details["param"], details["waveform"] = read_waveform(options.waveform, options.param)
    return details


def _in_name(options: argparse.Namespace, ticks: int) -> str:
    """The kick in its log's name, as in kick-phase-4-ticks-left."""
    side = "" if options.wheel == "both" else f"-{options.wheel}"
    return f"kick-{options.mode}-{ticks}-tick{'s' if ticks > 1 else ''}{side}"


def _check(mode: str, wheel: str, details: dict[str, object]) -> int:
    """The kick's length, ticks. Raises WrongUse for a kick that the robot would refuse."""
    request = {name: value for name, value in details.items() if value is not None}
    try:
        kick = parse({"id": "check", "mode": mode, "wheel": wheel, **request}, (1, 1), Params(), 0)
    except Refused as refusal:
        raise WrongUse(refusal.message, refusal.hint) from refusal
    return int(kick.ticks)
