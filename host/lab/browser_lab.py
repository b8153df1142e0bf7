"""A lab for one page in the same browser: no server, no threads, no files.

The page's worker runs it under Pyodide. It has the lab's own session, and the robot's own program
on a simulated brick.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable
from typing import Any

from host.client.robot import Robot
from host.errors import KickctlError, NotDone
from host.kicking.steps import Slices
from host.lab.keys import Keys
from host.lab.outgoing import outgoing
from host.lab.session import Session
from host.lab.station import CONTINUE, HARMLESS, Answer, busy, stopped_meanwhile
from host.lab.stepped_station import SteppedStation
from host.link.direct import DirectLink
from sim_motor.brick import SimBrick
from sim_motor.hand import Grip

# How far the robot may fall behind the page's clock (s): it does not catch up a night asleep.
MOST_S = 0.5
TICK_S = 0.1


class BrowserStation(SteppedStation):
    """The robot of a page that runs it itself.

    Args:
        seed: Its random seed.
    """

    hand_possible = True

    def __init__(self, seed: int) -> None:
        brick = SimBrick(seed, jitter=False)
        link = DirectLink(f"sim://?seed={seed}", brick)
        super().__init__(Robot(link, link.token), "simulated", CONTINUE)
        self._grip = Grip(brick)
        self._performs: tuple[Slices[dict[str, Any]], Answer] | None = None

    def hand(self, wheel: str, angle_rad: float | None) -> None:
        if angle_rad is None:
            self._grip.let_go(wheel)
        else:
            self._grip.hold(wheel, angle_rad, self.clock())

    def catch_up(self, seconds: float) -> None:
        """Let the robot's time pass (s): as many ticks as have fitted into it."""
        tick_s = float(self._follower.params["tick_s"])
        for _ in range(int(seconds / tick_s)):
            self._grip.pull(self._link.loop)
            self.step(tick_s)
            self._go_on()

    def do(self, command: str, arguments: dict[str, Any], answer: Answer) -> None:
        """Carry out a command; a primitive goes on with the robot's time, so that pages draw it."""
        if command in HARMLESS or (command != "primitive" and self._performs is None):
            super().do(command, arguments, answer)
        elif self._performs is not None:
            answer(busy())
        else:
            steps = self._steps(self._robot, arguments["name"])
            self._performs = Slices(self._robot, steps), answer
            self._go_on()

    def stop(self) -> None:
        super().stop()
        self._go_on(stopped_meanwhile())

    def _go_on(self, break_off: KickctlError | None = None) -> None:
        """Do what a primitive under way has to do now, and answer once it is over."""
        if self._performs is None:
            return
        slices, answer = self._performs
        result: dict[str, Any] | KickctlError | None
        try:
            result = slices.go_on(break_off)
        except KickctlError as error:
            result = error
        if result is not None:
            self._performs = None
            answer(result)

    def _record(self, robot: Any, on: bool) -> dict[str, Any]:
        raise NotDone(
            "this page keeps no logs, since nothing is installed",
            "`kickctl lab` on a computer records them",
        )


class BrowserLab:
    """The lab, its robot, and the end of its page.

    Args:
        seed: Random seed of the robot.
        now: The time on the page's clock (s).
        send: Gets what the page has to hear: texts and binary messages, as MESSAGES.md has them.

    Attributes:
        station: The robot.
    """

    def __init__(self, seed: int, now: float, send: Callable[[str | bytes], object]) -> None:
        self.station = BrowserStation(seed)
        self.station.pages = self
        self._send = send
        self._calls: deque[Callable[[], object]] = deque()
        keys = Keys()
        self._session = Session(keys, [self.station])
        self._page = self._session.arrive(now, local=True)
        self._began = now - self.station.clock()
        self._due = now
        self.receive(json.dumps({"type": "join", "key": keys.drive}, allow_nan=False), now)

    def receive(self, text: str, now: float) -> None:
        """Take in a message of the page.

        Args:
            text: The message, as MESSAGES.md has it.
            now: The time on the page's clock (s).
        """
        self._session.receive(self._page, text, now)
        self._deliver()

    def step(self, now: float) -> None:
        """Let the robot's time pass up to the page's; to be called some fifty times a second.

        Args:
            now: The time on the page's clock (s).
        """
        # It may be behind by too much, or ahead: a primitive takes its seconds all at once.
        robot_s = self.station.clock()
        behind_s = min(max(now - self._began - robot_s, 0.0), MOST_S)
        self._began = now - robot_s - behind_s
        self.station.catch_up(behind_s)
        if now >= self._due:
            self._due = now + TICK_S
            self._session.tick(now)
        self._deliver()

    # What the station calls.

    def hear(self, message: dict[str, Any]) -> None:
        """Give a message to the page."""
        self._calls.append(lambda: self._session.hear(message))

    def wake(self) -> None:
        """There are new records, or the state has changed."""

    def call(self, function: Callable[[], object]) -> None:
        """Call a function once what goes on now is done."""
        self._calls.append(function)

    def _deliver(self) -> None:
        """Do what waits, and send the page what there is."""
        while self._calls:
            self._calls.popleft()()
        self._session.look()
        for message in outgoing(self._page, self._session.rings):
            self._send(message)
