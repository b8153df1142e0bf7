"""A verb on several robots side by side: a line for each, and one JSON object for all.

Each robot has a process of its own, forked from this one, so that a verb does there what it does
alone: it stops its robot when it is interrupted, and closes its log.
"""

from __future__ import annotations

import argparse
import json
import os
import selectors
import signal
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from typing import Any, NamedTuple

from host.commands._failures import in_words
from host.commands._hints import name_robot
from host.commands._streams import prepare
from host.commands._terminal import as_dict, print_answer, print_result, say, show
from host.errors import KickctlError, NotDone, WrongUse
from host.link.names import several
from host.link.robots_file import Known

InOneLine = Callable[[dict[str, Any]], str]


class Outcome(NamedTuple):
    """What came of a verb on one robot: its name, the result for JSON, a line, the exit status."""

    name: str
    result: dict[str, Any]
    line: str
    status: int


def failed(name: str, failure: KickctlError) -> Outcome:
    """The outcome of a verb that ended in an error."""
    return Outcome(name, {"error": as_dict(failure)}, failure.message, failure.status)


def show_each(options: argparse.Namespace, names: list[str], outcomes: Iterable[Outcome]) -> int:
    """Print a line for each robot as soon as it is known; in JSON all at the end.

    Args:
        options: Say whether to answer in JSON.
        names: The robots, in the order in which JSON has them.
        outcomes: One for each of them, in any order.

    Returns:
        The exit status: the highest of all.
    """
    found: dict[str, Outcome] = {}
    for outcome in outcomes:
        found[outcome.name] = outcome
        if not options.json:
            line = f"{outcome.name}: {outcome.line}"
            print_result(line, line)
            hint = outcome.result.get("error", {}).get("hint")
            if hint:
                say(f"  {hint}")
    if options.json:
        show({"robots": {name: found[name].result for name in names if name in found}})
    return max((outcome.status for outcome in found.values()), default=0)


def on_each(options: argparse.Namespace, text: str, in_one_line: InOneLine | None) -> int:
    """Run the verb of the options on several robots.

    Args:
        options: The verb and its arguments.
        text: The robots, as `host.link.names.several` takes them.
        in_one_line: A robot's result as one line; None if the verb takes one robot only.

    Returns:
        The exit status: the highest of all.

    Raises:
        WrongUse: Nothing was done.
    """
    if in_one_line is None:
        raise WrongUse(
            f"the verb {options.verb} takes one robot at a time, and several are named",
            "name one of them",
        )
    if getattr(options, "out", None) is not None:
        raise WrongUse("--out names one file, and each robot needs its own", "leave --out out")
    robots = several(text)
    runs = [_Run(robot, options) for robot in robots]
    return show_each(options, [robot.name for robot in robots], _follow(runs, in_one_line))


class _Run:
    """The process of one robot, and what it has printed so far."""

    def __init__(self, robot: Known, options: argparse.Namespace) -> None:
        self.robot = robot
        self.out = b""
        self._words = b""
        sys.stdout.flush()
        out, out_end = os.pipe()
        err, err_end = os.pipe()
        self.pid = os.fork()
        if self.pid == 0:
            # An interrupt at the terminal comes to the first process, which hands it on once.
            os.setpgid(0, 0)
            os.dup2(out_end, 1)
            os.dup2(err_end, 2)
            _run_alone(robot, options)
        for end in (out_end, err_end):
            os.close(end)
        self.pipes = {out: self._take_output, err: self._take_words}

    def _take_output(self, data: bytes) -> None:
        self.out += data

    def _take_words(self, data: bytes) -> None:
        *lines, self._words = (self._words + data).split(b"\n")
        if not data and self._words:
            lines.append(self._words)
        for line in lines:
            say(f"{self.robot.name}: {line.decode(errors='backslashreplace')}")

    def outcome(self, in_one_line: InOneLine) -> Outcome:
        """Wait for the end of the process, which has closed its output."""
        status = os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])
        name = self.robot.name
        try:
            result = json.loads(self.out)
        except ValueError:
            why = f"its process ended with status {status} and no result"
            return failed(name, NotDone(why, "the lines above say why"))
        try:
            line = in_one_line(result)
        except KeyError:  # there is nothing but an error
            line = result["error"]["message"]
        return Outcome(name, {"brick": self.robot.address, **result}, line, status)


def _run_alone(robot: Known, options: argparse.Namespace) -> None:
    """Run the verb in a process of its own, which ends here."""
    status = 1
    try:
        prepare()
        # Two ssh cannot ask for passwords at one terminal.
        options_of_ssh = os.environ.get("KICK_SSH_OPTIONS", "")
        os.environ["KICK_SSH_OPTIONS"] = f"{options_of_ssh} -o BatchMode=yes"
        options.brick, options.json = robot.name, True
        name_robot(robot.name, options.token)
        status = int(options.module.run(options))
        print_answer(None)
    except BaseException as error:  # noqa: BLE001 - nothing may return into the copy of a parent
        failure = in_words(error)
        if failure is None:
            import traceback

            traceback.print_exc()
        else:
            status = failure.status
            print_answer(failure)
    finally:
        with suppress(OSError, ValueError):
            sys.stdout.flush()
        os._exit(status)


def _follow(runs: list[_Run], in_one_line: InOneLine) -> Iterator[Outcome]:
    """Hand on what the processes say, and yield each one's outcome when it has ended."""
    with selectors.DefaultSelector() as waiting:
        for run in runs:
            for pipe in run.pipes:
                waiting.register(pipe, selectors.EVENT_READ, run)
        while waiting.get_map():
            try:
                ready = waiting.select()
            except KeyboardInterrupt:
                for run in runs:
                    if run.pipes:
                        os.kill(run.pid, signal.SIGINT)
                continue
            for key, _ in ready:
                run = key.data
                data = os.read(key.fd, 65536)
                run.pipes[key.fd](data)
                if not data:
                    waiting.unregister(key.fd)
                    os.close(key.fd)
                    del run.pipes[key.fd]
                    if not run.pipes:
                        yield run.outcome(in_one_line)
