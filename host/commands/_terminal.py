"""How verbs reach a robot and speak to people.

Words on standard error, results on standard output.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.client.robot import Robot, connect
from host.errors import KickctlError

if TYPE_CHECKING:
    from host.logs.log import Log


def say(text: str) -> None:
    """Words for people."""
    print(text, file=sys.stderr, flush=True)


def show(result: object) -> None:
    """A result for machines: one JSON object, on a line of its own."""
    print(json.dumps(result, allow_nan=False), flush=True)


@contextmanager
def robot_of(
    options: argparse.Namespace, *, moves: bool = False, observe: bool = False
) -> Iterator[Robot]:
    """The robot that the options name; says so if it is the simulated one.

    If the verb `moves` it, ^C stops its motors.
    """
    with connect(options.brick, options.seed, options.token, observe=observe) as robot:
        robot.on_trouble = say
        if robot.link.virtual:
            say(f"simulated robot, embedded ({robot.link.uri}, seed {robot.hello['seed']})")
        try:
            yield robot
        except KeyboardInterrupt:
            if moves:
                robot.stop()
                say("interrupted: motors stopped")
            raise


def answer(options: argparse.Namespace, result: dict[str, Any], sentence: str) -> None:
    """The result as JSON if asked for, else as a sentence."""
    if options.json:
        show(result)
    else:
        print(sentence)


def tell(summary: dict[str, Any]) -> None:
    """What a run came to: claims in sentences, its main numbers and how accurate they are, and where its files are."""
    from host.runs.claims import Claim

    for claim in summary["claims"]:
        print(Claim.from_dict(claim).sentence())
    for name, value in _told(summary["numbers"]):
        print(name, f"{value:.10g}" if isinstance(value, float) else value)
    table = Path(summary["table"])
    told = [("table", table), ("numbers", table.with_name("summary.json"))]
    for kind, path in (
        *told,
        *(("figure", path) for path in summary["figures"][:1]),
        *(("file", path) for path in summary["files"]),
    ):
        print(kind, path)


def _told(numbers: Any) -> Iterator[tuple[str, Any]]:
    """The single ones of a run's numbers, and those in its "accuracy", (name, value)."""
    if isinstance(numbers, dict):
        yield from (
            (name, value) for name, value in numbers.items() if isinstance(value, int | float | str)
        )
        for name, value in numbers.get("accuracy", {}).items():
            inner = value if isinstance(value, dict) else {"": value}
            yield from (
                (f"accuracy: {' '.join(filter(None, (name, key)))}", part)
                for key, part in inner.items()
            )


@contextmanager
def recorded(robot: Robot, kind: str) -> Iterator[tuple[Log, Path]]:
    """A log of all that the robot does meanwhile, in memory and, as it grows, in a new file of this path."""
    from host.logs.log import Log
    from host.logs.mcap_files import McapTap, new_path

    path = new_path(kind)
    log = Log(robot.info())
    with McapTap(path, log.info) as file:
        robot.add_tap(file)
        robot.add_tap(log)
        try:
            yield log, path
        except (KickctlError, OSError):
            say(f"what was recorded until then is in {path}")
            raise
        finally:
            robot.remove_tap(log)
            robot.remove_tap(file)
