"""A robot as seen from the host, for programs and notebooks.

    with connect("sim://") as robot:
        robot.kick("phase", ticks=4)
        log = robot.record(5)

Calls block. Links to real robots are kept alive by a thread between calls; an embedded robot's time
passes only within them.
"""

from __future__ import annotations

import os
import threading
import uuid
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from host.client.conversation import Conversation, Samples
from host.client.subscription import Subscription
from host.errors import KickctlError, LeaseLost, NoLink, RefusedByRobot, WrongUse
from host.link.addresses import SIM, make_link
from host.link.transport import Link, LinkLost
from host.util.installation import deploy_command
from host.util.provenance import origin
from robot.record import Record
from robot.token import TokenError, default_path, load

if TYPE_CHECKING:
    from types import TracebackType

    from host.logs.log import Log
    from host.logs.tap import Tap

# The robot counts a silent host as lost after half a second by default.
HEARTBEAT_S = 0.1
ANSWER_S = 5.0
RECONNECT_S = 10.0
# How long a new subscription may take to show before it is asked for again.
RESUBSCRIBE_S = 1.0
_RECENT_RECORDS = 400


def connect(
    uri: str | None = None,
    seed: int | None = None,
    token: str | None = None,
    name: str = "kickctl",
    *,
    observe: bool = False,
) -> Robot:
    """The robot at `uri`: by default $KICK_BRICK, or the embedded simulated robot.

    seed fixes all chances of the simulated robot; token is the path of the token file. To observe,
    which needs no token, is to look, and to stop the robot if need be. Raises KickctlError.
    """
    link = make_link(uri or os.environ.get("KICK_BRICK") or SIM, seed)
    return Robot(link, None if observe else find_token(link, token), name)


def find_token(link: Link, path: str | None = None) -> bytes | None:
    """The token for a link: its own if it has one, else the file's.

    None if there is no default file. Raises RefusedByRobot.
    """
    own: bytes | None = getattr(link, "token", None)
    if own is not None:
        return own
    chosen = path or default_path()
    if path is None and not Path(chosen).exists():
        return None
    try:
        secret: bytes = load(chosen)
    except TokenError as error:
        raise RefusedByRobot(
            str(error), "name another token file by --token, or leave it to the default place"
        ) from error
    return secret


