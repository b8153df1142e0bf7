"""What keys do while a robot is watched: stop it, kick it, leave."""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from math import pi
from typing import TYPE_CHECKING, Any, NamedTuple

from host.commands._hints import as_typed
from host.errors import KickctlError

if TYPE_CHECKING:
    from host.client.robot import Robot
    from host.client.stop import Stopped

# A kick that could not be sent for so long is not what anybody wants any more (s).
STALE_S = 1.0
HELP_KEY, QUIT_KEY, STOP_KEY = "?", "q", " "


class KeyKick(NamedTuple):
    """A kick on a key."""

    title: str
    help: str
    details: dict[str, Any]


KICKS = {
    "1": KeyKick(
        "membrane",
        "membrane inversion: both neurons change sign in one tick",
        {"mode": "membrane"},
    ),
    "2": KeyKick(
        "position",
        "position inversion: the neurons see the rods mirrored for 3 ticks",
        {"mode": "position", "ticks": 3},
    ),
    "3": KeyKick(
        "phase +",
        "phase shift: the neurons see the rods turned by +3pi/4 for 4 ticks",
        {"mode": "phase", "ticks": 4, "shift": 3 * pi / 4},
    ),
    "4": KeyKick(
        "phase -",
        "phase shift: the neurons see the rods turned by -3pi/4 for 4 ticks",
        {"mode": "phase", "ticks": 4, "shift": -3 * pi / 4},
    ),
    "5": KeyKick(
        "rest",
        "pulse: no spring (k = 0) for 50 ticks, so that the wheels come to rest",
        {"mode": "pulse", "param": "k", "value": 0.0, "ticks": 50},
    ),
}
FOOT = ["keys: space stop  " + "  ".join(f"{key} {kick.title}" for key, kick in KICKS.items())]
FOOT[0] += "  ? help  q quit"
HELP_FOOT = [
    "space  stop the motors at once; anybody may",
    *(f"{key}      {kick.help}" for key, kick in KICKS.items()),
    "?      hide this help;  q or ^C  stop watching: the robot goes on as it is",
]


class KeyActions:
    """Does what keys say, for a robot that another thread watches.

    A stop goes out at once, in a thread of its own. A kick waits until the thread that watches asks
    for it, and is dropped if that takes too long, as while a link is broken.

    Args:
        stop: Stops the robot.
        say: Shows words; any thread may call it.
        change_foot: Shows other lines about keys.
        clock: The time in s.
        take_over: Whether a kick takes control from another host, which hears of it.
    """

    def __init__(
        self,
        stop: Callable[[], Stopped],
        say: Callable[[str], None],
        change_foot: Callable[[list[str]], None],
        clock: Callable[[], float] = time.monotonic,
        *,
        take_over: bool = False,
    ) -> None:
        self.left = False
        self._stop_robot = stop
        self._say = say
        self._change_foot = change_foot
        self._clock = clock
        self._take_over = take_over
        self._kicks: queue.SimpleQueue[tuple[float, KeyKick]] = queue.SimpleQueue()
        self._pressed = threading.Event()
        self._stopping: threading.Thread | None = None
        self._helps = False

    def press(self, key: str) -> None:
        """Do what a key says. Returns at once."""
        if key == STOP_KEY:
            if self._stopping is None or not self._stopping.is_alive():  # that one repeats itself
                self._stopping = threading.Thread(target=self._stop, name="kickctl stop")
                self._stopping.start()
        elif key in KICKS:
            self._kicks.put((self._clock(), KICKS[key]))
            self._pressed.set()
        elif key in (QUIT_KEY, QUIT_KEY.upper()):
            self.leave()
        elif key == HELP_KEY:
            self._helps = not self._helps
            self._change_foot(HELP_FOOT if self._helps else FOOT)

    def leave(self) -> None:
        """Have the watch end."""
        self.left = True
        self._pressed.set()

    @property
    def waiting(self) -> bool:
        """Whether a kick waits, or the person wants to leave."""
        return self.left or not self._kicks.empty()

    def pause(self, seconds: float) -> None:
        """Let real time pass, until a key is pressed that somebody has to look at."""
        self._pressed.wait(seconds)
        self._pressed.clear()

    def kick(self, robot: Robot) -> None:
        """Send the kicks that wait."""
        with suppress(queue.Empty):
            while True:
                pressed_s, kick = self._kicks.get_nowait()
                if self._clock() - pressed_s <= STALE_S:
                    self._send(robot, kick)
                else:
                    self._say(f"kick {kick.title}: not sent, since the robot was out of reach")

    def close(self) -> None:
        """Wait until the robot has said what came of a stop; what was sent is never taken back."""
        if self._stopping is not None:
            self._stopping.join()

    def _send(self, robot: Robot, kick: KeyKick) -> None:
        """Kick, and give control back, so that whoever only watches locks nobody out."""
        try:
            if self._take_over:
                robot.take_over()
            robot.kick(**kick.details)
        except KickctlError as refusal:
            self._say(f"kick {kick.title}: {in_a_line(refusal)}")
        finally:
            with suppress(KickctlError):
                robot.release()

    def _stop(self) -> None:
        self._say("stop: sent; waiting for the robot's answer")
        try:
            words = self._stop_robot().sentence()
        except KickctlError as failure:
            words = in_a_line(failure)
        self._say(f"stop: {words}")


def in_a_line(error: KickctlError) -> str:
    """What happened and what to do, as typed on this command line."""
    return as_typed(error.in_a_line)
