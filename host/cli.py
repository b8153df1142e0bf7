"""kickctl: one verb a module in host.commands. Nothing heavy is imported before a verb runs."""

from __future__ import annotations

import _thread
import argparse
import importlib
import json
import os
import signal
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress

from host.commands._options import common
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
Exit status: 0 it worked; 1 tried, and the robot did not do it; 2 wrong use; 3 no link to the robot;
4 refused (version, token, lease); 5 fault on the robot."""


def make_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    parser = argparse.ArgumentParser(
        prog="kickctl",
        description="Kick a robot from one of its attractors into another.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        parents=[common(defaults=True)],
    )
    parser.add_argument("--version", action="version", version=f"kickctl {__version__}")
    verbs = parser.add_subparsers(metavar="VERB", required=True)
    for name in VERBS:
        module = importlib.import_module("host.commands." + name)
        verb = verbs.add_parser(
            name, help=module.HELP, description=module.HELP, parents=[common(defaults=False)]
        )
        module.add_arguments(verb)
        verb.set_defaults(run=module.run, verb=name)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb. Returns the exit status."""
    parser = make_parser()
    if "_ARGCOMPLETE" in os.environ:
        import argcomplete

        argcomplete.autocomplete(parser)
    if threading.current_thread() is threading.main_thread():
        # On SIGTERM, too, a verb that moves the robot stops it, and a log is closed.
        signal.signal(signal.SIGTERM, _interrupt)
    options = parser.parse_args(
        _join_negative(sys.argv[1:] if arguments is None else list(arguments))
    )
    hook, sys.unraisablehook = sys.unraisablehook, _interrupt_again
    try:
        _give_params(options)
        status = int(options.run(options))
        sys.stdout.flush()
        return status
    except KickctlError as error:
        if options.json:
            print(
                json.dumps(
                    {
                        "error": {
                            "message": error.message,
                            "hint": error.hint,
                            "status": error.status,
                        }
                    },
                    allow_nan=False,
                )
            )
        print(
            f"kickctl: {error.message}" + (f"\n  {error.hint}" if error.hint else ""),
            file=sys.stderr,
        )
        return error.status
    except BrokenPipeError:
        _drop_output()
        return 1
    except OSError as error:
        _drop_output()
        place = f"{error.filename} " if error.filename else ""
        message = f"{place}cannot be written or read: {error.strerror or error}"
        if options.json:
            print(
                json.dumps(
                    {"error": {"message": message, "hint": "is the disk full?", "status": 1}},
                    allow_nan=False,
                )
            )
        print(f"kickctl: {message}\n  is the disk full?", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("kickctl: interrupted", file=sys.stderr)
        return 130
    finally:
        sys.unraisablehook = hook


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


def _drop_output() -> None:
    """Nobody reads the output any more: send the interpreter's last flush to nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _interrupt(number: int, frame: object) -> None:
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