class Robot:
    """A connected robot. Every method that talks to it raises KickctlError in words when that fails."""

    def __init__(self, link: Link, token: bytes | None, name: str = "kickctl") -> None:
        self.link = link
        self._talk = Conversation(token, name, client=uuid.uuid4().hex)
        self._lock = threading.RLock()
        self._taps: list[Tap] = []
        self._place = Subscription()
        self._subscribe_due = 0.0
        self._recent: deque[Record] = deque(maxlen=_RECENT_RECORDS)
        self._leased = False
        self._heartbeat_due = 0.0
        self._closed = threading.Event()
        self._broken: KickctlError | None = None
        self.on_trouble: Callable[[str], None] = lambda words: None
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
            self._broken = NoLink("this connection has been closed", "connect anew")
            self.link.close()

    @property
    def trusted(self) -> bool:
        """Whether robot and host have shown each other the token."""
        return self._talk.trusted

    def status(self) -> dict[str, Any]:
        """State, parameters in force, battery, controller, and how punctual its ticks are."""
        return self._request("status")

    def describe(self, table: str) -> list[dict[str, Any]]:
        """The robot's own table of 'params', 'channels' or 'commands'."""
        rows: list[dict[str, Any]] = self._request("describe", {"table": table})["table"]
        return rows

    def lease(self) -> None:
        """Take control. Others may look on and stop the robot."""
        self._request("lease", sealed=True)
        self._leased = True

    def release(self) -> None:
        """Give control back; the robot goes on as it is."""
        if self._leased:
            self._leased = False
            self._request("release", sealed=True)

    def start(self) -> int:
        """Run from random membrane potentials. Returns the first tick."""
        return self._control("start")

    def stop(self) -> int:
        """Stop the motors; needs neither token nor control. Returns the first tick of the stop."""
        with self._lock:
            return int(self._exchange(self._talk.stop_frame, None, ANSWER_S)["tick"])

    def clear(self) -> int:
        """Leave a fault. Returns the tick."""
        return self._control("clear")

    def set(self, **changes: float | str) -> int:
        """Change parameters, all or none. Returns the first tick in which they hold."""
        return self._control("set", set=changes)

    def kick(self, mode: str, **details: Any) -> int:
        """Kick: mode and the fields of robot.kicks.parse (ticks, wheel, shift, ...).

        Returns the tick in which it began.
        """
        kick = {"id": uuid.uuid4().hex, "mode": mode}
        kick.update((name, value) for name, value in details.items() if value is not None)
        return self._control("kick", kick=kick)

    def record(self, seconds: float) -> Log:
        """The log of the next `seconds` of the robot's time."""
        from host.logs.log import Log

        log = Log(self.info())
        self.add_tap(log)
        try:
            self.wait(seconds)
        finally:
            self.remove_tap(log)
        return log

    def wait(self, seconds: float, until: Callable[[], bool] | None = None) -> bool:
        """Let `seconds` of the robot's time pass, as counted by its records, or until `until()` is true. Returns whether it was."""
        if not seconds >= 0.0:
            raise WrongUse(
                f"nobody can wait for {seconds!r} s", "give a number of seconds, 0 or more"
            )
        self._subscribe()
        first = self.newest
        silent_since = self.link.now()
        while until is None or not until():
            newest = self.newest
            if newest is not None:
                if first is None or newest.tick < first.tick:
                    first = newest
                if newest.t_s - first.t_s >= seconds:
                    return False
            if self.pump(HEARTBEAT_S):
                silent_since = self.link.now()
            elif self.link.now() - silent_since > ANSWER_S + RECONNECT_S:
                raise NoLink(
                    "the robot sends no more records",
                    "look at its screen; `kickctl doctor` tells more",
                )
        return True

    @property
    def newest(self) -> Record | None:
        """The latest record."""
        return self._recent[-1] if self._recent else None

    def recent(self) -> list[Record]:
        """The latest records, oldest first."""
        return list(self._recent)

    def add_tap(self, tap: Tap) -> None:
        """Feed a tap with everything that the robot sends from now on."""
        with self._lock:
            self._subscribe()
            snapshot = self._place.snapshot()
            if snapshot is not None:
                tap.take_event(snapshot)
            self._taps.append(tap)

    def remove_tap(self, tap: Tap) -> None:
        """Feed it no more."""
        with self._lock:
            self._taps.remove(tap)

    def pull(self, tap: Tap) -> None:
        """Feed a tap with everything that the robot's black box holds, up to now."""
        with self._lock:
            self._request(
                "unsubscribe"
            )  # its answer comes behind the last record of the subscription that there was
            until = self._request("status")["tick"]
            self._place.begin(0)
            self._subscribe_due = 0.0
            self._taps.append(tap)
            self.wait(inf, until=lambda: (self._place.next_tick or 0) >= until)
            self.remove_tap(tap)

    def info(self) -> dict[str, Any]:
        """What a log must say of its origin."""
        return origin(self.link.uri, self.hello, self.status(), self.clock_zero_s, self.started_utc)

    def pump(self, timeout_s: float) -> bool:
        """Take in what the robot has sent, waiting up to timeout_s for it.

        Returns whether anything came.
        """
        with self._lock:
            if self._broken is not None:
                raise self._broken
            try:
                self._send_what_is_due(self.link.now())
                data = self.link.receive(timeout_s)
            except LinkLost:
                self._reopen()
                return False
            for item in self._talk.feed(data):
                self._take(item)
            return bool(data)

    def _send_what_is_due(self, now: float) -> None:
        if self._leased and now >= self._heartbeat_due:
            self._heartbeat_due = now + HEARTBEAT_S
            self.link.send(self._talk.request("heartbeat", {}, sealed=True)[1])
        if (
            self._place.next_tick is not None
            and not self._place.following
            and now >= self._subscribe_due
        ):
            self._subscribe_due = now + RESUBSCRIBE_S
            self.link.send(
                self._talk.request("subscribe", {"from": self._place.next_tick}, sealed=False)[1]
            )

    def _control(self, command: str, **arguments: Any) -> int:
        if not self._leased:
            self.lease()
        try:
            return int(self._request(command, arguments, sealed=True)["tick"])
        except LeaseLost:
            # The robot took this host for lost while the link was silent; what was refused has
            # changed nothing.
            self.lease()
            return int(self._request(command, arguments, sealed=True)["tick"])

    def _request(
        self, command: str, arguments: dict[str, Any] | None = None, sealed: bool = False
    ) -> dict[str, Any]:
        """The robot's answer. A request that a broken link swallowed is sent again over the new one."""
        with self._lock:
            if sealed and not self._talk.trusted:
                raise RefusedByRobot(
                    "this machine does not have the robot's token, so it may only look, and stop"
                    " the robot",
                    f"`{deploy_command()}` gives it to both; or copy the robot's token file to"
                    f" {default_path()}, mode 600",
                )
            return self._exchange(
                lambda: self._talk.request(command, arguments or {}, sealed), command, ANSWER_S
            )

    def _exchange(
        self, make: Callable[[], tuple[int | None, bytes]], what: str | None, patience_s: float
    ) -> dict[str, Any]:
        if self._broken is not None:
            raise self._broken
        while True:
            session = self._talk.session
            number, frame = make()
            try:
                self.link.send(frame)
            except LinkLost:
                self._reopen()
                continue
            until = self.link.now() + patience_s
            while session == self._talk.session:
                answer = self._talk.answer(number)
                if answer is not None:
                    return answer
                if self.link.now() > until:
                    raise NoLink(
                        f"the robot does not answer to '{what or 'stop'}'",
                        "is its program alive? look at its screen",
                    )
                self.pump(min(HEARTBEAT_S, patience_s))

    def _open(self) -> None:
        """Say hello, prove the token, and take the lease again if this host had it."""
        self.link.open()
        self._talk.begin()
        try:
            self.link.send(self._talk.hello_frame())
            self._await(lambda: bool(self._talk.hello))
            if self._talk.token is not None:
                self.link.send(self._talk.auth_frame())
                self._await(lambda: self._talk.trusted)
            if self._leased:
                self._retake_lease()
        except LinkLost as error:
            self._talk.raise_refusal()
            raise NoLink(
                f"the robot at {self.link.uri} hung up: {error}",
                "is another program listening at that port?",
            ) from error

    def _await(self, arrived: Callable[[], bool]) -> None:
        until = self.link.now() + float(getattr(self.link, "answer_s", ANSWER_S))
        while not arrived():
            if self.link.now() > until:
                raise NoLink(
                    f"nothing that speaks this protocol answers at {self.link.uri}",
                    "is it the robot's port? If so, its program hangs, and its watchdog has stopped"
                    " the motors",
                )
            self._talk.feed(self.link.receive(HEARTBEAT_S))
            self._talk.raise_refusal()

    def _reopen(self) -> None:
        """Find the robot again, to go on in its record where the link broke."""
        if self._broken is not None:
            raise self._broken
        self.on_trouble(
            f"the link to {self.link.uri} broke; looking for the robot for {RECONNECT_S:g} s"
        )
        until = self.link.now() + RECONNECT_S
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
        self._place.interrupt()
        self._subscribe_due = 0.0
        if self._talk.hello["boot"] != self.hello["boot"]:
            self.hello = self._talk.hello
            self.clock_zero_s = self._clock_zero()
            if self._place.next_tick is not None:
                self._place.begin(self.hello["oldest_tick"])
            self._tell(
                {
                    "event": "restart",
                    "tick": 0,
                    "boot": self.hello["boot"],
                    "clock_zero_s": self.clock_zero_s,
                }
            )

    def _retake_lease(self) -> None:
        number, frame = self._talk.request("lease", {}, sealed=True)
        self.link.send(frame)
        try:
            self._await(lambda: self._talk.answer(number) is not None)
        except RefusedByRobot:
            self._leased = False

    def _clock_zero(self) -> float:
        """UTC, in Unix seconds, when the robot's clock was at zero."""
        return datetime.now(UTC).timestamp() - float(self._talk.hello["clock_s"])

    def _subscribe(self) -> None:
        with self._lock:
            if self._place.next_tick is None:
                self._subscribe_due = self.link.now() + RESUBSCRIBE_S
                tick = self._request("subscribe")["tick"]
                if self._place.next_tick is None:
                    self._place.begin(tick)

    def _take(self, item: dict[str, Any] | Samples) -> None:
        if isinstance(item, Samples):
            fresh = self._place.take_samples(item)
            if fresh:
                self._recent.extend(fresh)
                for tap in self._taps:
                    tap.take_records(fresh)
        else:
            event = self._place.take_event(item)
            if event is not None:
                self._tell(event)

    def _tell(self, event: dict[str, Any]) -> None:
        for tap in self._taps:
            tap.take_event(event)

    def _keep_alive(self) -> None:
        while not self._closed.wait(HEARTBEAT_S / 2):
            if self._lock.acquire(blocking=False):
                try:
                    if not self._closed.is_set() and (
                        self._leased or self._place.next_tick is not None
                    ):
                        while self.pump(0.0):
                            pass
                except KickctlError:
                    return
                finally:
                    self._lock.release()
