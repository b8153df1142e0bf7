"""`kickctl watch` on several robots side by side: a row for each, and keys for all of them."""

from __future__ import annotations

import argparse
import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Any

from host.client.robot import Robot, connect
from host.client.stop import Stopped, stop_robot
from host.commands._keys import keys, why_no_keys
from host.commands._terminal import as_dict, say, show_next
from host.commands._watch_keys import FOOT, HELP_FOOT, HELP_KEY, KeyActions, in_a_line
from host.commands._watch_lines import lines
from host.commands._watch_table import SeveralRobots
from host.errors import KickctlError, NoLink
from host.link.names import link_to
from host.link.robots_file import Known

_LOOK_S = 0.1
# A robot that is being looked for when the watch ends need not be found any more.
_LEAVE_S = 1.0

Take = Callable[[str, dict[str, Any]], object]


class _Row:
    """One of the robots, watched by a thread of its own.

    Attributes:
        name: The robot's name.
        actions: What keys do to it, also before it is connected.
        error: What has ended the watch; None if nothing has.
    """

    def __init__(
        self, robot: Known, options: argparse.Namespace, take: Take, add: Callable[[str], object]
    ) -> None:
        self.name = robot.name
        self.error: BaseException | None = None
        self.actions = KeyActions(
            self._stop, self._say, lambda foot: None, take_over=options.keys_take_over
        )
        self._chosen = robot
        self._options = options
        self._take = take
        self._add = add
        self._robot: Robot | None = None
        self.thread = threading.Thread(target=self._run, name="kickctl row", daemon=True)

    def _run(self) -> None:
        options, actions = self._options, self.actions
        try:
            with connect(self.name, options.seed, options.token) as robot:
                robot.on_trouble = self._say
                self._robot = robot
                for line in lines(robot, options.seconds, lambda: actions.waiting, actions.pause):
                    self._take(self.name, line)
                    actions.kick(robot)
                    if actions.left:
                        break
        except BaseException as error:  # noqa: BLE001 - the main thread says it
            self.error = error
            if isinstance(error, KickctlError):
                self._say(in_a_line(error))

    @property
    def connected(self) -> bool:
        """Whether the robot has let this host in."""
        return self._robot is not None

    def _stop(self) -> Stopped:
        """Stop the robot, over a link of its own until it is connected."""
        if self._robot is not None:
            return self._robot.stop_at_once()
        return stop_robot(link_to(self._chosen, self._options.seed))

    def _say(self, words: str) -> None:
        self._add(f"{self.name}: {words}")


def watch_several(options: argparse.Namespace, robots: list[Known]) -> int:
    """Watch robots side by side until each has been watched for the time of the options.

    Args:
        options: Say for how long, and whether to print lines of JSON.
        robots: The robots.

    Returns:
        The exit status: the highest of all.
    """
    lacking = why_no_keys()
    foot = [f"no keys: {lacking}"] if lacking else [*FOOT, "each key is for all of them"]
    screen = SeveralRobots([robot.name for robot in robots], foot)
    printing = threading.Lock()

    def show(name: str, line: dict[str, Any]) -> None:
        with printing:
            show_next({"robot": name, **line})

    take, add = (show, say) if options.json else (screen.take, screen.add)
    rows = [_Row(robot, options, take, add) for robot in robots]
    helps = False

    def press(key: str) -> None:
        nonlocal helps
        if key == HELP_KEY:
            helps = not helps
            screen.change_foot(HELP_FOOT if helps else foot)
            return
        for row in rows:
            row.actions.press(key)

    with ExitStack() as stack:
        if not options.json:
            stack.enter_context(screen.shown())
        for row in rows:
            stack.callback(row.actions.close)
        if not options.json and not lacking:
            stack.enter_context(keys(press, screen.close, screen.open))
        for row in rows:
            row.thread.start()
        with suppress(KeyboardInterrupt):
            _wait(rows)
        for row in rows:
            row.actions.leave()
        for row in rows:
            row.thread.join(_LEAVE_S)
    return _conclude(rows, show if options.json else None)


def _wait(rows: list[_Row]) -> None:
    """Until all threads have ended, or the person leaves, or something fails that has no words."""
    while any(row.thread.is_alive() for row in rows):
        for row in rows:
            row.thread.join(_LOOK_S / len(rows))
            if row.actions.left or not isinstance(row.error, KickctlError | None):
                return


def _conclude(rows: list[_Row], show: Take | None) -> int:
    """Say what has ended the watch of each robot. Returns the exit status."""
    status = 0
    for row in rows:
        if row.error is None and not row.connected:
            row.error = NoLink(
                "the robot has not answered", "is it switched on? See kickctl doctor"
            )
        if isinstance(row.error, KickctlError):
            status = max(status, row.error.status)
            say(f"kickctl: {row.name}: {in_a_line(row.error)}")
            if show is not None:
                show(row.name, {"error": as_dict(row.error)})
        elif row.error is not None:
            raise row.error
    return status
