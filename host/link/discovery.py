"""Which robots and which EV3 bricks the network knows, by multicast DNS (RFC 6762, 6763)."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from ipaddress import IPv4Address, IPv6Address, ip_address

from zeroconf import (
    Error,
    InterfaceChoice,
    IPVersion,
    ServiceBrowser,
    ServiceInfo,
    ServiceListener,
    Zeroconf,
)

from host.errors import NoLink, printable
from host.util.arguments import need_seconds, wrong
from host.util.installation import deploy_command
from robot.wire import PORT

# What a brick with the robot's program as a service announces, and what every ev3dev brick does
# (with the user's name in its record).
ROBOT = "_kickctl._tcp.local."
BRICK = "_sftp-ssh._tcp.local."
USER = "ev3dev.robot.user"
_ASK_MS = 1500
LONGEST_S = 3600
_LOOK_UPS = 32


@dataclass(frozen=True)
class Found:
    """A robot, or a brick that runs none as far as anybody knows.

    uri: its address. addresses: all that it has in the network, the easiest to reach first.
    hardware_id: what the robot's program there says of its machine; None if nobody has asked it.
    """

    name: str
    kind: str
    uri: str
    host: str
    addresses: tuple[str, ...]
    hardware_id: str | None = None

    def as_dict(self) -> dict[str, object]:
        """For JSON."""
        return asdict(self)


def look_around(
    seconds: float, interfaces: InterfaceChoice | list[str] = InterfaceChoice.All
) -> list[Found]:
    """Listen to the network, IPv4 and IPv6.

    Args:
        seconds: How long.
        interfaces: Where, by default on all interfaces.

    Returns:
        Robots first, then bricks that do not run the robot's program, as far as anybody knows.

    Raises:
        KickctlError: This machine cannot listen.
    """
    if not 0 < need_seconds("seconds", seconds) <= LONGEST_S:
        raise wrong("seconds", seconds, f"a number of seconds, at most {LONGEST_S}, for example 4")
    listener = _Listener()
    with _network(interfaces) as network:
        ServiceBrowser(network, [ROBOT, BRICK], listener)
        time.sleep(seconds)
        # Side by side, since a name that somebody has left behind answers to nobody.
        with ThreadPoolExecutor(_LOOK_UPS) as pool:
            answers = list(pool.map(lambda place: _look_up(network, *place), listener.names()))
    found = [one for one in answers if one is not None]
    robots = [one for one in found if one.kind == "robot"]
    seen = {address for one in robots for address in one.addresses}
    return robots + [one for one in found if one.kind != "robot" and not seen & set(one.addresses)]


@contextmanager
def _network(interfaces: InterfaceChoice | list[str]) -> Iterator[Zeroconf]:
    """Multicast DNS on the interfaces, over IPv4 alone if IPv6 does not work here."""
    try:
        try:
            network = Zeroconf(interfaces=interfaces, ip_version=IPVersion.All)
        except (OSError, RuntimeError):
            network = Zeroconf(interfaces=interfaces, ip_version=IPVersion.V4Only)
    # zeroconf has a RuntimeError for a machine without any interface.
    except (OSError, RuntimeError) as error:
        raise NoLink(
            f"the network cannot be asked: {error}",
            "is there a network, and may this user send multicasts?",
        ) from error
    with network:
        yield network


def _look_up(network: Zeroconf, kind: str, name: str) -> Found | None:
    """What a service says of itself; None if it does not answer, or is neither robot nor brick.

    Anyone may announce anything: zeroconf refuses names and records that break the rules.
    """
    try:
        info = network.get_service_info(kind, name, _ASK_MS)
        return None if info is None else _found(info)
    except (Error, OSError, ValueError):
        return None


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
    """What a record says; None if it is no brick's, or leads nowhere."""
    addresses = _by_ease(info.parsed_scoped_addresses(IPVersion.All))
    if not addresses or not info.port:
        return None
    place = f"[{addresses[0]}]" if ":" in addresses[0] else addresses[0]
    name = printable(info.name.removesuffix("." + info.type))
    host = printable((info.server or "").rstrip("."))
    if info.type == ROBOT:
        port = "" if info.port == PORT else f":{info.port}"
        return Found(name, "robot", f"tcp://{place}{port}", host, addresses)
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
        f"ssh://{login}@{place}",
        host,
        addresses,
    )


def _by_ease(texts: list[str]) -> tuple[str, ...]:
    """Addresses, those first that are the easiest to reach and to type.

    An IPv6 address of one cable only (fe80::...) leads nowhere without its interface.
    """
    addresses = [ip_address(text) for text in texts]
    local = [one for one in addresses if one.version == 6 and one.is_link_local]
    lasting = [one for one in addresses if one not in local]
    lasting.sort(key=lambda one: one.version)
    return tuple(_text(one) for one in lasting + [one for one in local if "%" in str(one)])


def _text(address: IPv4Address | IPv6Address) -> str:
    """An address with its interface's name instead of its number."""
    text, percent, scope = str(address).partition("%")
    if scope.isdecimal():
        with suppress(OSError):  # the number leads there as well
            scope = socket.if_indextoname(int(scope))
    return text + percent + scope
