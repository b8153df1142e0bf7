"""Addresses of robots.

sim:// (embedded, in virtual time), tcp://HOST:PORT, ssh://USER@HOST and serial:///dev/DEVICE?baud=.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from ipaddress import IPv6Address
from typing import NamedTuple
from urllib.parse import parse_qsl, urlencode, urlsplit

from host.errors import WrongUse, quotable
from host.link.serial_line import SerialLink
from host.link.settings import parse_setting
from host.link.transport import Link, TcpLink
from host.util.arguments import need_seed
from host.util.interrupts import uninterrupted
from robot.serial_line import FASTEST_BAUD
from robot.wire import BAUD, PORT

SIM = "sim://"

FORMS = "addresses are sim://, tcp://HOST:PORT, ssh://USER@HOST and serial:///dev/DEVICE?baud=RATE"
SCHEMES = ("sim", "tcp", "ssh", "serial")
# USER@HOST:PORT; a host that is an IPv6 address stands in brackets.
_AUTHORITY = re.compile(
    r"(?:(?P<user>[^@]*)@)?(?:\[(?P<v6>[^][@]*)\]|(?P<name>[^][@:]*))(?::(?P<port>[0-9]*))?"
)


class _Parts(NamedTuple):
    """An address in pieces, whose scheme is known."""

    uri: str
    scheme: str
    authority: str
    path: str
    options: dict[str, str]

    def refuse_options(self, *known: str) -> None:
        """Raise WrongUse for an option that is not among the known ones."""
        for name in self.options:
            if name not in known:
                they_are = f"; the only option is {', '.join(known)}" if known else ""
                raise no_address(self.uri, f"it has no option '{name}'{they_are}")


def no_address(uri: str, why: str, hint: str = FORMS) -> WrongUse:
    """The error for what is no address of a robot.

    Args:
        uri: What was given.
        why: What is wrong with it.
        hint: What to write instead.
    """
    return WrongUse(f"'{quotable(uri)}' is no address of a robot: {quotable(why)}", hint)


def _split(uri: str) -> _Parts:
    """The pieces of an address. Raises WrongUse."""
    if not uri.isprintable():
        raise no_address(uri, "it contains a letter that cannot be printed")
    try:
        parts = urlsplit(uri)
    except ValueError as error:
        raise no_address(uri, str(error)) from error
    if parts.scheme not in SCHEMES or not uri.lstrip()[len(parts.scheme) :].startswith("://"):
        why = f"it begins with none of {', '.join(f'{scheme}://' for scheme in SCHEMES)}"
        meant = _meant(uri)
        raise no_address(uri, why, f"did you mean {meant}?" if meant else FORMS)
    if parts.fragment:
        raise no_address(uri, "nothing belongs behind a '#'")
    pairs = parse_qsl(parts.query, keep_blank_values=True)
    options = dict(pairs)
    if len(options) < len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise no_address(uri, f"'{twice}' stands in it twice", "write it once")
    return _Parts(uri, parts.scheme, parts.netloc, parts.path, options)


def _meant(text: str) -> str:
    """The address that a text without a scheme, or with a wrong one, probably means; or empty."""
    scheme, colon, rest = text.partition(":")
    close = get_close_matches(scheme.lower(), SCHEMES, 1)
    if close and (colon or "sim" in close):
        slashes = "///" if close == ["serial"] else "//"
        text = f"{close[0]}:{slashes}{rest.lstrip('/')}"
    elif text.startswith("/dev/"):
        text = f"serial://{text}"
    elif "@" in text:
        text = f"ssh://{text}"
    elif "." in text or ":" in text:
        text = f"tcp://{text}"
    else:
        return ""
    try:
        _split(text)
        if not text.startswith(SIM):
            make_link(text)
    except WrongUse:
        return ""
    return text


def place_of(uri: str) -> tuple[str, str]:
    """Where a robot listens: machine and port, or the device.

    A robot's tcp:// address and its ssh:// address have the same place, if both say the same name
    of the machine.

    Raises:
        WrongUse: It is no address of a robot.
    """
    parts = _split(uri)
    pieces = _AUTHORITY.fullmatch(parts.authority)
    if parts.scheme in ("sim", "serial") or pieces is None:
        return parts.authority, parts.path
    port = parts.options.get("port") if parts.scheme == "ssh" else pieces["port"]
    return (pieces["v6"] or pieces["name"]).lower(), port or str(PORT)


def with_host(uri: str, host: str) -> str:
    """The address of the same robot after its machine has got another address.

    Args:
        uri: The robot's tcp:// or ssh:// address.
        host: The machine's new name or address, without brackets.

    Raises:
        WrongUse: It is no address of a robot.
    """
    parts = _split(uri)
    pieces = _AUTHORITY.fullmatch(parts.authority)
    if pieces is None:
        raise no_address(uri, "it names no machine")
    before = pieces["v6"] or pieces["name"]
    user, port = pieces["user"], pieces["port"]
    authority = f"{'' if user is None else user + '@'}{f'[{host}]' if ':' in host else host}"
    authority += "" if port is None else f":{port}"
    # Behind ssh, `host` says where on the machine the program listens.
    options = {
        name: host if (name, value) == ("host", before) else value
        for name, value in parts.options.items()
    }
    query = f"?{urlencode(options, safe=':')}" if options else ""
    return f"{parts.scheme}://{authority}{parts.path}{query}"


def with_params(uri: str, settings: list[str]) -> str:
    """The address of a simulated robot that begins with parameters.

    Args:
        uri: A simulated robot's address.
        settings: The parameters, each as NAME=VALUE.

    Returns:
        The address with the parameters among its options.

    Raises:
        WrongUse: It is a real robot's address, or a setting is not of the form NAME=VALUE.
    """
    options = sim_options(uri)
    if options is None:
        raise WrongUse(
            "--set gives parameters to the simulated robot that is embedded in this program, and"
            f" '{uri}' is a robot of its own",
            f"set them there: kickctl --brick {uri} params set {' '.join(settings)}",
        )
    given = [parse_setting(setting) for setting in settings]
    names = [name for name, _ in given]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise WrongUse(f"--set gives {twice} twice", "give each parameter once")
    options.update((name, str(value)) for name, value in given)
    return f"{SIM}?{urlencode(options)}"


def sim_options(uri: str) -> dict[str, str] | None:
    """The options of a simulated robot's address, None for a real robot's.

    Raises WrongUse if it is no address.
    """
    parts = _split(uri)
    return parts.options if parts.scheme == "sim" else None


def make_link(uri: str, seed: int | None = None) -> Link:
    """The link for an address, not opened yet.

    Args:
        uri: The robot's address.
        seed: Fixes all chances of a simulated robot; overrides the address's own seed.

    Raises:
        WrongUse: It is no address of a robot, or a real robot was given a seed.
    """
    parts = _split(uri)
    seed = need_seed(seed)
    if parts.scheme == "sim":
        return _sim(parts, seed)
    if seed is not None:
        raise WrongUse(
            f"--seed is only for the robot that is embedded in this program, {SIM}",
            "leave it out: a robot elsewhere has the seed that it was started with",
        )
    if parts.scheme == "tcp":
        return _tcp(parts)
    if parts.scheme == "serial":
        return _serial(parts)
    from host.link.ssh import SshLink

    try:
        return SshLink(uri)
    except ValueError as error:
        raise no_address(uri, str(error)) from error


def _sim(parts: _Parts, seed: int | None) -> Link:
    if parts.authority or parts.path:
        raise no_address(parts.uri, "the simulated robot has no name")
    with uninterrupted():
        from host.link.sim import SimLink

        return SimLink.from_options(parts.uri, parts.options, seed)


def _tcp(parts: _Parts) -> Link:
    hint = "write it as tcp://HOST:PORT, for example tcp://ev3dev.local or tcp://[fe80::1%usb0]"
    pieces = _AUTHORITY.fullmatch(parts.authority)
    if pieces is None:
        many = parts.authority.count(":") > 1 and "[" not in parts.authority
        why = (
            "an IPv6 address stands in brackets"
            if many
            else "ports are 1 to 65535"
            if re.search(":(?![0-9]*$)[^]:]*$", parts.authority)
            else "its brackets or its '@' stand where they cannot"
        )
        raise no_address(parts.uri, why, hint)
    if pieces["user"] is not None or parts.path.strip("/"):
        raise no_address(parts.uri, "only a host and a port belong into it", hint)
    parts.refuse_options()
    port = int((pieces["port"] or str(PORT))[:6])
    if not 0 < port < 65536:
        raise no_address(parts.uri, "ports are 1 to 65535", hint)
    try:
        host = _ip6(pieces["v6"]) if pieces["v6"] is not None else _name(pieces["name"])
    except ValueError as error:
        raise no_address(parts.uri, str(error), hint) from error
    return TcpLink(parts.uri, host, port)


def _ip6(text: str) -> str:
    """An IPv6 address with its interface, which is behind a '%', in URIs by the book '%25'.

    Raises ValueError.
    """
    address, percent, interface = text.partition("%")
    if len(interface) > 2:
        interface = interface.removeprefix("25")
    if percent and not re.fullmatch(r"[\w.:@-]+", interface):
        raise ValueError(f"'{interface}' is no network interface")
    number = IPv6Address(address)
    if number.is_link_local and not percent:
        raise ValueError("an address that begins with fe80 needs the interface behind it")
    return str(number) + percent + interface


def _name(text: str) -> str:
    """A machine's name or IPv4 address. Raises ValueError."""
    if not re.fullmatch(r"[\w.-]+", text):
        raise ValueError(f"'{text}' is no machine's name")
    try:
        text.encode("idna")  # as the network's functions do
    except UnicodeError as error:
        raise ValueError(f"'{text}' is no machine's name") from error
    return text


def _serial(parts: _Parts) -> Link:
    hint = f"write it as serial:///dev/ttyUSB0?baud={BAUD}, with three slashes"
    if parts.authority or not parts.path:
        raise no_address(parts.uri, "it names no device file", hint)
    parts.refuse_options("baud")
    baud = parts.options.get("baud", str(BAUD))
    if not re.fullmatch("[0-9]{1,8}", baud) or not 0 < int(baud) <= FASTEST_BAUD:
        raise no_address(parts.uri, f"'{baud}' is no baud rate", hint)
    return SerialLink(parts.uri, parts.path, int(baud))
