"""kickctl: one verb a module in host.commands. Nothing heavy is imported before a verb runs."""

from __future__ import annotations

import _thread
import argparse
import importlib
import io
import os
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stdout, suppress
from typing import Any, NoReturn

from host.commands._options import asks_for_json, common
from host.commands._streams import drop_output, prepare
from host.errors import KickctlError, WrongUse
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
    "params",
    "record",
    "watch",
    "log",
    "doctor",
    "discover",
    "deploy",
    "experiment",
    "theory",
    "body",
    "rods",
    "reproduce",
)
# Verbs that reach no robot by its address.
_WITHOUT_ROBOT = ("discover", "deploy", "theory", "body", "rods")

_EPILOG = """\
Without --brick (or KICK_BRICK) the robot is simulated, embedded in this program.
Exit status: 0 it worked; 1 tried, and not or not wholly done; 2 wrong use; 3 no link to the robot;
4 refused (version, token, lease); 5 fault on the robot; 130 interrupted."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        """Raise WrongUse, so that a wrong command line is answered like every other error."""
        raise WrongUse(message, f"see {self.prog} --help")


def make_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line. It raises WrongUse for one that is wrong."""
    parents: list[Any] = [common(defaults=True)]
    parser = _Parser(
        prog="kickctl",
        description="Kick a robot from one of its attractors into another.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        parents=parents,
    )
    parser.add_argument("--version", action="version", version=f"kickctl {__version__}")
    verbs: Any = parser.add_subparsers(metavar="VERB", required=True)
    for name in VERBS:
        module = importlib.import_module("host.commands." + name)
        verb = verbs.add_parser(
            name, help=module.HELP, description=module.HELP, parents=[common(defaults=False)]
        )
        module.add_arguments(verb)
        verb.set_defaults(run=module.run, verb=name)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb.

    Args:
        arguments: The command line without the program's name; None for that of this process.

    Returns:
        The exit status.
    """
    if arguments is None:
        prepare()
        arguments = sys.argv[1:]
    try:
        with _interruptible():
            return _run(list(arguments))
    except BrokenPipeError:
        drop_output()
        return 1
    except BaseException as error:  # noqa: BLE001 - _report raises again what has no words
        return _report(error, in_json=asks_for_json(arguments))


def _run(arguments: list[str]) -> int:
    # Where verbs fail, their imports must not: whatever they print is what this room counts.
    from host.commands._terminal import begin, show

    begin()
    parser = make_parser()
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        argcomplete.autocomplete(parser)
    help_text = io.StringIO()
    try:
        with redirect_stdout(help_text):
            options = parser.parse_args(_join_negative(arguments))
    except SystemExit:  # after --help and --version
        if asks_for_json(arguments):
            show({"text": help_text.getvalue()})
        else:
            print(help_text.getvalue(), end="", flush=True)
        return 0
    _give_params(options)
    status = int(options.run(options))
    sys.stdout.flush()
    return status


def _report(error: BaseException, *, in_json: bool) -> int:
    """Say what ended the command: as JSON if asked for, and in words on standard error.

    Returns:
        The exit status.
    """
    from host.commands._failures import in_words
    from host.commands._terminal import answered, say, show

    failure = in_words(error)
    if failure is None:
        raise error
    if isinstance(error, OSError) and error.filename is None:
        drop_output()
    elif in_json and not answered():
        with suppress(OSError):
            show({"error": _as_dict(failure)})
    say(f"kickctl: {failure.message}" + (f"\n  {failure.hint}" if failure.hint else ""))
    return failure.status


def _as_dict(failure: KickctlError) -> dict[str, str | int]:
    return {"message": failure.message, "hint": failure.hint, "status": failure.status}


def _give_params(options: argparse.Namespace) -> None:
    """Turn --set into a part of the simulated robot's address. Raises WrongUse."""
    settings = [*(options.set_before or ()), *getattr(options, "set_after", ())]
    if not settings:
        return
    if options.verb in _WITHOUT_ROBOT:
        raise WrongUse(
            f"--set gives parameters to a simulated robot, and `kickctl {options.verb}` has none",
            f"see kickctl {options.verb} --help for its own options",
        )
    from host.link.addresses import chosen, with_params

    options.brick = with_params(chosen(options.brick), settings)


@contextmanager
def _interruptible() -> Iterator[None]:
    """Let SIGTERM, and a terminal that closes (SIGHUP), do what ^C does.

    So a verb that moves the robot stops it, and a log is closed. Each of these signals works once:
    a closing terminal often sends its own twice, and the second one would disturb the closing. Who
    ignores them, as nohup does, goes on ignoring them.
    """
    hook, sys.unraisablehook = sys.unraisablehook, _interrupt_again
    before = {}
    try:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGTERM, signal.SIGHUP):
                if signal.getsignal(number) is not signal.SIG_IGN:
                    before[number] = signal.signal(number, _interrupt)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        sys.unraisablehook = hook


def _interrupt(number: int, frame: object) -> None:
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def _interrupt_again(lost: sys.UnraisableHookArgs) -> None:
    """Raise an interrupt again that came within a destructor, which Python ignores there."""
    if lost.exc_type is KeyboardInterrupt:
        again = threading.Timer(0.05, _thread.interrupt_main)
        again.daemon = True
        again.start()
    else:
        sys.__unraisablehook__(lost)


def _join_negative(arguments: list[str]) -> list[str]:
    """Write '--shift -3pi/4' as '--shift=-3pi/4': argparse takes a negative angle for an option."""
    joined: list[str] = []
    for argument in arguments:
        if (
            joined
            and joined[-1] in ("--shift", "--value", "--delta")
            and argument[:1] == "-"
            and argument[1:2] not in ("-", "")
        ):
            joined[-1] += "=" + argument
        else:
            joined.append(argument)
    return joined
