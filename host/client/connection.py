"""A connection to a robot: requests, control, and the stop.

Without a token it observes: it may look, and stop the robot. With the token it may also drive. Any
number of connections to one robot may be open, each with a thread of its own, and `stop` waits for
none of them.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any, Self

from host.client import neighbours
from host.client.lasting_link import HEARTBEAT_S, LastingLink
from host.client.stop import REPEAT_S, Stopped, stop_frame, stop_robot, unconfirmed
from host.errors import KickctlError, NoLink, RefusedByRobot
from host.link.transport import LinkLost
from host.util.installation import deploy_command
from host.util.interrupts import uninterrupted
from robot.token import default_path

# How long an open link that carries other things may take to confirm a stop, and how often to look.
THROUGH_S = 1.0
LOOK_S = 0.005
# How long closing waits for one who may be looking for a lost robot before it looks whether so.
LEAVE_S = 0.1
# Obeyed late, these would undo a stop that somebody has asked for since, or a fault that has come.
AT_ONCE = ("start", "clear")


class Connection(LastingLink):
    """A conversation with a robot that this program may control.

    Every method that talks to the robot raises KickctlError in words when that fails. A connection
    that nobody refers to any more hangs up. If it had control, the newest connection of this
    program to the same robot has it from then on; without one, the robot takes its host for lost,
    as when a program ends.
    """

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Give control back and hang up. The robot goes on as it is.

        A robot that is being looked for gets nothing back, and is not waited for.
        """
        self._leaving.set()
        locked = False
        try:
            # Whoever looks for a lost robot holds the lock, for as long as a login by ssh takes.
            while not (locked := self._lock.acquire(timeout=LEAVE_S)) and self._whole:
                pass
            if self._closed.is_set():
                return
            if locked:
                with suppress(KickctlError):
                    self.release()
            self._end("this connection has been closed")
        finally:
            if locked:
                self._lock.release()

    def lease(self) -> None:
        """Take control. Others may look on and stop the robot.

        Another connection of this program that has control loses it.

        Raises:
            LeaseLost: Another host controls the robot.
            RefusedByRobot: This machine does not have the robot's token.
        """
        self._take_lease({})

    def take_over(self) -> None:
        """Take control, also from another host. The robot goes on as it is.

        The other host hears who has taken over. It can take over in turn, but only on purpose.

        Raises:
            RefusedByRobot: This machine does not have the robot's token, or the robot's program is
                too old.
        """
        self._need_minor(2, "a take-over")
        self._take_lease({"take_over": True})

    def _take_lease(self, arguments: dict[str, Any]) -> None:
        self.request("lease", arguments, sealed=True)
        self.gain_control()
        neighbours.take_control(self)

    def _need_minor(self, minor: int, what: str) -> None:
        """Raise RefusedByRobot if the robot's program is older than protocol 1.`minor`."""
        protocol = self.hello["protocol"]
        if protocol < [1, minor]:
            raise RefusedByRobot(
                f"the robot's program is too old for {what}: it has protocol"
                f" {'.'.join(map(str, protocol))}",
                f"bring this release to the robot: {deploy_command()}",
            )

    def release(self) -> None:
        """Give control back; the robot goes on as it is."""
        if self.drives:
            self.lose_control()
            self.request("release", sealed=True)

    def request(
        self, command: str, arguments: dict[str, Any] | None = None, *, sealed: bool = False
    ) -> dict[str, Any]:
        """Ask the robot something.

        What a broken link swallowed is sent again over the next one, and what a serial line did not
        answer is sent again over the same one. But "start" and "clear" are sent once, at once: by
        the time of a second try somebody may have stopped the robot.

        Args:
            command: One of the robot's commands.
            arguments: What belongs to it.
            sealed: Whether it moves or changes the robot, for which the token is needed.

        Returns:
            The robot's answer.

        Raises:
            KickctlError: The robot refuses, does not answer, or cannot be reached.
        """
        if self._broken is not None:
            raise self._broken
        asked_in = self._talk.session
        with self._lock:
            if not self._whole and self._broken is None:
                self._reopen("it was left half open")
            if sealed and not self._talk.trusted:
                raise self._untrusted()
            return self._exchange(
                lambda: self._talk.request(command, arguments or {}, sealed), command, asked_in
            )

    def _untrusted(self) -> RefusedByRobot:
        """The error for what takes the robot's token."""
        if self._talk.token_refused:
            return RefusedByRobot(
                "this computer has the token of another robot, so it may only look, and stop this"
                " one",
                "copy the token file of this robot here, chmod 600 it, and name it by --token, or"
                f" once and for all: kickctl robots add NAME {self.link.uri} --token FILE",
            )
        return RefusedByRobot(
            "this computer does not have the robot's token, so it may only look, and stop the"
            " robot",
            f"`{deploy_command()}` gives it to both. Or copy the robot's token file to"
            f" {default_path() or 'a file that KICK_TOKEN names'}, and chmod 600 it",
        )

    def stop_at_once(self) -> Stopped:
        """Stop the motors, waiting neither for a lock, nor for a handshake, nor for control.

        It works from any thread, also while another one waits for an answer. The STOP frame goes
        over a link of its own where one opens as fast as a frame is sent (tcp, sim); else over the
        open link, past all requests (serial, ssh). If that is not confirmed, the other way is
        tried.

        Returns:
            What the robot says about the stop.

        Raises:
            NoLink: Nobody has confirmed the stop, so the motors may be running.
        """
        ways = [self._stop_aside] if self.link.virtual else [self._stop_aside, self._stop_through]
        failures = []
        with uninterrupted():  # a second ^C must not end the stop that the first one asked for
            for way in ways if self.link.opens_fast else reversed(ways):
                try:
                    return way()
                except NoLink as failure:
                    failures.append(failure)
        raise failures[0]

    def _stop_aside(self) -> Stopped:
        return stop_robot(self.link, self.name)

    def _stop_through(self) -> Stopped:
        """Stop over the open link, which another thread may be reading."""
        self._talk.stopped = None
        until = self.link.now() + THROUGH_S
        repeat = self.link.now()
        try:
            while self.link.now() < until:
                if self.link.now() >= repeat:
                    self._send_past_requests(stop_frame(self.name))
                    repeat = self.link.now() + REPEAT_S
                if self._lock.acquire(timeout=LOOK_S):
                    try:
                        self._read(LOOK_S)
                    finally:
                        self._lock.release()
                if self._talk.stopped is not None:
                    return self._talk.stopped
        except LinkLost as error:
            raise unconfirmed(self.link.uri, f"the link broke ({error})") from error
        raise unconfirmed(self.link.uri, "no answer has come over the open link")

    def _send_past_requests(self, frame: bytes) -> None:
        if not self._sending.acquire(timeout=REPEAT_S):
            raise unconfirmed(self.link.uri, "the open link takes nothing more")
        try:
            self.link.send(frame)
        finally:
            self._sending.release()

    def _exchange(
        self, make: Callable[[], tuple[int, bytes]], what: str, asked_in: int
    ) -> dict[str, Any]:
        if self._broken is not None:
            raise self._broken
        once = what in AT_ONCE
        give_up = self.link.now() + self.answer_s + self.reconnect_s
        session, until = None, give_up
        while True:
            if once and asked_in != self._talk.session:
                raise NoLink(
                    f"the link broke, so '{what}' may not have reached the robot; it is not sent"
                    " again, as somebody may have stopped the robot since",
                    _look(what),
                )
            if session != self._talk.session:
                session = self._talk.session
                until = min(give_up, self.link.now() + self.answer_s)
            number, frame = make()
            try:
                self._send(frame)
            except LinkLost as error:
                self._reopen(str(error))
                continue
            now = self.link.now()
            repeat = now + self.silence_s
            while session == self._talk.session and (
                once or not self.link.is_line or now <= repeat
            ):
                answer = self._talk.answer(number)
                if answer is not None:
                    return answer
                if not self.link.is_line:
                    self._talk.raise_refusal()
                if now > until:
                    raise NoLink(
                        f"the robot does not answer to '{what}'",
                        _look(what)
                        if once
                        else "is its program alive? `kickctl doctor` looks closer",
                    )
                self.pump(HEARTBEAT_S)
                now = self.link.now()


def _look(what: str) -> str:
    """What to do where nobody knows whether the robot has obeyed."""
    return f"see what it does: kickctl status. Then {what} it again, if you still want to"
