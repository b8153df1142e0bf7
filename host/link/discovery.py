"""Which robots and which EV3 bricks the network knows, by multicast DNS (RFC 6762, 6763)."""

from __future__ import annotations

import math
import threading
import time
from dataclasses import asdict, dataclass

from zeroconf import (
    InterfaceChoice,
    IPVersion,
    ServiceBrowser,
    ServiceInfo,
    ServiceListener,
    Zeroconf,
)

from host.errors import NoLink, WrongUse, printable
from host.util.installation import deploy_command
from robot.program import PORT

# What a brick with the robot's program as a service announces, and what every ev3dev brick does
# (with the user's name in its record).
ROBOT = "_kickctl._tcp.local."
BRICK = "_sftp-ssh._tcp.local."
USER = "ev3dev.robot.user"
_ASK_MS = 1500


@dataclass(frozen=True)
class Found:
    """A robot, or a brick that runs none as far as anybody knows. `uri` is its address."""

    name: str
    kind: str
    uri: str
    host: str
    addresses: tuple[str, ...]

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def look_around(
    seconds: float, interfaces: InterfaceChoice | list[str] = InterfaceChoice.All
) -> list[Found]:
    """Listen to the network.

    Args:
        seconds: How long.
        interfaces: Where, by default on all interfaces.

    Returns:
        Robots first, then bricks that do not run the robot's program, as far as anybody knows.

    Raises:
        KickctlError: This machine cannot listen.
    """
    if not 0 < seconds < math.inf:
        raise WrongUse(f"{seconds} is no time to listen", "give a number of seconds, for example 4")
    listener = _Listener()
    try:
        with Zeroconf(interfaces=interfaces, ip_version=IPVersion.V4Only) as network:
            ServiceBrowser(network, [ROBOT, BRICK], listener)
            time.sleep(seconds)
            names = listener.names()
            answers = [network.get_service_info(kind, name, _ASK_MS) for kind, name in names]
    except OSError as error:
        raise NoLink(
            f"the network cannot be asked: {error}",
            "is there a network, and may this user send multicasts?",
        ) from error
    found = [
        _found(info)
        for info in answers
        if info is not None and info.parsed_addresses(IPVersion.V4Only)
    ]
    robots = [one for one in found if one is not None and one.kind == "robot"]
    seen = {address for one in robots for address in one.addresses}
    return robots + [
        one
        for one in found
        if one is not None and one.kind != "robot" and not seen & set(one.addresses)
    ]


class _Listener(ServiceListener):
    """Remembers the names of services."""

    def __init__(self) -> None:
        self._names: set[tuple[str, str]] = set()
        self._lock = threading.Lock()

    def names(self) -> list[tuple[str, str]]:
        """(type, name) of what is there now."""
        with self._lock:
            return sorted(self._names)

    def add_service(self, network: Zeroconf, kind: str, name: str) -> None:
        with self._lock:
            self._names.add((kind, name))

    def update_service(self, network: Zeroconf, kind: str, name: str) -> None:
        """Nothing of it is kept."""

    def remove_service(self, network: Zeroconf, kind: str, name: str) -> None:
        with self._lock:
            self._names.discard((kind, name))


def _found(info: ServiceInfo) -> Found | None:
    """What a record says; None if it is no brick's. Anyone may send records."""
    addresses = tuple(info.parsed_addresses(IPVersion.V4Only))
    name = printable(info.name.removesuffix("." + info.type))
    host = printable((info.server or "").rstrip("."))
    if info.type == ROBOT:
        port = "" if info.port == PORT else f":{info.port}"
        return Found(name, "robot", f"tcp://{addresses[0]}{port}", host, addresses)
    user = info.properties.get(USER.encode())
    if not user:
        return None
    login = "".join(
        letter
        for letter in user.decode("ascii", "replace")[:32]
        if letter.isalnum() or letter in "-_"
    ).lstrip("-")
    return Found(
        name,
        f"EV3 brick; {deploy_command()} brings the robot's program to it",
        f"ssh://{login}@{addresses[0]}",
        host,
        addresses,
    )
