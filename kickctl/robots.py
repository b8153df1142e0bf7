"""Robots for programs and notebooks: all that host.client.robot has, and what is to be watched."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import asdict, dataclass, fields
from typing import Any

from host.client import robot as client
from host.errors import NotDone
from host.kicking.outcome import (
    OTHER_PARAMETERS,
    UNSETTLED,
    Outcome,
    advice,
    describe,
    kick_and_watch,
    require_control,
    require_running,
    wait_settled,
)
from host.util.extras import need
from kickctl.logs import Log


@dataclass(frozen=True)
class KickOutcome(Outcome, Mapping[str, Any]):
    """What a kick did: the fields of `kickctl kick --json`, as attributes and as a mapping.

    So `outcome.reversed` and `outcome["reversed"]` are the same, `dict(outcome)` is plain data, and
    `print(outcome)` says it in words.

    >>> with connect("sim://", seed=1) as robot:
    ...     outcome = robot.kick_and_watch("phase", ticks=4)
    >>> outcome.reversed, outcome["before"], outcome["after"]["left"]
    (True, {'left': 'forward', 'right': 'backward'}, 'backward')

    Attributes:
        mode: Which kick.
        ticks: How long it was, in control periods.
        shift_rad: The shift of a phase kick (rad), one for each wheel if they differ; else None.
        wheel: 'left', 'right' or 'both'.
        applied_tick: The tick in which it began.
        before: Each wheel's heading before the kick: 'forward', 'backward' or 'stopped'.
        after: Each wheel's heading after it.
        reversed: Whether every kicked wheel has reversed.
        settling_s: How long they took to settle (s); None if a kicked wheel never settled.
        brick: The robot's address.
        seed: The seed of its chances.
    """

    brick: str
    seed: int

    def __getitem__(self, name: str) -> Any:
        return asdict(self)[name]

    def __iter__(self) -> Iterator[str]:
        return (field.name for field in fields(self))

    def __len__(self) -> int:
        return len(fields(self))

    def __str__(self) -> str:
        hint = "" if self.reversed else advice(self)
        return describe(self) + (f"\n{hint}" if hint else "")


class Robot(client.Robot):
    """A robot to drive and to watch; `connect` returns one.

    >>> with connect("sim://", seed=1) as robot:
    ...     robot.set(k=2)  # the first tick in which it holds
    ...     robot.kick("membrane", wheel="left")  # the tick in which the kick begins
    ...     log = robot.record(2)
    3
    4
    >>> log
    <Log: 67 ticks, 1.98 s, kicks: 0, sim://>

    Every method that talks to it raises KickctlError in words when that fails, and WrongUse for an
    argument that makes no sense, before anything changes. Leaving the `with` block, or `close`,
    hangs up; the robot goes on as it is.
    """

    def kick_and_watch(
        self,
        mode: str,
        *,
        ticks: int | None = None,
        wheel: str = "both",
        shift: float | None = None,
        shape: str | None = None,
        param: str | None = None,
        value: float | None = None,
        variable: str | None = None,
        delta: float | None = None,
        now: bool = False,
    ) -> KickOutcome:
        """Wait until the wheels turn evenly, kick, and watch until they do so again.

        Args:
            mode: 'membrane', 'position', 'phase', 'pulse' or 'jump'.
            ticks: How long the kick lasts, in control periods.
            wheel: 'left', 'right' or 'both'.
            shift: phase: the shift (rad), by default with the sign that reverses.
            shape: pulse: 'rectangular' or 'smooth'.
            param: pulse: the parameter.
            value: pulse: its value at the pulse's height.
            variable: jump: the membrane potential, 'x1' or 'x2'.
            delta: jump: how far it jumps.
            now: Kick at once, without waiting until the wheels have settled.

        Returns:
            What `kickctl kick --json` answers.

        Raises:
            NotDone: The robot does not run, or its wheels do not settle.
            RobotFault: The robot is in fault.
            KickctlError: The robot refuses the kick, or cannot be reached.
        """
        require_running(self)
        require_control(self)
        with self.recording() as log:
            if not now and not wait_settled(self):
                raise NotDone(
                    f"{UNSETTLED}, so the kick was not sent",
                    f"{OTHER_PARAMETERS}; now=True kicks without waiting",
                )
            outcome = kick_and_watch(
                self,
                log,
                mode,
                wheel=wheel,
                ticks=ticks,
                shift=shift,
                shape=shape,
                param=param,
                value=value,
                variable=variable,
                delta=delta,
            )
        return KickOutcome(**outcome.as_dict(), brick=self.link.uri, seed=self.hello["seed"])

    def record(self, seconds: float) -> Log:
        return self._record(Log, seconds)

    def recording(self) -> AbstractContextManager[Log]:
        return self._recording(Log)

    def show(self) -> None:
        """Show the robot in a notebook as it moves: wheels, phase plane, strips, and STOP.

        The cell's drawings follow this connection until the cell is run again or deleted, and the
        robot goes on as it is. An embedded robot's seconds pass within calls such as `wait`, and
        are then shown as seconds. It takes the extra `notebook`.

        Raises:
            WrongUse: This is no notebook, or anywidget is not installed.
            KickctlError: The robot cannot be reached.
        """
        need("anywidget", "notebook")
        from host.lab.widgets import show_robot

        show_robot(self)


connect = Robot.connect
