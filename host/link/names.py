"""Which robot a person means: by its name, by its address, or by nothing."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches

from host.errors import WrongUse, quotable
from host.link import robots_file
from host.link.addresses import FORMS, SIM, place_of, sim_options
from host.util.arguments import need_text

ALL = "all"


@dataclass(frozen=True)
class Chosen:
    """A robot that was named.

    Attributes:
        name: Its name; its address if it has no name.
        address: Its address.
        token: The path of its own token file; None if it has none that is known.
    """

    name: str
    address: str
    token: str | None = None


def chosen(text: str | None) -> Chosen:
    """The robot to use: the one named, else that of $KICK_BRICK, else the embedded simulated one.

    Args:
        text: A name or an address.

    Raises:
        WrongUse: It is neither, or empty, or it means several robots. A shell's variable that is
            not set is empty, and whoever named a robot must not get a simulated one.
    """
    text = named(text)
    if text is None:
        return Chosen(SIM, SIM)
    if is_several(text):
        raise WrongUse(
            f"'{quotable(text)}' means several robots, and one is wanted here",
            "name one robot: those with a name are listed by `kickctl robots list`",
        )
    return _find(text)


def address_of(text: str | None) -> str:
    """The address of `chosen(text)`."""
    return chosen(text).address


def named(text: str | None) -> str | None:
    """What names the robot: the text, else $KICK_BRICK; None if there is neither.

    Raises:
        WrongUse: It is no text, or empty.
    """
    if text is not None:
        if text == "":
            raise WrongUse(
                "the robot's address is empty",
                f"name the robot, or leave its address out for a simulated one; {FORMS}",
            )
        return need_text("the robot's address", text, f"text; {FORMS}")
    from_shell = os.environ.get("KICK_BRICK")
    if from_shell == "":
        raise WrongUse(
            "KICK_BRICK is set, and it is empty",
            "give it the robot's name or address, or type `unset KICK_BRICK` for a simulated robot",
        )
    return from_shell


def is_several(text: str) -> bool:
    """Whether a text means several robots: 'all', or names with commas between them."""
    return text == ALL or ("," in text and "://" not in text.partition(",")[0])


def several(text: str) -> list[Chosen]:
    """The robots that a text means.

    Args:
        text: 'all', or names with commas between them.

    Raises:
        WrongUse: One of them is unknown or named twice, or no robot has a name yet.
    """
    if text == ALL:
        return every()
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if not name:
            raise WrongUse(f"a name is missing in '{quotable(text)}'", "write it as in anna,bert")
        if names.count(name) > 1:
            raise WrongUse(f"'{quotable(name)}' stands twice in '{quotable(text)}'", "name it once")
    return [_find(name) for name in names]


def every() -> list[Chosen]:
    """All robots that have a name.

    Raises:
        WrongUse: None has one.
    """
    robots = [Chosen(one.name, one.address, one.token) for one in robots_file.read().values()]
    if not robots:
        raise WrongUse(
            "no robot has a name on this computer yet",
            "give it one: kickctl robots add NAME ADDRESS, or kickctl discover --save",
        )
    return robots


def _find(text: str) -> Chosen:
    """The robot of a name or an address. Raises WrongUse."""
    if not robots_file.is_name(text):
        return Chosen(text, text, None)
    robots = robots_file.read()
    if text not in robots:
        close = get_close_matches(text, [*robots, ALL], 1) if robots else []
        known = f"there are {', '.join(robots)}" if robots else "no robot has a name yet"
        raise WrongUse(
            f"no robot is named '{text}', and it is no address of one",
            f"did you mean {close[0]}?" if close else f"{known}; {FORMS}",
        )
    found = robots[text]
    return Chosen(found.name, found.address, found.token)


def own_token(robot: Chosen) -> str | None:
    """The token file of a robot: its own, or that of a robot with a name at the same place."""
    if robot.token is not None or sim_options(robot.address) is not None:
        return robot.token
    return next((one.token for one in _at(robot.address) if one.token is not None), None)


def name_at(address: str) -> str:
    """The name of the robot at an address; empty if none is known."""
    try:
        return "" if address.startswith(SIM) else next((one.name for one in _at(address)), "")
    except WrongUse:  # a spoiled file of names keeps nobody from a robot whose address is known
        return ""


def _at(address: str) -> Iterator[robots_file.Known]:
    """The robots with a name that are at the place of an address."""
    place = place_of(address)
    return (one for one in robots_file.read().values() if _is_at(place, one.address))


def save(found: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Give names to robots that have none yet.

    Args:
        found: (name, address) of each. A name that is taken, or none, is changed.

    Returns:
        The addresses that are new, by their names.
    """
    saved: dict[str, str] = {}
    for wanted, address in found:
        if next(_at(address), None) is None:
            name = robots_file.free_name(wanted, robots_file.read())
            robots_file.add(name, address)
            saved[name] = address
    return saved


def _is_at(place: tuple[str, str], address: str) -> bool:
    try:
        return place_of(address) == place
    except WrongUse:  # in the file, where it harms nobody who names another robot
        return False
