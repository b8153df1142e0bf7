"""How verbs reach a robot and speak to people.

Words on standard error, results on standard output.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from host.client.robot import Robot, connect

if TYPE_CHECKING:
    from rich.table import Table

_answers: list[dict[str, Any]] = []


def begin() -> None:
    """A command begins: nothing has been answered yet."""
    _answers.clear()


def answered() -> bool:
    """Whether the command has answered in JSON, which it does only once."""
    return bool(_answers)


def say(text: str) -> None:
    """Words for people. Bytes of a command line that are no text appear as codes."""
    print(text.encode(errors="backslashreplace").decode(), file=sys.stderr, flush=True)


def show(result: dict[str, Any]) -> None:
    """Answer machines: one JSON object, on a line of its own."""
    line = json.dumps(result, allow_nan=False)
    _answers.append(result)
    print(line, flush=True)


def show_next(item: dict[str, Any]) -> None:
    """Give machines the next object of a stream, on a line of its own. An error may end it."""
    print(json.dumps(item, allow_nan=False), flush=True)


def print_table(table: Table) -> None:
    """Print a table without cutting anything off.

    A terminal gets as many lines as it takes; elsewhere each row has one line.
    """
    from rich.console import Console

    for column in table.columns:
        column.overflow = "fold"
    console = Console()
    if not console.is_terminal:
        console.width = max(1, console.measure(table, options=_endless(console)).maximum)
    console.print(table)


def _endless(console: Any) -> Any:
    """rich's options for a console without a right margin."""
    return console.options.update(width=10**6)


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
                say(f"interrupted: {robot.stop_at_once().sentence()}")
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
    for kind, path in (
        ("table", summary["table"]),
        ("numbers", summary["summary"]),
        *(("figure", path) for path in summary["figures"][:1]),
        *(("file", path) for path in summary["files"]),
    ):
        if path is not None:
            print(kind, path)


def finish(options: argparse.Namespace, summary: dict[str, Any], result: dict[str, Any]) -> int:
    """Answer with the results of a run, and say which of its files could not be written.

    Args:
        options: Say whether to answer in JSON.
        summary: The run's summary.
        result: The same as a JSON object.

    Returns:
        The exit status: 1 if a claim does not hold, or the table or the summary is missing.
    """
    from host.runs.claims import exit_status

    if options.json:
        show(result)
    else:
        tell(summary)
    for words in summary["unwritten"].values():
        say(f"kickctl: {words}")
    lost = summary["table"] is None or summary["summary"] is None
    return 1 if lost else exit_status(summary["claims"])


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
