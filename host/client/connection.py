"""A connection to a robot: hello, proof, lease, heartbeat, reconnection, requests and the stop.

Without a token it observes: it may look, and stop the robot. With the token it may also drive. Any
number of connections to one robot may be open, each with a thread of its own, and `stop` waits for
none of them.
"""

from __future__ import annotations

import threading
import uuid
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any, Self

from host.client.access import greet, hear
from host.client.conversation import Conversation
from host.client.stop import REPEAT_S, Stopped, stop_frame, stop_robot, unconfirmed
from host.client.stream import Stream
from host.errors import KickctlError, NoLink, RefusedByRobot
from host.link.transport import Link, LinkLost
from host.util.installation import deploy_command
from robot.token import default_path

if TYPE_CHECKING:
    from types import TracebackType

# The robot counts a silent host as lost after half a second by default.
HEARTBEAT_S = 0.1
# How long an open link that carries other things may take to confirm a stop, and how often to look.
THROUGH_S = 1.0
LOOK_S = 0.005


class Connection:
    """One conversation with a robot, over a link that is found again when it breaks.

    Every method that talks to the robot raises KickctlError in words when that fails.

    Args:
        link: The way to the robot, not opened yet.
        token: The robot's token; None observes.
        name: Who this is, for the robot and for other people.

    Attributes:
        link: The way to the robot.
        hello: What the robot has said of itself.
        stream: What it sends to who subscribes.
        on_trouble: Called with words for people when the link breaks.
        answer_s: How long the robot may take to answer.
        reconnect_s: How long a lost robot is looked for.
    """

    answer_s = 5.0
    reconnect_s = 10.0

    def __init__(self, link: Link, token: bytes | None, name: str = "kickctl") -> None:
        self.link = link
        self.name = name
        self.stream = Stream()
        self.on_trouble: Callable[[str], None] = lambda words: None
        self._talk = Conversation(token, name, client=uuid.uuid4().hex)
        self._lock = threading.RLock()
        self._sending = threading.Lock()
        self._leased = False
        self._heartbeat_due = 0.0
        self._closed = threading.Event()
        self._broken: KickctlError | None = None
        with self._lock:
            try:
                self._open()
            except KickctlError:
                link.close()
                raise
            self.hello = self._talk.hello
            self.started_utc = datetime.now(UTC)
            self.clock_zero_s = self._clock_zero()
        if not link.virtual:
            threading.Thread(target=self._keep_alive, name="kickctl link", daemon=True).start()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Give control back and hang up. The robot goes on as it is."""
        with self._lock:
            if self._closed.is_set():
                return
            with suppress(KickctlError):
                self.release()
            self._closed.set()
            self._broken = NoLink("this connection has been closed", "call connect again")
            self.link.close()

    @property
    def trusted(self) -> bool:
        """Whether robot and host have shown each other the token."""
        return self._talk.trusted

    @property
    def drives(self) -> bool:
        """Whether this connection controls the robot, as far as it knows."""
        return self._leased

    def lease(self) -> None:
        """Take control. Others may look on and stop the robot.

        Raises:
            LeaseLost: Another host controls the robot.
            RefusedByRobot: This machine does not have the robot's token.
        """
        self.request("lease", sealed=True)
        self._leased = True

    def release(self) -> None:
        """Give control back; the robot goes on as it is."""
        if self._leased:
            self._leased = False
            self.request("release", sealed=True)

    def request(
        self, command: str, arguments: dict[str, Any] | None = None, *, sealed: bool = False
    ) -> dict[str, Any]:
        """Ask the robot something. What a broken link swallowed is sent again over the next one.

        Args:
            command: One of the robot's commands.
            arguments: What belongs to it.
            sealed: Whether it moves or changes the robot, for which the token is needed.

        Returns:
            The robot's answer.

        Raises:
            KickctlError: The robot refuses, does not answer, or cannot be reached.
        """
        with self._lock:
            if sealed and not self._talk.trusted:
                raise RefusedByRobot(
                    "this machine does not have the robot's token, so it may only look, and stop"
                    " the robot",
                    f"`{deploy_command()}` gives it to both; or copy the robot's token file to"
                    f" {default_path()}, mode 600",
                )
            return self._exchange(
                lambda: self._talk.request(command, arguments or {}, sealed), command
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
        for way in ways if self.link.opens_fast else reversed(ways):
            try:
                return way()
            except NoLink as failure:
                failures.append(failure)
        raise failures[0]

    def _stop_aside(self) -> Stopped:
        return stop_robot(self.link.another(), self.name)

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

    def pump(self, timeout_s: float) -> bool:
        """Take in what the robot has sent.

        Args:
            timeout_s: How long to wait for the first of it (s).

        Returns:
            Whether anything came.

        Raises:
            NoLink: The link broke and did not come back.
        """
        with self._lock:
            came = self._pump(timeout_s)
            self.stream.raise_failure()
            return came

    def _pump(self, timeout_s: float) -> bool:
        if self._broken is not None:
            raise self._broken
        try:
            self._send_what_is_due(self.link.now())
            return self._read(timeout_s)
        except LinkLost:
            self._reopen()
            return False

    def _read(self, timeout_s: float) -> bool:
        data = self.link.receive(timeout_s)
        self.stream.take(list(self._talk.feed(data)))
        return bool(data)

    def _send(self, frame: bytes) -> None:
        with self._sending:
            self.link.send(frame)

    def _send_what_is_due(self, now: float) -> None:
        if self._leased and now >= self._heartbeat_due:
            self._heartbeat_due = now + HEARTBEAT_S
            self._send(self._talk.request("heartbeat", {}, sealed=True)[1])
        tick = self.stream.tick_to_ask_for(now)
        if tick is not None:
            self._send(self._talk.request("subscribe", {"from": tick}, sealed=False)[1])

    def _exchange(self, make: Callable[[], tuple[int, bytes]], what: str) -> dict[str, Any]:
        if self._broken is not None:
            raise self._broken
        while True:
            session = self._talk.session
            number, frame = make()
            try:
                self._send(frame)
            except LinkLost:
                self._reopen()
                continue
            until = self.link.now() + self.answer_s
            while session == self._talk.session:
                answer = self._talk.answer(number)
                if answer is not None:
                    return answer
                if self.link.now() > until:
                    raise NoLink(
                        f"the robot does not answer to '{what}'",
                        "is its program alive? Look at its screen",
                    )
                self.pump(HEARTBEAT_S)

    def _open(self) -> None:
        """Say hello, prove the token, and take the lease again if this host had it."""
        self.link.open()
        try:
            greet(self.link, self._talk, self._send, self.answer_s)
            if self._leased:
                self._retake_lease()
        except LinkLost as error:
            self._talk.raise_refusal()
            raise NoLink(
                f"the robot at {self.link.uri} hung up: {error}",
                "is another program listening at that port?",
            ) from error

    def _reopen(self) -> None:
        """Find the robot again, to go on in its record where the link broke."""
        if self._broken is not None:
            raise self._broken
        self.on_trouble(
            f"the link to {self.link.uri} broke; looking for the robot for {self.reconnect_s:g} s"
        )
        until = self.link.now() + self.reconnect_s
        pause = 0.05
        while True:
            try:
                self._open()
                break
            except NoLink as error:
                if (
                    self._closed.wait(0.0 if self.link.virtual else pause)
                    or self.link.now() >= until
                ):
                    self._broken = NoLink(
                        f"the link to {self.link.uri} broke and did not come back: {error.message}",
                        error.hint,
                    )
                    raise self._broken from error
                pause = min(1.0, 2.0 * pause)
        self.stream.interrupt()
        if self._talk.hello["boot"] != self.hello["boot"]:
            self.hello = self._talk.hello
            self.clock_zero_s = self._clock_zero()
            self.stream.restart(self.hello, self.clock_zero_s)

    def _retake_lease(self) -> None:
        number, frame = self._talk.request("lease", {}, sealed=True)
        self._send(frame)
        try:
            hear(
                self.link,
                self._talk,
                lambda: self._talk.answer(number) is not None,
                self.answer_s,
            )
        except RefusedByRobot:
            self._leased = False

    def _clock_zero(self) -> float:
        """UTC, in Unix seconds, when the robot's clock was at zero."""
        return datetime.now(UTC).timestamp() - float(self._talk.hello["clock_s"])

    def _keep_alive(self) -> None:
        while not self._closed.wait(HEARTBEAT_S / 2):
            if self._lock.acquire(blocking=False):
                try:
                    if not self._closed.is_set() and (self._leased or self.stream.wanted):
                        while self._pump(0.0):
                            pass
                except KickctlError:
                    return
                finally:
                    self._lock.release()
