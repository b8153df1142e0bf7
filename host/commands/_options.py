"""Options that every verb has."""

import argparse
import itertools
from collections.abc import Sequence
from typing import Any

from host.errors import WrongUse
from host.util.numbers import Number

# The options for robots. Verbs that use only some of them say so in USES.
EVERY = ("brick", "seed", "set", "token", "name")
_REFUSED = {
    "brick": ("--brick chooses a robot, and `{}` reaches none", "leave it out"),
    "seed": ("--seed fixes chances, and `{}` has none", "leave it out"),
    "set": ("--set gives parameters to a simulated robot, and `{}` has none", "leave it out"),
    "token": ("--token opens a robot, and `{}` reaches none", "leave it out"),
    "name": ("--name says who drives a robot, and `{}` drives none", "leave it out"),
}
_SETS_ITSELF = (
    "--set gives parameters to a simulated robot, and `{}` sets those of its robots itself",
    "leave it out; {} --help shows what can be chosen",
)


def common(*, defaults: bool, used: Sequence[str] = EVERY) -> argparse.ArgumentParser:
    """A parent parser with the options of every verb.

    The options may stand before the verb or after it, so only one of the places may set defaults.
    --set adds up, so that each place has a list of its own, set_before and set_after.

    Args:
        defaults: Whether this place sets the defaults.
        used: Those of EVERY that the verb uses. Its help leaves the others out, and `refuse_unused`
            refuses them.
    """
    parser = argparse.ArgumentParser(
        add_help=False, argument_default=None if defaults else argparse.SUPPRESS
    )
    parser.set_defaults(used=tuple(used))
    group = parser.add_argument_group("which robot, and how to answer")

    def add(name: str, words: str, **more: Any) -> None:
        shown = words if name in used else argparse.SUPPRESS
        group.add_argument(f"--{name}", help=shown, **more)

    add(
        "brick", "sim://, tcp://HOST[:PORT], ssh://USER@HOST or serial:///dev/DEVICE", metavar="URI"
    )
    add(
        "seed",
        "fixes all chances of the simulation: a whole number, 0 or more",
        type=Number(least=0, whole=True),
        metavar="N",
    )
    add(
        "set",
        "a parameter of the embedded simulated robot, as in k=2.5; may be repeated",
        action="append",
        dest="set_before" if defaults else "set_after",
        metavar="NAME=VALUE",
    )
    add("token", "the robot's token file", metavar="FILE")
    add(
        "name",
        "who you are, for the robot and for other people (default: user@machine)",
        dest="own_name",
        metavar="TEXT",
    )
    off = False if defaults else argparse.SUPPRESS
    group.add_argument(
        "--json",
        action="store_true",
        default=off,
        help="answer with one JSON object on standard output, also after an error",
    )
    return parser


def refuse_unused(options: argparse.Namespace) -> None:
    """Raise WrongUse for an option that was given and that the verb does not use."""
    given = {
        "brick": options.brick is not None,
        "seed": options.seed is not None,
        "set": options.set_before or hasattr(options, "set_after"),
        "token": options.token is not None,
        "name": options.own_name is not None,
    }
    for name in EVERY:
        if given[name] and name not in options.used:
            itself = name == "set" and "brick" in options.used
            why, remedy = _SETS_ITSELF if itself else _REFUSED[name]
            raise WrongUse(why.format(options.command), remedy.format(options.command))


def add_take_over(parser: argparse.ArgumentParser) -> None:
    """Add --take-over, for verbs that drive the robot."""
    parser.add_argument(
        "--take-over",
        action="store_true",
        help="take control from who drives the robot now; they hear that you did",
    )


def asks_for_json(arguments: Sequence[str]) -> bool:
    """Whether a command line that may be wrong asks for JSON. argparse takes `--js` for it, too."""
    options = itertools.takewhile(lambda argument: argument != "--", arguments)
    return any(len(one) > 2 and "--json".startswith(one) for one in options)
