"""The WebSocket server for Foxglove and Lichtblick: it carries robots' streams to viewers.

The SDK keeps a bounded queue for each viewer. One that does not keep up loses its oldest messages,
and delays neither a robot nor another viewer.
"""

from __future__ import annotations

import errno
import logging
import os
import re
from collections.abc import Callable, Sequence
from typing import Any, Self

import foxglove
from foxglove.websocket import Capability, StatusLevel, WebSocketServer

from host.errors import KickctlError, NotDone, WrongUse
from host.foxglove.control import Control
from host.foxglove.station import ShownStation
from host.foxglove.topics import prefixes
from host.foxglove.watching import Watching
from host.lab.observed import LOST_S
from host.logs.messages import EVENTS, SCHEMAS, Message

LOOPBACK = "127.0.0.1"
# Half a minute of the usual ticks of 30 ms.
BACKLOG = 1024
_LOGGER = logging.getLogger("foxglove")


class Viewers:
    """The server, and what it says; a context manager.

    Args:
        stations: The robots to show.
        port: The port; 0 for any that is free.
        host: The address at which to listen.
        control: Whether viewers may drive robots, with the key.
        say: Gets words for who has started the server.

    Attributes:
        url: Where viewers connect.
        key: What unlocks a connection; empty if nobody may drive.
    """

    def __init__(
        self,
        stations: Sequence[ShownStation],
        port: int = 0,
        host: str = LOOPBACK,
        *,
        control: bool = False,
        say: Callable[[str], object] = lambda words: None,
    ) -> None:
        found = prefixes([station.name for station in stations])
        self._robots = {found[station.name]: station for station in stations}
        self._control = Control(self._robots) if control else None
        self._watching = self._control or Watching()
        self.key = self._control.key if self._control else ""
        self.url = ""
        self._port = port
        self._host = host
        self._say = say
        self._refusals = _Refusals(say)
        self._lost: dict[str, str] = {}
        self._context = foxglove.Context()
        self._server: WebSocketServer | None = None

    def __enter__(self) -> Self:
        control = self._control
        if control:
            control.tell = self._post
        try:
            self._server = foxglove.start_server(
                name="kickctl",
                host=self._host,
                port=self._port,
                context=self._context,
                message_backlog_size=BACKLOG,
                capabilities=[Capability.Parameters, Capability.Services] if control else [],
                server_listener=self._watching,
                services=control.services() if control else None,
            )
        except RuntimeError as error:
            raise _words(str(error), self._host, self._port) from error
        _LOGGER.addHandler(self._refusals)
        _LOGGER.propagate = False
        self._port = self._server.port
        self.url = f"ws://{f'[{self._host}]' if ':' in self._host else self._host}:{self._port}"
        for prefix, station in self._robots.items():
            self._show(prefix, station)
        return self

    def __exit__(self, *_: object) -> None:
        for station in self._robots.values():
            station.pages = None
            station.publish = lambda message: None
            station.on_params = lambda: None
        if self._server is not None:
            self._server.stop()
        if self._control:
            self._control.close()
        _LOGGER.propagate = True
        _LOGGER.removeHandler(self._refusals)

    def _show(self, prefix: str, station: ShownStation) -> None:
        channels = {
            topic: foxglove.Channel(
                prefix + topic,
                message_encoding="json",
                schema=foxglove.Schema(name=schema.name, encoding="jsonschema", data=schema.data),
                context=self._context,
            )
            for topic, schema in SCHEMAS.items()
        }

        def publish(message: Message) -> None:
            channels[message.topic].log(message.data, log_time=message.time_ns)

        station.pages = self
        station.publish = publish
        if self._control:
            station.on_params = self._publish_params

    def _publish_params(self) -> None:
        if self._control and self._server is not None:
            self._server.publish_parameter_values(self._control.values())

    def look(self) -> None:
        """See who is there; to be called several times a second, in one thread."""
        if self._control:
            self._control.look()
        new = self._watching.take_new()
        for prefix, station in self._robots.items():
            self._look_for(station)
            if prefix + EVENTS in new:
                station.repeat_snapshot()

    def _look_for(self, station: ShownStation) -> None:
        state = station.state()
        lost = state["link"] == "lost" and state["since_s"] > LOST_S
        words = _lost_words(station) if lost else ""
        before = self._lost.get(station.name, "")
        if words and words != before:
            self._tell(words, station.name)
        elif before and not lost:
            self._say(f"{station.name} is back")
            if self._server is not None:
                self._server.remove_status([station.name])
        self._lost[station.name] = words

    def _tell(self, words: str, about: str = "kickctl") -> None:
        """Say something here and in the viewers."""
        self._say(words)
        self._post(words, about)

    def _post(self, words: str, about: str = "kickctl") -> None:
        """Say something in the viewers, in the place of what was said about the same."""
        if self._server is not None:
            self._server.publish_status(words, StatusLevel.Warning, about)

    # What stations say, from any thread.

    def hear(self, message: dict[str, Any]) -> None:
        """Pass on what a person should know."""
        if message["type"] == "note":
            hint = message["hint"]
            self._tell(f"{message['message']}; {hint}" if hint else message["message"])

    def wake(self) -> None:
        """There is something new, which `look` finds."""

    def call(self, function: Callable[[], object]) -> None:
        """Call a function."""
        function()


def _lost_words(station: ShownStation) -> str:
    what = "is lost" if station.met.is_set() else "is not there yet"
    why = station.trouble or "nothing comes from it"
    pause = f"{station.again_s:g} s after each failure"
    return f"{station.name} {what}: {why}. kickctl keeps trying, {pause}"


class _Refusals(logging.Handler):
    """Says once, in words, that a program has been refused; the SDK says it of each attempt."""

    def __init__(self, say: Callable[[str], object]) -> None:
        super().__init__(logging.ERROR)
        self._say = say
        self._said = False

    def emit(self, record: logging.LogRecord) -> None:
        if "handshake failed" not in record.getMessage():
            self._say(record.getMessage())
        elif not self._said:
            self._said = True
            self._say(
                "a program was refused, since it does not speak the protocol foxglove.sdk.v1. If it"
                " is Foxglove or Lichtblick, take a newer one"
            )


def _words(failure: str, host: str, port: int) -> KickctlError:
    """Why the server cannot listen at an address."""
    found = re.search(r"os error (\d+)", failure)
    number = int(found[1]) if found else 0
    if number == errno.EADDRINUSE:
        return NotDone(
            f"port {port} is taken: another program serves viewers on this computer",
            f"end that one, or take another port: --port {port + 1}, or --port 0 for any",
        )
    if number == errno.EACCES:
        return WrongUse(
            f"port {port} belongs to the system: only its administrator may use it",
            "take one above 1023: --port 8765",
        )
    return WrongUse(
        f"this computer cannot listen at {host}: {os.strerror(number) if number else failure}",
        "--listen takes an address of this computer in its network, as `ip address` shows it",
    )
