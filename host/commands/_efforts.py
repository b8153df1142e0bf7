"""Options that fit an experiment on a robot into a time, and the question before a long one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from typing import Any

from host.commands._terminal import say
from host.errors import NotDone, WrongUse
from host.experiments.efforts import EFFORTS, QUICK_MINUTES, in_words, quick_minutes, size
from host.runs.registry import Entry, options_given
from host.util.numbers import Number

# A real robot is busy for longer than this only after somebody has agreed.
ASK_S = 60.0
LONGEST_MINUTES = 10080.0  # a week


def add_effort(parser: argparse.ArgumentParser, name: str, entry: Entry) -> None:
    """Add --minutes, --quick and --yes to an experiment on a robot; nothing to another one.

    An experiment that has --minutes of its own, for its length, keeps that.
    """
    if name not in EFFORTS:
        return
    option = EFFORTS[name].option
    times = parser.add_mutually_exclusive_group()
    if option != "minutes":
        times.add_argument(
            "--minutes",
            type=Number("minutes", 0.001, LONGEST_MINUTES),
            metavar="N",
            help=f"choose {option} so that it takes N minutes on a robot",
        )
    times.add_argument(
        "--quick",
        action="store_true",
        help=f"choose {option} so that it takes {QUICK_MINUTES:g} minutes on a robot, or as little"
        " as it can",
    )
    parser.add_argument(
        "--yes", action="store_true", help="start on a real robot without asking, however long"
    )


def sized(options: argparse.Namespace, name: str, entry: Entry) -> dict[str, Any]:
    """The options that --minutes or --quick chooses, by name; empty without these.

    Raises:
        WrongUse: It is given as well, or the experiment cannot be as short.
    """
    if name not in EFFORTS:
        return {}
    option = EFFORTS[name].option
    minutes = None if option == "minutes" else options.minutes
    flag = "--minutes"
    given = options_given(options, entry)
    if swept := [key for key, value in given.items() if isinstance(value, list)]:
        if options.quick or minutes is not None:
            raise WrongUse(
                f"{flag if minutes is not None else '--quick'} sizes one run, and --{swept[0]} has"
                " several values",
                f"leave it out, and say how large each run is with --{option}",
            )
        return {}
    if options.quick:
        minutes, flag = quick_minutes(name, entry, given), "--quick"
    if minutes is None:
        return {}
    if option in given:
        raise WrongUse(f"{flag} chooses --{option}, and --{option} is given too", "leave one out")
    return size(name, entry, minutes, given)


def question(options: argparse.Namespace) -> Callable[[float], None]:
    """What to do before a real robot is busy for some seconds: ask, if it is long.

    Nobody is asked without a terminal, or with --yes.
    """

    def ask(seconds: float) -> None:
        if seconds <= ASK_S or options.yes or not (sys.stdin.isatty() and sys.stderr.isatty()):
            return
        say(f"The robot will be busy for {in_words(seconds)}. Start? [Y/n]")
        line = sys.stdin.readline()
        # Nothing at all, not even an Enter, is the end of the input and no consent.
        if not line or line.strip().lower() not in ("", "y", "yes"):
            raise NotDone(
                "not started, as you wished",
                "--minutes N or --quick make it shorter, --yes starts it without a question",
            )

    return ask
