"""A robot's news for a notebook's widget: the Python end of notebook_robot.js.

A thread of its own sends what is new. Neither the link nor a call of the person ever waits for it,
and it ends when nobody looks any more.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from math import inf
from typing import Any
from weakref import ref

from host.client.stop import stop_robot
from host.client.watching import Watcher
from host.errors import KickctlError
from host.lab.observed import Observed
from host.lab.ring import MOST_RECORDS
from host.link.names import name_at

# How often news is sent (s): messages of a notebook are dear, and each carries several ticks.
EVERY_S = 0.05
# How often the state is looked at when there is no news (s).
LOOK_S = 1.0
# How long after the last sign of a page news is still sent (s). A page that is hidden gives none.
PATIENCE_S = 60.0
MOST_WAITING = 400
CLOSED = "the connection to the robot is closed: what you see is old"

Send = Callable[[dict[str, Any], list[bytes] | None], object]


class ShownRobot(Observed):
    """Follows a robot for a widget; a Tap of its stream.

    It does not keep the connection alive: what nobody else refers to hangs up as always.

    Args:
        robot: The connection to the robot.
        send: Sends the widget's pages a message, and buffers with it; called in several threads.
        forget: Called at the end.
    """

    def __init__(self, robot: Watcher, send: Send, forget: Callable[[], object]) -> None:
        self._robot = ref(robot)
        self._link = robot.link
        self._embedded = robot.link.virtual
        uri = robot.link.uri
        label = "simulated" if self._embedded else "real"
        super().__init__(name_at(uri) or uri, uri, label)
        self._send = send
        self._forget = forget
        self._waiting: deque[dict[str, Any]] = deque(maxlen=MOST_WAITING)
        self._news = threading.Event()
        self._over = threading.Event()
        self._heard_of_page = -inf
        self._joins = False
        self._place = 0
        self._told = ("", "", "")
        self._meet(robot)
        robot.add_tap(self)

    def begin(self) -> None:
        """Send what is new from now on."""
        threading.Thread(target=self._serve, name="kickctl notebook", daemon=True).start()

    def clock(self) -> float:
        return time.monotonic()

    def drives_here(self) -> bool:
        robot = self._robot()
        return robot is not None and robot.drives

    def state(self) -> dict[str, Any]:
        """What a `state` message says. An embedded robot that rests is not lost."""
        message, robot = super().state(), self._robot()
        if robot is None or not robot.is_open:
            return message | {"link": "lost", "closed": CLOSED}
        return message | {"link": "up", "since_s": 0.0} if self._embedded else message

    def take(self, message: dict[str, Any]) -> None:
        """Take a message of a page. It returns at once: a stop may be behind it."""
        kind, now = message.get("type"), self.clock()
        if kind == "stop":
            threading.Thread(target=self._stop, daemon=True).start()
        elif kind == "leave":
            self._over.set()
        elif kind in ("join", "here"):
            # Who was away for long has missed events.
            self._joins |= kind == "join" or now - self._heard_of_page > PATIENCE_S
            self._heard_of_page = now
        self._news.set()

    def _stop(self) -> None:
        """Stop the robot, also over a connection that is closed. Past everything that waits."""
        robot = self._robot()
        try:
            stopped = stop_robot(self._link) if robot is None else robot.stop_at_once()
        except KickctlError as error:
            words = {"message": error.message, "hint": error.hint}
            self._send({"type": "unconfirmed", **words}, None)
            return
        self._send({"type": "stopped", "said": stopped.sentence()}, None)
        if self._embedded and robot is not None:
            with suppress(KickctlError):  # it is closed
                robot.pump(0.0)  # or what the page shows would move on only with the next call

    # The thread that sends.

    def _serve(self) -> None:
        while not self._over.wait(EVERY_S):
            self._news.wait(LOOK_S)
            self._news.clear()
            self.tell()
        robot = self._robot()
        if robot is not None:
            robot.remove_tap(self)
        self._forget()

    def tell(self) -> None:
        """Send the pages what is new, if there is one that takes it."""
        if self._joins:
            self._joins = False
            self._waiting.clear()
            robot = self.description()
            self._send({"type": "welcome", "robot": robot, "embedded": self._embedded}, None)
            self._place = self.ring.recent
            self._told = ("", "", "")
        if self.clock() - self._heard_of_page > PATIENCE_S:
            return
        while self._waiting:
            self._send(self._waiting.popleft(), None)
        while self._place < self.ring.end:
            portion = self.ring.read(self._place, MOST_RECORDS)
            self._place = portion.place
            self._send({"type": "records"}, [portion.message(0)])
        state = self.state()
        told = (str(state["link"]), str(state.get("state")), str(state.get("reason")))
        if told != self._told:
            self._told = told
            self._send(state, None)

    def _hear(self, message: dict[str, Any]) -> None:
        if message["type"] != "welcome":  # the snapshot comes as an event, too
            self._waiting.append(message)

    def _wake(self) -> None:
        self._news.set()
