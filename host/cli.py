"""kickctl: one verb a module in host.commands. Nothing heavy is imported before a verb runs."""

from __future__ import annotations

import argparse
import gc
import importlib
import io
import os
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout, suppress
from functools import cache
from typing import Any

from host.commands._options import EVERY, asks_for_json, common, join_places, refuse_unused
from host.commands._parser import Parser, RawHelp, join_negative
from host.commands._signals import Interrupts, interruptible
from host.commands._streams import OUTPUT, drop_output, prepare
from host.errors import Interrupted
from host.util.own_name import choose
from robot import __version__

VERBS = (
    "demo",
    "kick",
    "plan",
    "drive",
    "start",
    "stop",
    "clear",
    "status",
    "identify",
    "params",
    "record",
    "watch",
    "lab",
    "foxglove",
    "log",
    "doctor",
    "discover",
    "robots",
    "deploy",
    "experiment",
    "theory",
    "body",
    "rods",
    "reproduce",
    "help",
)

# How many new objects make Python look for garbage. By itself it looks after 700, and what a verb
# imports is some 300,000 that stay. Looking through far more at once would keep a stop waiting.
NEW_OBJECTS = 10_000

# `stop` waits for nothing, `watch` has one table, `lab` one page and `foxglove` one server, so they
# have ways of their own with several robots; `deploy` says itself that it has no robot.
_OWN_WAYS = ("stop", "watch", "lab", "foxglove", "deploy")

_EPILOG = """\
Without --brick (or KICK_BRICK) the robot is simulated, embedded in this program.
`kickctl VERB --help` ends with an example, how long it takes on two idle cores, and a page of the
docs. The first run after an installation takes up to half a minute more.
Exit status: 0 it worked; 1 tried, and not or not wholly done; 2 wrong use; 3 no link to the robot;
4 refused (version, token, lease); 5 fault on the robot; 130 interrupted (but 0 for `watch`)."""


@cache
def make_parser(needed: tuple[str, ...] = VERBS) -> argparse.ArgumentParser:
    """The parser of the whole command line. It raises WrongUse for one that is wrong.

    Args:
        needed: The verbs whose options it knows; of others it knows only the names. Importing all
            verbs takes longer than a stop.
    """
    parents: list[Any] = [common(defaults=True)]
    parser = Parser(
        prog="kickctl",
        description="Kick a robot from one of its attractors into another.",
        epilog=_EPILOG,
        formatter_class=RawHelp,
        parents=parents,
    )
    parser.add_argument("--version", action="version", version=f"kickctl {__version__}")
    verbs: Any = parser.add_subparsers(metavar="VERB", required=True)
    for name in VERBS:
        if name not in needed:
            verbs.choices[name] = None
            continue
        module = importlib.import_module("host.commands." + name)
        verb = verbs.add_parser(
            name,
            help=module.HELP,
            description=module.HELP,
            parents=[common(defaults=False, used=getattr(module, "USES", EVERY))],
        )
        module.add_arguments(verb)
        verb.set_defaults(
            module=module,
            verb=name,
            in_one_line=getattr(module, "in_one_line", None),
            whole_parser=make_parser,
        )
    return parser


def _needed(arguments: list[str]) -> tuple[str, ...]:
    """The verbs that stand in a command line.

    All of them for help that may be that of the program, and for what completes a line.
    """
    named = tuple(name for name in VERBS if name in arguments)
    helps = any(argument.startswith(("-h", "--h")) for argument in arguments)
    all_ = "_ARGCOMPLETE" in os.environ or (helps and arguments[0] not in VERBS)
    return VERBS if all_ else named or VERBS


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb.

    Args:
        arguments: The command line without the program's name; None for that of this process.

    Returns:
        The exit status.
    """
    process_ends = arguments is None
    if arguments is None:
        prepare()
        gc.set_threshold(NEW_OBJECTS)
        arguments = sys.argv[1:]
    with interruptible(process_ends=process_ends) as interrupts:
        try:
            return _run(list(arguments))
        except BaseException as error:  # noqa: BLE001 - _report raises again what has no words
            interrupts.rest()
            return _report(error, interrupts, in_json=asks_for_json(arguments))


def _run(arguments: list[str]) -> int:
    # Where verbs fail, their imports must not: what they print is what this room counts.
    from host.commands._hints import name_robot
    from host.commands._terminal import begin, print_answer, print_result, show

    begin()
    parser = make_parser(_needed(arguments))
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        argcomplete.autocomplete(parser)
    help_text = io.StringIO()
    try:
        with redirect_stdout(help_text):
            options = parser.parse_args(join_negative(arguments))
    except SystemExit:  # after --help and --version
        if asks_for_json(arguments):
            show({"text": help_text.getvalue()})
            print_answer(None)
        else:
            print_result(help_text.getvalue().removesuffix("\n"))
        return 0
    join_places(options)
    refuse_unused(options)
    name_robot(options.brick, options.token)
    choose(options.own_name)
    _give_params(options)
    status = _run_verb(options)
    print_answer(None)
    sys.stdout.flush()
    return status


def _run_verb(options: argparse.Namespace) -> int:
    """Run the verb on its robot, or on several side by side."""
    text = options.brick or os.environ.get("KICK_BRICK", "")
    reaches_one = "brick" in options.used and options.verb not in _OWN_WAYS
    if reaches_one and (text == "all" or "," in text):
        from host.commands._side_by_side import on_each
        from host.link.names import is_several

        if is_several(text):
            return on_each(options, text, options.in_one_line)
    return int(options.module.run(options))


def _report(error: BaseException, interrupts: Interrupts, *, in_json: bool) -> int:
    """Say what ended the command: under `error` of the JSON object, and in words.

    Returns:
        The exit status.
    """
    from host.commands._failures import in_words
    from host.commands._terminal import print_answer, say

    failure = in_words(error)
    if failure is None:
        with suppress(OSError):
            print_answer(None)
        raise error
    status = failure.status
    if isinstance(error, OSError) and error.filename == OUTPUT:
        drop_output()
        status = Interrupted.status if interrupts.came else status
        if isinstance(error, BrokenPipeError) and not failure.hint:
            return status  # the reader has seen enough
    elif in_json:
        try:
            print_answer(failure)
        except OSError as lost:
            _report(lost, interrupts, in_json=True)
    say(f"kickctl: {failure.message}" + (f"\n  {failure.hint}" if failure.hint else ""))
    return status


def _give_params(options: argparse.Namespace) -> None:
    """Turn --set into a part of the simulated robot's address. Raises WrongUse."""
    if options.set:
        from host.link.addresses import with_params
        from host.link.names import address_of

        options.brick = with_params(address_of(options.brick), options.set)
