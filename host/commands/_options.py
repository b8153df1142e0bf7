"""Options that every verb has."""

import argparse
import itertools
from collections.abc import Sequence


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"'{text}' is no seed; give a whole number, 0 or more")
    return int(text)


def common(*, defaults: bool) -> argparse.ArgumentParser:
    """A parent parser with the options of every verb.

    The options may stand before the verb or after it, so only one of the places may set defaults.
    --set adds up, so that each place has a list of its own, set_before and set_after.
    """
    parser = argparse.ArgumentParser(
        add_help=False, argument_default=None if defaults else argparse.SUPPRESS
    )
    group = parser.add_argument_group("which robot, and how to answer")
    group.add_argument(
        "--brick",
        metavar="URI",
        help="sim://, tcp://HOST[:PORT], ssh://USER@HOST or serial:///dev/DEVICE",
    )
    group.add_argument(
        "--seed", type=_seed, metavar="N", help="fixes all chances of the simulated robot"
    )
    group.add_argument(
        "--set",
        action="append",
        dest="set_before" if defaults else "set_after",
        metavar="NAME=VALUE",
        help="a parameter of the embedded simulated robot, as in k=2.5; may be repeated",
    )
    group.add_argument("--token", metavar="FILE", help="the robot's token file")
    off = False if defaults else argparse.SUPPRESS
    group.add_argument(
        "--json",
        action="store_true",
        default=off,
        help="answer with one JSON object on standard output, also after an error",
    )
    return parser


def asks_for_json(arguments: Sequence[str]) -> bool:
    """Whether a command line that may be wrong asks for JSON. argparse takes `--js` for it, too."""
    options = itertools.takewhile(lambda argument: argument != "--", arguments)
    return any(len(one) > 2 and "--json".startswith(one) for one in options)
