"""Which robot a person means: by its name, by its address, or by nothing."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from difflib import get_close_matches
from ipaddress import ip_address
from typing import TYPE_CHECKING, NamedTuple

from host.errors import WrongUse, quotable
from host.link import robots_file
from host.link.addresses import FORMS, SIM, make_link, place_of, sim_options, with_host
from host.link.robots_file import Known
from host.link.transport import Link, Meant
from host.util.arguments import need_text

if TYPE_CHECKING:
    from host.link.discovery import Found

ALL = "all"
# An address behind a comma; a comma may also stand within one of these.
_ADDRESS = re.compile(r",\s*[a-z]+://")
_WITH_COMMA = re.compile(r"serial://|[a-z]+://[^,]*\?")


def chosen(text: str | None) -> Known:
    """The robot to use: the one named, else that of $KICK_BRICK, else the embedded simulated one.

    Args:
        text: A name or an address.

    Raises:
        WrongUse: It is neither, or empty, or it means several robots. A shell's variable that is
            not set is empty, and whoever named a robot must not get a simulated one.
    """
    text = named(text)
    if text is None:
        return Known(SIM, SIM)
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
    """Whether a text means several robots: 'all', or names or addresses with commas between."""
    first, comma, rest = text.partition(",")
    within = _WITH_COMMA.match(first)
    return text == ALL or bool(comma and (not within or _ADDRESS.search("," + rest)))


def several(text: str) -> list[Known]:
    """The robots that a text means.

    Args:
        text: 'all', or names or addresses with commas between them.

    Raises:
        WrongUse: One of them is unknown or named twice, or no robot has a name yet.
    """
    if text == ALL:
        return every()
    names = [name.strip() for name in text.split(",")]
    for name in names:
        if not name:
            raise WrongUse(f"a name is missing in '{quotable(text)}'", "write it as in anna,bert")
        if name == ALL:
            raise WrongUse(f"'{ALL}' stands for all robots with a name", f"write {ALL} alone")
        if names.count(name) > 1:
            raise WrongUse(f"'{quotable(name)}' stands twice in '{quotable(text)}'", "name it once")
    return [_find(name) for name in names]


def every() -> list[Known]:
    """All robots that have a name.

    Raises:
        WrongUse: None has one.
    """
    robots = list(robots_file.read().values())
    if not robots:
        raise WrongUse(
            "no robot has a name on this computer yet",
            "give it one: kickctl robots add NAME ADDRESS, or kickctl discover --save",
        )
    return robots


def _find(text: str) -> Known:
    """The robot of a name or an address. Raises WrongUse."""
    if not robots_file.is_name(text):
        return Known(text, text)
    robots, spoiled = robots_file.read_sound()
    if text not in robots:
        if spoiled is not None:
            raise spoiled
        close = get_close_matches(text, [*robots, ALL], 1) if robots else []
        known = f"there are {', '.join(robots)}" if robots else "no robot has a name yet"
        raise WrongUse(
            f"no robot is named '{text}', and it is no address of one",
            f"did you mean {close[0]}?" if close else f"{known}; {FORMS}",
        )
    return robots[text]


def link_to(robot: Known, seed: int | None = None) -> Link:
    """The link to a robot, not opened yet; `seed` is for a simulated one.

    Who named it means that machine, and no other one that has got its address since.

    Raises:
        WrongUse: Its address is none.
    """
    link = make_link(robot.address, seed)
    if robot.hardware_id is not None:
        link.meant = Meant(robot.name, robot.hardware_id)
    return link


def own_token(robot: Known) -> str | None:
    """The token file of a robot: its own, or that of a robot with a name at the same place."""
    if robot.token is not None or sim_options(robot.address) is not None:
        return robot.token
    return next((one.token for one in _at(robot.address) if one.token is not None), None)


def name_at(address: str) -> str:
    """The name of the robot at an address; empty if none is known."""
    try:
        return "" if address.startswith(SIM) else next((one.name for one in _at(address)), "")
    except WrongUse:  # it is no address of a robot
        return ""


def _at(address: str) -> Iterator[Known]:
    """The robots with a name that are at the place of an address.

    A wrong line in the file of robots keeps nobody from a robot that is named otherwise.
    """
    place = place_of(address)
    return (one for one in robots_file.read_sound()[0].values() if _is_at(place, one.address))


class Saved(NamedTuple):
    """What is new in the file of robots.

    Attributes:
        named: The addresses of the robots that have got a name, by their names.
        moved: (old address, new address) of those that were found again elsewhere.
    """

    named: dict[str, str]
    moved: dict[str, tuple[str, str]]


def save(found: Iterable[Found]) -> Saved:
    """Give names to robots that have none yet, and their new addresses to those that have moved.

    A robot is the same if its machine has the same hardware id and its program the same port.
    Without an id, it is the same if its machine has the same name or address.

    Args:
        found: The robots. A name that is taken, or none, is changed.
    """
    found = list(found)
    ids = Counter((one.hardware_id, place_of(one.uri)[1]) for one in found)
    saved = Saved({}, {})
    for one in found:
        # Copies of one card may have one id. Then it tells nothing apart.
        unique = ids[one.hardware_id, place_of(one.uri)[1]] == 1
        hardware_id = one.hardware_id if unique else None
        known = same_robot(hardware_id, one.uri) or _at_place(one, hardware_id)
        if known is None:
            name = robots_file.free_name(one.name, robots_file.read())
            robots_file.add(name, one.uri, None, hardware_id)
            saved.named[name] = one.uri
            continue
        address = _new_address(known.address, one)
        if address != known.address:
            robots_file.update(known.name, address=address)
            saved.moved[known.name] = known.address, address
        if hardware_id is not None and known.hardware_id is None:
            robots_file.update(known.name, hardware_id=hardware_id)
    return saved


def same_robot(hardware_id: str | None, address: str) -> Known | None:
    """The robot with a name that is on this machine and listens at the port of this address."""
    port = place_of(address)[1]
    return next(
        (
            one
            for one in robots_file.read().values()
            if one.hardware_id is not None
            and one.hardware_id == hardware_id
            and _is_at((None, port), one.address)
        ),
        None,
    )


def _at_place(found: Found, hardware_id: str | None) -> Known | None:
    """The robot with a name at one of the addresses of what was found, unless its id is another."""
    port = place_of(found.uri)[1]
    places = [place_of(found.uri), *((host, port) for host in (found.host, *found.addresses))]
    return next(
        (
            one
            for one in robots_file.read().values()
            if any(_is_at(place, one.address) for place in places)
            and (hardware_id is None or one.hardware_id in (None, hardware_id))
        ),
        None,
    )


def _new_address(address: str, found: Found) -> str:
    """The address of a robot that was found again; the same if that still leads there.

    A name follows its machine by itself, as does one of ~/.ssh/config; but a second machine of the
    name ev3dev.local is called ev3dev-2.local.
    """
    host = place_of(address)[0]
    if host in (found.host.lower(), *found.addresses):
        return address
    if host.endswith(".local") and found.host.endswith(".local"):
        return with_host(address, found.host)
    with suppress(ValueError):
        if not ip_address(host).is_loopback:
            return with_host(address, place_of(found.uri)[0])
    return address


def _is_at(place: tuple[str | None, str], address: str) -> bool:
    """Whether an address leads to a place; one without a machine is that port of any machine."""
    try:
        host, port = place_of(address)
    except WrongUse:  # in the file, where it harms nobody who names another robot
        return False
    return port == place[1] and place[0] in (None, host)
