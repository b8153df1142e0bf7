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
    "seed": ("--seed is for what is random, and nothing in `{}` is", "leave it out"),
    "set": ("--set gives parameters to a simulated robot, and `{}` has none", "leave it out"),
    "token": ("--token opens a robot, and `{}` reaches none", "leave it out"),
    "name": ("--name says who drives a robot, and `{}` drives none", "leave it out"),
}
# What to do about one that was given twice; --set may be.
_TWICE = {
    "brick": "name several robots with commas between them: --brick anna,bert",
    "seed": "leave one of them out",
    "token": "leave one of them out",
    "name": "leave one of them out",
}
# The attribute that an option sets, where it has not the option's name.
_ATTRIBUTES = {"name": "own_name"}
_SETS_ITSELF = (
    "--set gives parameters to a simulated robot, and `{}` sets those of its robots itself",
    "leave it out; {} --help shows what can be chosen",
)


def common(*, defaults: bool, used: Sequence[str] = EVERY) -> argparse.ArgumentParser:
    """A parent parser with the options of every verb.

    The options may stand before the verb or after it, so only one of the places may set defaults.
    What they are given adds up in a list for each place, such as set_before and set_after, which
    `join_places` joins.

    Args:
        defaults: Whether this place sets the defaults.
        used: Those of EVERY that the verb uses. Its help leaves the others out, and `refuse_unused`
            refuses them.
    """
    parser = argparse.ArgumentParser(
        add_help=False, argument_default=None if defaults else argparse.SUPPRESS
    )
    parser.set_defaults(used=tuple(used))
    place = "before" if defaults else "after"
    group = parser.add_argument_group("which robot, and how to answer")

    def add(name: str, words: str, **more: Any) -> None:
        shown = words if name in used else argparse.SUPPRESS
        group.add_argument(f"--{name}", help=shown, action="append", dest=f"{name}_{place}", **more)

    add(
        "brick",
        "a name (see kickctl robots), sim://, tcp://HOST[:PORT], ssh://USER@HOST or"
        " serial:///dev/DEVICE; some verbs take several names, anna,bert, or all",
        metavar="ROBOT",
    )
    add(
        "seed",
        "random seed of the simulation: the same seed gives the same run. A whole number",
        type=Number(least=0, whole=True),
        metavar="N",
    )
    add(
        "set",
        "a parameter of the embedded simulated robot, as in k=2.5; may be repeated",
        metavar="NAME=VALUE",
    )
    add("token", "the robot's token file", metavar="FILE")
    add(
        "name",
        "who you are, for the robot and for other people (default: user@machine)",
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


def join_places(options: argparse.Namespace) -> None:
    """Give each common option what stood before the verb and after it; --set is a list.

    Raises:
        WrongUse: One of them was given twice, and the last one would count silently.
    """
    for name in EVERY:
        places = (getattr(options, f"{name}_{place}", None) for place in ("before", "after"))
        given = [value for values in places for value in values or ()]
        if name != "set" and len(given) > 1:
            raise WrongUse(f"--{name} is given twice", _TWICE[name])
        value = given if name == "set" else given[0] if given else None
        setattr(options, _ATTRIBUTES.get(name, name), value)


def refuse_unused(options: argparse.Namespace) -> None:
    """Raise WrongUse for an option that was given and that the verb does not use."""
    for name in EVERY:
        value = getattr(options, _ATTRIBUTES.get(name, name))
        if value not in (None, []) and name not in options.used:
            itself = name == "set" and "brick" in options.used
            why, remedy = _SETS_ITSELF if itself else _REFUSED[name]
            raise WrongUse(why.format(options.command), remedy.format(options.command))


def add_take_over(parser: argparse.ArgumentParser) -> None:
    """Add --take-over, for verbs that drive the robot."""
    parser.add_argument(
        "--take-over",
        action="store_true",
        help="take control from whoever drives the robot now; their program says that you did",
    )


def asks_for_json(arguments: Sequence[str]) -> bool:
    """Whether a command line that may be wrong asks for JSON. argparse takes `--js` for it, too."""
    options = itertools.takewhile(lambda argument: argument != "--", arguments)
    return any(len(one) > 2 and "--json".startswith(one) for one in options)
