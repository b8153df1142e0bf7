"""Addresses of robots.

sim:// (embedded, in virtual time), tcp://HOST:PORT, ssh://USER@HOST and serial:///dev/DEVICE?baud=.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from urllib.parse import parse_qsl, urlencode, urlsplit

from host.errors import WrongUse
from host.link.settings import parse_setting
from host.link.transport import Link, SerialLink, TcpLink
from host.util.interrupts import uninterrupted
from robot.program import PORT
from robot.serial_line import BAUD

SIM = "sim://"


@dataclass(frozen=True)
class _Parts:
    scheme: str
    host: str
    port: int | None
    path: str
    options: dict[str, str]


def _split(uri: str) -> _Parts:
    try:
        parts = urlsplit(uri)
        port = parts.port
    except ValueError as error:
        raise WrongUse(f"'{uri}' is no address of a robot: {error}", _FORMS) from error
    return _Parts(
        parts.scheme,
        parts.hostname or "",
        port,
        parts.path,
        dict(parse_qsl(parts.query, keep_blank_values=True)),
    )


_FORMS = "addresses are sim://, tcp://HOST:PORT, ssh://USER@HOST and serial:///dev/DEVICE?baud=RATE"


def chosen(uri: str | None) -> str:
    """The address to use: the one given, else $KICK_BRICK, else the embedded simulated robot's."""
    return uri or os.environ.get("KICK_BRICK") or SIM


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
    options.update((name, str(value)) for name, value in map(parse_setting, settings))
    return f"{SIM}?{urlencode(options)}"


def sim_options(uri: str) -> dict[str, str] | None:
    """The options of a simulated robot's URI, None for a real one's.

    Raises WrongUse if it is no URI.
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
    if parts.scheme != "sim" and seed is not None:
        raise WrongUse(
            f"--seed fixes the chances of {SIM} only",
            "a robot elsewhere has the seed that it was started with",
        )
    if parts.scheme == "sim":
        if parts.host or parts.path:
            raise WrongUse(
                f"'{uri}' is no address of a robot: the simulated one has no name", _FORMS
            )
        with uninterrupted():
            from host.link.sim import SimLink

            return SimLink.from_options(uri, parts.options, seed)
    if parts.scheme == "tcp" and parts.host:
        return TcpLink(uri, parts.host, parts.port or PORT)
    if parts.scheme == "ssh" and parts.host:
        from host.link.ssh import SshLink

        return SshLink(uri)
    if parts.scheme == "serial" and parts.path:
        baud = parts.options.get("baud", str(BAUD))
        if not baud.isdigit():
            raise WrongUse(f"'{baud}' is no baud rate", _FORMS)
        return SerialLink(uri, parts.path, int(baud))
    raise WrongUse(f"'{uri}' is no address of a robot", _FORMS)
