"""How verbs reach a robot and speak to people.

Words on standard error, results on standard output.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from host.commands._hints import as_typed, name_robot
from host.errors import FigureInterrupted, Interrupted, KickctlError, NoLink, NotDone
from host.util.interrupts import uninterrupted

if TYPE_CHECKING:
    from rich.table import Table

    from host.client.robot import Robot


class _Answer(NamedTuple):
    result: dict[str, Any]
    essentials: str


_answers: list[_Answer] = []


def begin() -> None:
    """A command begins: nothing has been answered yet, and no robot has been named."""
    _answers.clear()
    name_robot(None, None)


def say(text: str) -> None:
    """Words for people. Bytes of a command line that are no text appear as codes."""
    text = as_typed(text).encode(errors="backslashreplace").decode()
    print(text, file=sys.stderr, flush=True)


def show(result: dict[str, Any], essentials: str = "") -> None:
    """Answer machines. The answer is printed when the command ends, with the error that ends it.

    Args:
        result: The answer. A later one replaces it.
        essentials: What has been done, in words: they are said if nobody takes the answer.
    """
    json.dumps(result, allow_nan=False)  # a number that is none is a mistake here, not at the end
    _answers[:] = [_Answer(result, essentials)]


def print_answer(failure: KickctlError | None) -> None:
    """Print what was shown as one JSON object, on a line of its own.

    Args:
        failure: What has ended the command, and stands under `error`; None if it has done its work.

    Raises:
        OSError: Standard output takes nothing.
    """
    if failure is None and not _answers:
        return
    result, essentials = _answers.pop() if _answers else _Answer({}, "")
    if failure is not None:
        result = {**result, "error": as_dict(failure)}
        if isinstance(failure, Interrupted) and len(result) > 1:
            result["interrupted"] = True
    print_result(json.dumps(result, allow_nan=False), essentials)


def print_result(text: str, essentials: str = "") -> None:
    """Print a result. If nobody takes it, the error has a note with the essentials."""
    with essential(essentials):
        print(text)


@contextmanager
def essential(words: str) -> Iterator[None]:
    """Print a result in the block. If nobody takes it, the error has a note with these words."""
    try:
        yield
        sys.stdout.flush()
    except OSError as error:
        if words:
            error.add_note(words)
        raise


def show_next(item: dict[str, Any]) -> None:
    """Give machines the next object of a stream, on a line of its own. An error may end it."""
    print(json.dumps(item, allow_nan=False), flush=True)


def as_dict(failure: KickctlError) -> dict[str, str | int]:
    """An error as JSON has it: with `kept` if there is a file or folder that keeps something."""
    kept = {"kept": as_typed(failure.kept)} if failure.kept else {}
    return {
        "message": as_typed(failure.message),
        "hint": as_typed(failure.hint),
        "status": failure.status,
        **kept,
    }


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
    options: argparse.Namespace, *, moves: bool = False, observe: bool = False, sends: str = ""
) -> Iterator[Robot]:
    """The robot that the options name.

    Args:
        options: The options of the command line.
        moves: Whether the verb moves the robot. Then ^C stops its motors.
        observe: Whether it only looks on, which takes no token.
        sends: The command to the robot for which the verb is there. What ends the verb early says
            whether it was sent.

    Yields:
        The robot.
    """
    from host.client.robot import connect

    robot = None
    try:
        with connect(
            options.brick,
            options.seed,
            options.token,
            observe=observe,
            take_over=getattr(options, "take_over", False),
        ) as robot:
            robot.on_trouble = say
            if robot.link.virtual:
                say(f"simulated robot, embedded ({robot.link.uri}, seed {robot.hello['seed']})")
            try:
                yield robot
            except KeyboardInterrupt:
                if moves:
                    with uninterrupted():
                        say(f"interrupted: {robot.stop_at_once().sentence()}")
                raise
    except (KeyboardInterrupt, NoLink) as error:
        if sends:
            error.add_note(_account(robot, sends))
        raise


_SENT = {
    "kick": "kick",
    "start": "command to start",
    "clear": "command to clear the fault",
    "set": "change of parameters",
}


def _account(robot: Robot | None, command: str) -> str:
    """What was sent to a robot before the verb ended early; None if it was not reached."""
    name = _SENT[command]
    if robot is not None and robot.unanswered == command:
        return f"the {name} was sent, and no answer came: whether the robot obeyed is not known"
    if robot is None or not robot.confirmed[command]:
        return f"no {name} was sent"
    if command != "kick":
        return f"the {name} was sent, and the robot has confirmed it"
    kicks = robot.confirmed[command]
    return (
        "the kick was sent, its outcome was not watched"
        if kicks == 1
        else f"{kicks} kicks were sent, and the outcome of the last was not watched"
    )


def answer(options: argparse.Namespace, result: dict[str, Any], sentence: str) -> None:
    """The result as JSON if asked for, else as a sentence."""
    sentence = as_typed(sentence)
    if options.json:
        show(result, sentence)
    else:
        print_result(sentence, sentence)


def _lines(summary: dict[str, Any]) -> Iterator[str]:
    """The results of a run: claims, main numbers (in words if it has them), accuracies, files."""
    from host.runs.answers import lines
    from host.runs.claims import Claim

    for claim in summary["claims"]:
        yield Claim.from_dict(claim).sentence()
    if "as_table" in summary["numbers"]:
        yield summary["numbers"]["as_table"]
    elif summary["answers"]:
        yield from lines(summary["answers"])
    elif "in_words" in summary["numbers"]:
        yield summary["numbers"]["in_words"]
    else:
        for name, value in _single_values(summary["numbers"]):
            yield f"{name} {f'{value:.10g}' if isinstance(value, float) else value}"
    for kind, path in (
        ("table", _tables(summary)),
        ("numbers", summary["summary"]),
        *(("figure", path) for path in summary["figures"][:1]),
        *(("file", path) for path in summary["files"]),
    ):
        if path is not None:
            yield f"{kind} {path}"


def _tables(summary: dict[str, Any]) -> str | None:
    """The paths of a run's tables in one, as a shell has it: FOLDER/NAME-{KIND,KIND}.csv."""
    paths: list[str] = summary["tables"]
    if len(paths) < 2:
        return next(iter(paths), None)
    stem = f"{summary['folder']}/{summary['experiment']}-"
    kinds = (path.removeprefix(stem).removesuffix(".csv") for path in paths)
    return f"{stem}{{{','.join(kinds)}}}.csv"


