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
    """The robot that the options name. If the verb `moves` it, ^C stops its motors."""
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
    """Print the results of a run: claims in sentences, main numbers, accuracies, and its files."""
    from host.runs.claims import Claim

    for claim in summary["claims"]:
        print(Claim.from_dict(claim).sentence())
    for name, value in _single_values(summary["numbers"]):
        print(name, f"{value:.10g}" if isinstance(value, float) else value)
    table = Path(summary["table"])
    for kind, path in (
        ("table", table),
        ("numbers", table.with_name("summary.json")),
        *(("figure", path) for path in summary["figures"][:1]),
        *(("file", path) for path in summary["files"]),
    ):
        print(kind, path)


def _single_values(numbers: Any) -> Iterator[tuple[str, Any]]:
    """(name, value) of a run's numbers that are no lists, and of those under "accuracy"."""
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
    """Record all that the robot does meanwhile, in memory and in a new file that grows with it.

    Yields:
        The log and the file's path.
    """
    from host.logs.log import Log
    from host.logs.log_folder import new_path
    from host.logs.mcap_files import McapTap

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
