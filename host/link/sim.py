"""sim://: a robot embedded in this process. Its loop and its server are the real ones.

Time passes only while somebody waits.
"""

from __future__ import annotations

import os
import re
import socket
import threading
from dataclasses import fields
from typing import Any, Self

from host.errors import WrongUse, quotable
from host.link.settings import number_or_text
from host.link.sim_settings import settings
from host.link.transport import LinkLost, Meant
from host.util.arguments import need_seed
from host.util.interrupts import uninterrupted
from robot.errors import Refused
from robot.loop import Loop
from robot.params import TABLE
from robot.server import Server
from robot.wire import TOKEN_BYTES
from sim_motor.brick import SimBrick
from sim_motor.scene import Scene

_READ_BYTES = 65536
_SCENE = tuple(field.name for field in fields(Scene))
# Fields of a scene that need walls.
_OF_WALLS = ("across", "stiffness")
_OPTIONS = tuple(setting.name for setting in settings())
_THEY_ARE = (
    f"its options are {', '.join(_OPTIONS)}, and the robot's parameters: {', '.join(TABLE)};"
    " kickctl help explains each, as in kickctl help grip"
)


class SimLink:
    """A simulated brick in virtual time behind a pair of connected sockets.

    It has a token of its own. Several threads may use links to the same robot: each one that
    waits lets one tick pass at a time. ^C falls between ticks and between commands, never into one:
    what a log says of the robot is all that has happened to it.
    """

    virtual = True
    opens_fast = True
    is_line = False
    meant: Meant | None = None

    def __init__(
        self,
        uri: str,
        brick: SimBrick,
        idle: bool = False,
        params: dict[str, Any] | None = None,
    ) -> None:
        self.uri = uri
        self.brick = brick
        self.token = os.urandom(TOKEN_BYTES)
        self.loop = Loop(brick.motors, brick.battery, brick.clock, brick.seed)
        self.server = Server(self.loop, self.token)
        self._socket: socket.socket | None = None
        self._turn = threading.RLock()
        if params:
            self.loop.set_params(params)
        if not idle:
            self.loop.start()

    @classmethod
    def from_options(cls, uri: str, options: dict[str, str], seed: int | None) -> SimLink:
        """The link for the options of a sim:// URI.

        Args:
            uri: The whole address, for messages.
            options: Those of `host.link.sim_settings.settings`, and the robot's parameters.
            seed: Overrides the seed among the options.

        Raises:
            WrongUse: The robot cannot be simulated with these options.
        """
        for name in options:
            if name not in _OPTIONS and name not in TABLE:
                raise WrongUse(f"sim:// has no option '{quotable(name)}'", _THEY_ARE)
        for name in _OF_WALLS:
            if name in options and "walls" not in options:
                raise WrongUse(
                    f"'{name}' belongs to a robot between walls, and '{uri}' has none",
                    "add walls=2.0, their distance in m",
                )
        try:
            if seed is None:
                seed = (
                    _seed(options["seed"])
                    if "seed" in options
                    else int.from_bytes(os.urandom(4), "big")
                )
            scene = (
                Scene(**{name: _number(options, name) for name in _SCENE if name in options})
                if any(name in options for name in _SCENE)
                else None
            )
            battery_v = _number(options, "battery") if "battery" in options else None
            brick = SimBrick(
                seed,
                motor=options.get("motor", "pybricks"),
                battery_v=battery_v,
                dither_deg=_number(options, "dither") if "dither" in options else None,
                scene=scene,
            )
        except (ValueError, KeyError) as error:
            raise WrongUse(
                f"'{uri}' cannot be simulated: {quotable(str(error))}", _THEY_ARE
            ) from error
        idle = options.get("idle", "0")
        if idle not in ("0", "1"):
            raise WrongUse(f"idle cannot be '{quotable(idle)}'", "write idle=1 for one that rests")
        try:
            return cls(uri, brick, idle == "1", _params(options))
        except Refused as refusal:
            raise WrongUse(
                f"'{uri}' cannot be simulated: {refusal.message}", refusal.hint
            ) from refusal

    def another(self) -> Self:
        """A second link to the same simulated robot, not opened yet."""
        other = object.__new__(type(self))
        vars(other).update(vars(self), _socket=None)
        return other

    def open(self) -> None:
        """Close what was open, and connect to the same robot."""
        self.close()
        self._socket, robot_end = socket.socketpair()
        self._socket.setblocking(False)
        robot_end.setblocking(False)
        with self._turn:
            self.server.adopt(robot_end)

    def send(self, data: bytes) -> None:
        """Send all of it; the robot's end is served as often as it takes."""
        if self._socket is None:
            raise LinkLost("the connection is closed")
        while data:
            try:
                data = data[self._socket.send(data) :]
            except BlockingIOError:
                self._serve()
            except OSError as error:
                raise LinkLost(str(error)) from error

    def receive(self, timeout_s: float) -> bytes:
        """What the robot has sent, letting its time pass tick by tick, up to timeout_s of it.

        Raises LinkLost.
        """
        until = self.now() + timeout_s
        while self._socket is not None:
            try:
                data = self._socket.recv(_READ_BYTES)
            except BlockingIOError:
                if self.now() >= until:
                    return b""
                self.run_tick()
                continue
            except OSError as error:
                raise LinkLost(str(error)) from error
            if data:
                return data
            break
        raise LinkLost("the robot closed the connection")

    def run_tick(self) -> None:
        """Let the robot's time pass until its next tick is done, and what it has to say is sent."""
        with self._turn, uninterrupted():
            self.loop.clock.wait(self.loop.deadline, self.server.serve)
            self.loop.tick()
            self.server.serve(0.0)

    def now(self) -> float:
        """The robot's virtual time in s."""
        return float(self.loop.clock.now())

    def close(self) -> None:
        """Close the connection; the robot stays as it is."""
        if self._socket is not None:
            self._socket.close()
            self._socket = None
            self._serve()  # lets the robot notice

    def _serve(self) -> None:
        with self._turn, uninterrupted():
            self.server.serve(0.0)


def _seed(text: str) -> int:
    if not re.fullmatch("[0-9]+", text):
        raise WrongUse(
            f"seed cannot be '{quotable(text)}'", "give a whole number, 0 or more, as in seed=1"
        )
    return need_seed(int(text)) or 0


def _number(options: dict[str, str], name: str) -> float:
    value = number_or_text(options[name])
    if isinstance(value, str):
        raise WrongUse(f"{name} cannot be '{quotable(value)}'", f"give a number, as in {name}=2.5")
    return value


def _params(options: dict[str, str]) -> dict[str, float | str]:
    """The robot's parameters among the options, numbers as numbers."""
    return {name: number_or_text(options[name]) for name in options if name in TABLE}