def answer_run(
    options: argparse.Namespace,
    run: Callable[[], dict[str, Any]],
    as_json: Callable[[dict[str, Any]], dict[str, Any]] = lambda summary: summary,
) -> int:
    """Answer with the results of a run, also if ^C ends it while its figure is drawn.

    Args:
        options: Say whether to answer in JSON.
        run: Does it, and returns its summary.
        as_json: The summary as the JSON object to answer.

    Returns:
        0.

    Raises:
        NotDone: A claim does not hold, or the table or the summary is missing.
    """
    try:
        summary = run()
    except FigureInterrupted as interrupt:
        with suppress(NotDone):
            finish(options, interrupt.summary, as_json(interrupt.summary))
        raise
    return finish(options, summary, as_json(summary))


def finish(options: argparse.Namespace, summary: dict[str, Any], result: dict[str, Any]) -> int:
    """Answer with the results of a run, and say which of its files could not be written.

    Args:
        options: Say whether to answer in JSON.
        summary: The run's summary.
        result: The same as a JSON object.

    Returns:
        0.

    Raises:
        NotDone: A claim does not hold, or the table or the summary is missing.
    """
    from host.runs.claims import exit_status

    essentials = f"the results are in {summary['folder']}"
    if options.json:
        show(result, essentials)
    else:
        print_result("\n".join(_lines(summary)), essentials)
    for words in summary["unwritten"].values():
        say(f"kickctl: {words}")
    missing = [name for name in ("table", "summary") if name in summary["unwritten"]]
    if missing:
        raise NotDone(f"not written: {' and '.join(missing)}", "the same command tries it again")
    if exit_status(summary["claims"]):
        failed = [claim["id"] for claim in summary["claims"] if claim["holds"] is False]
        raise contradiction(failed)
    return 0


def contradiction(failed: Sequence[str]) -> NotDone:
    """What a command ends with if these claims, at least one, do not hold."""
    return NotDone(
        f"the measurement contradicts the paper: {', '.join(failed)}"
        f" {'does' if len(failed) == 1 else 'do'} not hold",
        f"`kickctl help {failed[0]}` says what it claims, docs/claims.md what we have found",
    )


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
