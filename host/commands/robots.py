"""kickctl robots."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

from host.commands._parser import RawHelp
from host.commands._terminal import answer, say, show
from host.errors import WrongUse, quotable
from host.link import names, robots_file
from host.link.addresses import make_link, sim_options
from robot.token import TokenError, load

USES = ("token",)
HELP = (
    "give robots names: --brick NAME, --brick NAME,NAME and --brick all then work with every verb"
)
_DETAILS = """\
The names stand in ${XDG_CONFIG_HOME:-~/.config}/kickctl/robots.toml, which you may edit. A robot's
own token is the file tokens/NAME beside it, or the one that --token names; it moves with `rename`
and goes with `remove`, but a file elsewhere stays. Without one the usual token is used."""


# What each action takes.
_ACTIONS = {"list": "", "add": "NAME ADDRESS", "rename": "OLD NEW", "remove": "NAME"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the action and its names."""
    parser.formatter_class = RawHelp
    parser.epilog = _DETAILS
    parser.add_argument("action", choices=_ACTIONS, help="what to do with the names")
    takes = "; ".join(f"{action} {words}" for action, words in _ACTIONS.items() if words)
    parser.add_argument("words", nargs="*", metavar="NAME", help=takes)
    parser.add_argument(
        "--hardware-id",
        metavar="ID",
        help="add: what its machine says of itself, as deploy finds out; a robot that is known by"
        " it gets the new address instead of a second name",
    )


def run(options: argparse.Namespace) -> int:
    """List or change the robots that have a name."""
    takes = _ACTIONS[options.action]
    if len(options.words) != len(takes.split()):
        raise WrongUse(
            f"`kickctl robots {options.action}` takes {takes or 'no names'}",
            "for example: kickctl robots add anna tcp://ev3dev.local",
        )
    if options.token is not None and options.action != "add":
        raise WrongUse("--token belongs to `kickctl robots add`", "leave it out")
    if options.hardware_id is not None and options.action != "add":
        raise WrongUse("--hardware-id belongs to `kickctl robots add`", "leave it out")
    actions: dict[str, Callable[..., None]] = {
        "list": _list,
        "add": _add,
        "rename": _rename,
        "remove": _remove,
    }
    actions[options.action](options, *options.words)
    return 0


def _list(options: argparse.Namespace) -> None:
    robots = robots_file.read()
    if options.json:
        show({"robots": {one.name: _as_dict(one) for one in robots.values()}})
        return
    for one in robots.values():
        print(f"{one.name}  {one.address}  ({_token_words(one.token)})")
    if not robots:
        print("no robot has a name yet: kickctl robots add NAME ADDRESS")


def _as_dict(robot: robots_file.Known) -> dict[str, str | None]:
    return {"address": robot.address, "token": robot.token, "hardware_id": robot.hardware_id}


def _token_words(path: str | None) -> str:
    if path is None:
        return "no token of its own"
    return f"token {path}" if Path(path).exists() else f"its token {path} is missing"


def _add(options: argparse.Namespace, name: str, address: str) -> None:
    make_link(address)  # raises WrongUse if it is none
    if sim_options(address) is not None:
        raise WrongUse(
            "a simulated robot is a part of each command, and ends with it, so it has no name",
            "a robot that keeps running is one of its own: python -m sim_motor --port 5425",
        )
    if options.hardware_id is not None and not robots_file.is_hardware_id(options.hardware_id):
        raise WrongUse(
            f"'{quotable(options.hardware_id)}' is no hardware id",
            "it has 32 hexadecimal digits, which kickctl deploy finds out",
        )
    path = None if options.token is None else _checked(options.token)
    same = names.same_robot(options.hardware_id, address)
    if same is not None and (same.name, same.address) != (name, address):
        name = _moved(same, address, path)
    else:
        usual = robots_file.token_path(name)
        own = None if path in (None, usual) else str(path)
        robots_file.add(name, address, own, options.hardware_id)
    known = robots_file.read()[name]
    answer(
        options,
        {"name": name, **_as_dict(known)},
        f"{name} is {known.address} ({_token_words(known.token)})",
    )


def _moved(robot: robots_file.Known, address: str, token: Path | None) -> str:
    """A robot that has a name is at another address now. Returns the name."""
    changes = {"address": address}
    if token is not None and (robot.token is None or not _same_text(token, Path(robot.token))):
        changes["token"] = str(token)
    robots_file.update(robot.name, **changes)
    say(f"its hardware id is that of {robot.name}, which was at {robot.address}")
    return robot.name


def _same_text(one: Path, other: Path) -> bool:
    return other.is_file() and one.read_text().strip() == other.read_text().strip()


def _checked(token: str) -> Path:
    """The whole path of a token file. Raises WrongUse if it cannot be used."""
    path = Path(token).absolute()
    try:
        load(str(path))
    except TokenError as error:
        remedy = error.remedy or "name a file that holds the robot's token"
        raise WrongUse(error.why, f"{remedy}, then add the robot again") from error
    return path


def _rename(options: argparse.Namespace, old: str, new: str) -> None:
    robots_file.rename(old, new)
    answer(options, {"name": new, "was": old}, f"{old} is now {new}")


def _remove(options: argparse.Namespace, name: str) -> None:
    token = robots_file.remove(name)
    words = "" if token is None else f", and its token {token} is deleted"
    result = {"removed": name, "token": None if token is None else str(token)}
    answer(options, result, f"{name} is forgotten{words}")
