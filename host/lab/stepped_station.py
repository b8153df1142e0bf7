"""A station on an embedded robot, whose time passes only when somebody steps it."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Protocol, cast

from host.client.robot import Robot
from host.errors import KickctlError, NotDone
from host.kicking.steps import play
from host.lab.station import STOP, Answer, Station
from host.lab.stopper import LAB
from robot.commands import execute
from robot.loop import Loop
from robot.wire import load

if TYPE_CHECKING:
    from host.lab.live_twin import LiveTwin


class SteppedLink(Protocol):
    """A link that carries its own robot, as host.link.sim.SimLink."""

    loop: Loop

    def run_tick(self) -> None: ...
    def now(self) -> float: ...


class SteppedStation(Station):
    """An embedded robot: the same steps give the same records.

    Args:
        robot: The robot, or its address, as in sim://?seed=1.
        name: What people call it.
        rule: What happens when nobody drives it any more: STOP or CONTINUE.
        twin: Its simulated twin; None for none.
    """

    def __init__(
        self,
        robot: Robot | str = "sim://?seed=1",
        name: str = "sim",
        rule: str = STOP,
        twin: LiveTwin | None = None,
    ) -> None:
        self._lock = threading.RLock()
        self._robot = robot if isinstance(robot, Robot) else Robot.connect(robot)
        self._link = cast(SteppedLink, self._robot.link)
        super().__init__(name, self._robot.link.uri, rule, "simulated", twin=twin)
        self._meet(self._robot)
        self._robot.add_tap(self)

    def step(self, seconds: float) -> None:
        """Let the robot's time pass (s): exactly as many ticks as fit into it."""
        with self._lock:
            for _ in range(round(seconds / float(self._follower.params["tick_s"]))):
                self._link.run_tick()
                self._robot.pump(0.0)
            # To ask over the link would take a tick.
            self._status = load(execute(self._link.loop, None, {"do": "status"}, sealed=False))
        self._wake()

    def drives_here(self) -> bool:
        return self._robot.drives

    def clock(self) -> float:
        return self._link.now()

    def do(self, command: str, arguments: dict[str, Any], answer: Answer) -> None:
        with self._lock:
            result: dict[str, Any] | KickctlError
            try:
                if command == "identify":
                    result = self._robot.identify()
                elif command == "record":
                    result = self._record(self._robot, bool(arguments["on"]))
                elif command == "primitive":
                    result = play(self._robot, self._steps(self._robot, arguments["name"]))
                else:
                    result = self._carry_out(self._robot, command, arguments)
            except KickctlError as error:
                result = error
            except OSError as error:
                result = NotDone(f"the operating system refuses: {error}", "is the disk full?")
        answer(result)

    def stop(self) -> None:
        with self._lock:
            self._robot.stop_at_once()
            self._robot.pump(0.0)

    def abandon(self) -> None:
        with self._lock:
            if self._robot.drives and self.rule == STOP:
                self.note_asker(LAB)
                self.stop()
            self._robot.release()

    def close(self) -> None:
        with self._lock:
            self._robot.close()
