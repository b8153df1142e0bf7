"""A link to a robot that is opened again when it breaks, and the conversation over it."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from copy import copy
from datetime import UTC, datetime
from typing import Any
from weakref import finalize, ref

from host.client import neighbours
from host.client.access import greet, hear
from host.client.conversation import Conversation
from host.client.silence import Silence
from host.client.stream import Stream
from host.errors import KickctlError, NoLink, RefusedByRobot, WrongUse
from host.link.transport import Link, LinkLost
from host.util.arguments import need_seconds, shown, wrong
from host.util.callbacks import failure_of
from host.util.interrupts import uninterrupted
from host.util.own_name import need_name, own_name
from robot.wire import TOKEN_BYTES
from robot.words import person

# The robot counts a silent host as lost after half a second by default.
HEARTBEAT_S = 0.1
# A link that breaks sooner was no good one: the pause before the next attempt grows.
GOOD_S = 5.0
FIRST_PAUSE_S, GROWTH, LONGEST_PAUSE_S = 0.1, 3.0, 10.0


class LastingLink:
    """One conversation with a robot, over a link that is found again when it breaks.

    A link is broken when it says so, and when it is silent although the robot has to answer or to
    send records. A serial line also is when the robot ends the conversation over it, as one does
    that has opened its end anew.

    Args:
        link: The way to the robot, not opened yet.
        token: The robot's token; None observes.
        name: Who this is, for the robot and for other people, in at most 40 letters; by default
            the user and the machine, as in `anna@lab-3`.

    Attributes:
        link: The way to the robot.
        hello: What the robot has said of itself.
        stream: What it sends to who subscribes.
        on_trouble: Called with words for people when the link breaks.
        attended: Whether somebody is there for whom this program drives the robot. While it says
            no, no heartbeats are sent, and the robot soon takes this host for lost.
        answer_s: How long the robot may take to answer.
        silence_s: How long a link on which something is due may carry nothing.
        reconnect_s: How long a lost robot is looked for.
    """

    answer_s = 5.0
    silence_s = 2.0
    reconnect_s = 10.0

    def __init__(self, link: Link, token: bytes | None, name: str | None = None) -> None:
        name = own_name() if name is None else need_name(name)
        _check(link, token)
        self.link = link
        self.name = name
        self.stream = Stream()
        self.on_trouble: Callable[[str], None] = lambda words: None
        self.attended: Callable[[], bool] = lambda: True
        self._talk = Conversation(token, name, client=neighbours.client_id())
        self._lock = threading.RLock()
        self._sending = threading.Lock()
        self._control = neighbours.Control(name, link)
        self._heartbeat_due = 0.0
        self._silence = Silence()
        self._give_up_at: float | None = None
        self._whole = False
        self._pause_s = 0.0
        self._closed = threading.Event()
        self._leaving = threading.Event()  # set before it is closed: nobody looks for the robot
        self._broken: KickctlError | None = None
        self._endings: list[Callable[[KickctlError | None], object]] = []
        self._hang_up = finalize(self, _hang_up, link, self._closed, self._endings, self._control)
        self._hang_up.atexit = False
        self.hello: dict[str, Any] = {"boot": None}
        left = neighbours.arrive(self)
        with self._lock:
            try:
                self._open()
            except BaseException:
                self._hang_up()
                for control in left:
                    neighbours.inherit(control)
                raise
            self.hello = self._talk.hello
            self.started_utc = datetime.now(UTC)
            self.clock_zero_s = self._clock_zero()
            self._opened_s = link.now()
            self._whole = True
            for control in left:
                neighbours.inherit(control)
        if not link.virtual:
            arguments = ref(self), self._closed
            threading.Thread(
                target=_keep_alive, args=arguments, name="kickctl link", daemon=True
            ).start()

    @property
    def is_open(self) -> bool:
        """Whether it has neither been closed nor given up."""
        return self._broken is None

    @property
    def trusted(self) -> bool:
        """Whether robot and host have shown each other the token."""
        return self._talk.trusted

    @property
    def token_refused(self) -> bool:
        """Whether the robot has another token than this host, which may only look and stop it."""
        return self._talk.token_refused

    @property
    def drives(self) -> bool:
        """Whether this connection controls the robot, as far as it knows."""
        return self._control.held

    @property
    def may_drive(self) -> bool:
        """Whether it is open, and robot and host have shown each other the token."""
        return self._broken is None and self.trusted

    def _end(self, why: str) -> None:
        self._leaving.set()
        self._control.held = False
        self._broken = NoLink(why, "call connect again")
        self._hang_up()

    def give_way(self) -> neighbours.Control:
        """Hang up, since a newer connection of this program needs the line.

        Returns:
            Whether this connection drove the robot, for the newer one.
        """
        # Whoever reads the line now is done within a moment; a stop may not wait for longer.
        locked = self._lock.acquire(timeout=1.0)
        try:
            left = copy(self._control)
            self._end("a newer connection of this program has taken over the line")
            return left
        finally:
            if locked:
                self._lock.release()

    def gain_control(self) -> None:
        """This connection drives the robot now, instead of another one of this program."""
        self._heartbeat_due = 0.0
        self._talk.taken_over_by = self._control.taken_over_by = None
        self._control.boot = self._talk.hello["boot"]
        self._control.held = True

    def lose_control(self) -> None:
        """Another connection of this program drives the robot now."""
        self._control.held = False

    def _hear_of_takeover(self) -> None:
        """Give up control if somebody has taken over; only a person takes it back."""
        if not self._control.held or self._talk.taken_over_by is None:
            return
        self._control.held = False
        self._control.taken_over_by = self._talk.taken_over_by
        logging.getLogger("kickctl").warning(
            "%s has taken over the robot at %s; this program no longer drives it",
            person(self._talk.taken_over_by),
            self.link.uri,
        )

    def pump(self, timeout_s: float) -> bool:
        """Take in what the robot has sent.

        Args:
            timeout_s: How long to wait for the first of it (s).

        Returns:
            Whether anything came.

        Raises:
            NoLink: The link broke and did not come back.
        """
        until = self.link.now() + need_seconds("timeout_s", timeout_s)
        with self._lock:
            came = False
            while not came:
                left_s = until - self.link.now()
                came = self._pump(max(0.0, min(left_s, HEARTBEAT_S)))
                self.stream.raise_failure()
                if left_s <= HEARTBEAT_S:
                    break
            return came

    def _pump(self, timeout_s: float) -> bool:
        if self._broken is not None:
            raise self._broken
        if not self._whole:
            self._reopen("it was left half open")
            return False
        try:
            self._send_what_is_due(self.link.now())
            came = self._read(timeout_s)
            if self.link.is_line and self._talk.refused is not None:
                raise LinkLost(self._talk.refused)
            if not came and self._silence.lasts(self.link.now()) > self.silence_s:
                raise LinkLost(f"nothing has come over it for {self.silence_s:g} s")
        except LinkLost as error:
            self._reopen(str(error))
            return False
        return came

    def _read(self, timeout_s: float) -> bool:
        # ^C waits until what has arrived is handed on, or it would be lost for some and not for
        # others.
        with uninterrupted():
            data = self.link.receive(timeout_s)
            if data:
                self._give_up_at = None
                self._silence.hear(self.link.now(), more=self.stream.wanted)
                self.stream.take(list(self._talk.feed(data)), self.link.now())
                self._hear_of_takeover()
        self.stream.call_after()
        return bool(data)

    def _send(self, frame: bytes) -> None:
        with self._sending, uninterrupted():
            self.link.send(frame)
            self._silence.ask(self.link.now())

    def _send_what_is_due(self, now: float) -> None:
        if self._control.held and now >= self._heartbeat_due and self.attended():
            self._heartbeat_due = now + HEARTBEAT_S
            self._send(self._talk.beat())
        tick = self.stream.tick_to_ask_for(now)
        if tick is not None:
            self._send(self._talk.request("subscribe", {"from": tick}, sealed=False)[1])

    def _open(self) -> None:
        """Say hello, prove the token, and take the lease again if this host had it."""
        self._whole = False
        self.link.open()
        try:
            greet(self.link, self._talk, self._send, self.answer_s)
            self._hear_of_takeover()
            if self._control.held:
                self._retake_lease()
            self._silence.begin()
        except LinkLost as error:
            self._talk.raise_refusal()
            raise NoLink(
                f"the robot at {self.link.uri} hung up: {error}",
                "is another program listening at that port?",
            ) from error

    def _reopen(self, why: str) -> None:
        """Find the robot again, to go on in its record where the link broke."""
        if self._broken is not None:
            raise self._broken
        self._say(
            f"the link to {self.link.uri} broke ({why}); looking for the robot for"
            f" {self.reconnect_s:g} s"
        )
        if self.link.now() - self._opened_s >= GOOD_S:
            self._pause_s = 0.0
        else:
            longer_s = max(FIRST_PAUSE_S, GROWTH * self._pause_s)
            self._pause_s = min(LONGEST_PAUSE_S, longer_s)
        # A robot that lets everybody in and says nothing more is as lost as one that is not there.
        if self._give_up_at is None:
            self._give_up_at = self.link.now() + self._pause_s + self.reconnect_s
        failure = NoLink(why, "is its program alive? `kickctl doctor` looks closer")
        pause_s = 0.05
        self._rest(self._pause_s)
        while self.link.now() < self._give_up_at and not self._leaving.is_set():
            try:
                self._open()
                break
            except NoLink as error:
                failure = error
            except KickctlError as refusal:
                # A robot that says no, such as one without a free place, is not asked again.
                self._give_up(refusal)
                raise
            self._rest(pause_s)
            pause_s = min(1.0, 2.0 * pause_s)
        else:
            self.link.close()
            lost = NoLink(
                f"the link to {self.link.uri} broke and did not come back: {failure.message}",
                failure.hint,
            )
            self._give_up(lost)
            raise lost from failure
        if self._closed.is_set():  # meanwhile, and by somebody who did not wait
            self.link.close()
            raise NoLink("this connection has been closed", "call connect again")
        self._opened_s = self.link.now()
        self.stream.interrupt()
        if self._talk.hello["boot"] != self.hello["boot"]:
            self.hello = self._talk.hello
            self.clock_zero_s = self._clock_zero()
            self.stream.restart(self.hello, self.clock_zero_s)
        self._whole = True

    def _say(self, words: str) -> None:
        """Words for people; a function of theirs that fails must not end the link."""
        failure = failure_of(lambda: self.on_trouble(words))
        if failure is not None:
            logging.getLogger("kickctl").error("on_trouble failed", exc_info=failure)

    def _give_up(self, why: KickctlError) -> None:
        """The link is gone for good: who waits for records must not wait for ever."""
        self._control.held = False
        self._broken = why
        for end in list(self._endings):
            end(why)

    def _rest(self, seconds: float) -> None:
        """Let time pass before the next attempt, unless the connection is closed."""
        self._leaving.wait(0.0 if self.link.virtual else seconds)

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
            self.gain_control()
        except RefusedByRobot:
            self._control.held = False

    def _clock_zero(self) -> float:
        """UTC, in Unix seconds, when the robot's clock was at zero."""
        return datetime.now(UTC).timestamp() - float(self._talk.hello["clock_s"])

    def _look_after(self) -> bool:
        """Read what has come, and send what is due. Returns False if the link is gone for good."""
        if self._lock.acquire(blocking=False):
            try:
                if not self._closed.is_set() and (self._control.held or self.stream.wanted):
                    while self._pump(0.0):
                        pass
            except KickctlError:
                return False
            except Exception as failure:
                # The robot stops when this thread ends, and nobody would know why.
                logging.getLogger("kickctl").exception("the thread of a link failed")
                self._give_up(
                    NoLink(f"the link to {self.link.uri} failed: {failure!r}", "call connect again")
                )
                return False
            finally:
                self._lock.release()
        return True


def _check(link: object, token: object) -> None:
    """Raise WrongUse for what a connection cannot be made of."""
    if not hasattr(link, "another"):
        raise WrongUse(
            f"a link to a robot cannot be {shown(link)}", "call connect(ADDRESS) instead of Robot()"
        )
    if token is not None and not isinstance(token, bytes):
        raise wrong("token", token, f"its {TOKEN_BYTES} bytes, or None to look on")


def _keep_alive(connection: ref[LastingLink], closed: threading.Event) -> None:
    """Look after a connection for as long as somebody else refers to it."""
    while not closed.wait(HEARTBEAT_S / 2):
        present = connection()
        if present is None or not present._look_after():  # noqa: SLF001
            return
        del present


def _hang_up(
    link: Link,
    closed: threading.Event,
    endings: list[Callable[[KickctlError | None], object]],
    control: neighbours.Control,
) -> None:
    """End a connection and what lives on it, without giving control back to the robot."""
    closed.set()
    neighbours.inherit(control)  # first: an ssh process may take a while to end
    link.close()
    for end in list(endings):
        end(None)
