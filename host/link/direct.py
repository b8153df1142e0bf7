"""A robot embedded in this process whose frames pass no socket: for a browser, which has none.

The robot's loop and its end of the conversation are the real ones. Time passes only while somebody
waits.
"""

from __future__ import annotations

import os
from typing import Self

from host.link.transport import LinkLost, Meant
from robot.loop import Loop
from robot.session import Session, new_id
from robot.wire import TOKEN_BYTES, Decoder
from sim_motor.brick import SimBrick


class DirectLink:
    """A simulated brick in virtual time, and one conversation with it.

    Args:
        uri: The robot's address, for people.
        brick: The simulated brick; its robot starts at once.
    """

    virtual = True
    opens_fast = True
    is_line = False
    meant: Meant | None = None

    def __init__(self, uri: str, brick: SimBrick) -> None:
        self.uri = uri
        self.token = os.urandom(TOKEN_BYTES)
        self.loop = Loop(brick.motors, brick.battery, brick.clock, brick.seed)
        self._boot = new_id()
        self._session: Session | None = None
        self._decoder = Decoder()
        self._answers = b""
        self.loop.start()

    def another(self) -> Self:
        """A second link to the same robot, not opened yet."""
        other = object.__new__(type(self))
        vars(other).update(vars(self), _session=None)
        return other

    def open(self) -> None:
        """Begin a conversation."""
        self._session = Session(self.loop, self.token, self._boot)
        self._decoder = Decoder()
        self._answers = b""

    def send(self, data: bytes) -> None:
        """Have the robot take in frames, and keep its answers. Raises LinkLost."""
        session = self._open_session()
        self._decoder.feed(data)
        while not session.closing and (frame := self._decoder.next()) is not None:
            self._answers += session.receive(*frame)

    def receive(self, timeout_s: float) -> bytes:
        """What the robot has to say, letting its time pass tick by tick, up to timeout_s of it.

        Raises LinkLost.
        """
        until = self.now() + timeout_s
        while not (data := self._take()) and self.now() < until:
            self.run_tick()
        return data

    def run_tick(self) -> None:
        """Let the robot's time pass until its next tick is done."""
        self.loop.clock.wait(self.loop.deadline, lambda timeout_s: None)
        self.loop.tick()

    def now(self) -> float:
        """The robot's virtual time in s."""
        return float(self.loop.clock.now())

    def close(self) -> None:
        """End the conversation; the robot stays as it is."""
        self._session = None

    def _take(self) -> bytes:
        session = self._open_session()
        data, self._answers = self._answers, b""
        while (frame := session.stream()) is not None:
            data += frame
        if not data and session.closing:
            raise LinkLost("the robot has ended the conversation")
        return data

    def _open_session(self) -> Session:
        if self._session is None:
            raise LinkLost("the connection is closed")
        return self._session
