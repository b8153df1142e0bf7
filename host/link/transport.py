"""What a link to a robot is (bytes out, bytes in), and the plainest one: TCP."""

from __future__ import annotations

import select
import socket
import time
from typing import Any, NamedTuple, Protocol, Self

from host.errors import NoLink
from host.util.installation import deploy_command

CONNECT_TIMEOUT_S = 5.0
READ_BYTES = 65536


class LinkLost(Exception):
    """The other end is gone; `open` may find it again."""


class Meant(NamedTuple):
    """Which robot is meant by who names it.

    Attributes:
        name: Its name.
        hardware_id: That of its machine.
    """

    name: str
    hardware_id: str

    def is_other(self, hello: dict[str, Any]) -> bool:
        """Whether this is the hello of another machine. Older robots do not say which they are."""
        return bool(hello.get("hardware_id", self.hardware_id) != self.hardware_id)


class Link(Protocol):
    """A way to a robot.

    uri: the robot's address. virtual: whether the link carries its own robot, which has its own
    time. opens_fast: whether a second link is opened as quickly as a frame is sent, so that a stop
    had better take one of its own. is_line: whether it is a serial line, which one
    connection at a time can use, and on which frames get lost. meant: which robot it should lead
    to, since an address may pass to another one; None if whichever is there.
    """

    uri: str
    virtual: bool
    opens_fast: bool
    is_line: bool
    meant: Meant | None

    def another(self) -> Link:
        """A second way to the same robot for a stop, not opened yet."""

    def open(self) -> None:
        """Open, or close and open again. Raises NoLink."""

    def send(self, data: bytes) -> None:
        """Send all of it. Raises LinkLost."""

    def receive(self, timeout_s: float) -> bytes:
        """What has arrived, waiting up to timeout_s for the first byte; empty if nothing came.

        Raises LinkLost.
        """

    def now(self) -> float:
        """Seconds on the clock in which timeouts are counted."""

    def close(self) -> None:
        """Close; safe to call twice."""


class TcpLink:
    """A TCP connection."""

    virtual = False
    opens_fast = True
    is_line = False
    meant: Meant | None = None

    def __init__(self, uri: str, host: str, port: int) -> None:
        self.uri = uri
        self._address = (host, port)
        self._socket: socket.socket | None = None

    def another(self) -> Self:
        """A second connection to the same port, not opened yet."""
        other = type(self)(self.uri, *self._address)
        other.meant = self.meant
        return other

    def open(self) -> None:
        """Close what was open, and connect. Raises NoLink."""
        self.close()
        try:
            self._socket = socket.create_connection(self._address, timeout=CONNECT_TIMEOUT_S)
        except ConnectionRefusedError as error:
            raise NoLink(
                f"no robot's program runs at {self.uri}: the machine is there and refuses the"
                " connection",
                "start the program. If it died, its watchdog should have stopped the motors: look"
                f" whether they turn. Its log says why (of a brick: {deploy_command()} --logs)",
            ) from error
        except OSError as error:
            raise NoLink(
                f"no robot answers at {self.uri}: {error.strerror or error}",
                "is it switched on and its program running? `kickctl doctor` looks closer, and"
                " `kickctl discover --save` finds a robot again whose address has changed",
            ) from error
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def send(self, data: bytes) -> None:
        """Send all of it. Raises LinkLost."""
        if self._socket is None:
            raise LinkLost("the connection is closed")
        try:
            self._socket.sendall(data)
        except OSError as error:
            raise LinkLost(str(error)) from error

    def receive(self, timeout_s: float) -> bytes:
        """What has arrived within timeout_s. Raises LinkLost."""
        if self._socket is None:
            raise LinkLost("the connection is closed")
        try:
            if not select.select([self._socket], (), (), max(0.0, timeout_s))[0]:
                return b""
            data = self._socket.recv(READ_BYTES)
        except (OSError, ValueError) as error:
            raise LinkLost(str(error)) from error
        if not data:
            raise LinkLost("the robot closed the connection")
        return data

    def now(self) -> float:
        """Monotonic seconds."""
        return time.monotonic()

    def close(self) -> None:
        """Close the connection."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
