"""A robot as seen from the host, for programs and notebooks.

    with connect("sim://") as robot:
        robot.kick("phase", ticks=4)
        log = robot.record(5)

Calls block. A thread keeps the link to a real robot alive between calls; the time of an embedded
robot passes only within them.
"""

from __future__ import annotations

import uuid
from collections import Counter
from pathlib import Path
from typing import Any, Self

from host.client.access import find_token
from host.client.watching import Watcher
from host.errors import KickctlError, LeaseLost, NoLink, WrongUse
from host.link.names import chosen, link_to, own_token
from host.link.transport import Link
from robot.record import STATES
from robot.words import person


class Robot(Watcher):
    """A robot to drive and to watch: a connection with verbs.

    Every method that talks to the robot raises KickctlError in words when that fails. Leaving the
    `with` block, or `close`, hangs up; the robot goes on as it is.

    Attributes:
        confirmed: How often the robot has confirmed each command.
        unanswered: The command that was sent last, if no answer has come; else empty.
    """

    def __init__(self, link: Link, token: bytes | None, name: str | None = None) -> None:
        self.confirmed: Counter[str] = Counter()
        self.unanswered = ""
        super().__init__(link, token, name)

    @classmethod
    def connect(
        cls,
        uri: str | None = None,
        seed: int | None = None,
        token: str | Path | None = None,
        name: str | None = None,
        *,
        observe: bool = False,
        take_over: bool = False,
    ) -> Self:
        """Connect to a robot, real or simulated; to be used as a `with` block.

        >>> with connect("sim://", seed=1) as robot:
        ...     rolls = robot.wait(3)  # s
        ...     robot.status()["state"]
        'running'

        Args:
            uri: The robot's name or address, by default $KICK_BRICK or the embedded simulated
                robot. The simulated one takes a seed and parameters: 'sim://?seed=1&k=2&tau_s=1'.
            seed: Fixes all chances of the simulated robot.
            token: The path of the token file, by default the robot's own, or the usual place.
            name: Who this is, for the robot and for other people, in at most 40 letters; by
                default the user and the machine, as in `anna@lab-3`.
            observe: Only look on, and stop the robot if need be, which takes no token.
            take_over: Take control at once, also from another host, which hears of it.

        Returns:
            The robot, to be used in a `with` block or closed.

        Raises:
            KickctlError: The robot cannot be reached, or refuses.
        """
        if observe and take_over:
            raise WrongUse(
                "a program that only observes cannot take over", "leave observe or take_over out"
            )
        named = chosen(uri)
        link = link_to(named, seed)
        if observe:
            return cls(link, None, name)
        own = own_token(named) if token is None else None
        robot = cls(link, find_token(link, token, own), name)
        if take_over:
            try:
                robot.take_over()
            except BaseException:
                robot.close()
                raise
        return robot

    def __repr__(self) -> str:
        facts = [f"simulated, seed {self.hello['seed']}"] if self.link.virtual else []
        if self._broken is not None:
            facts.append(self._broken.message)
        else:
            newest = self.newest
            facts.append(
                "no record taken in yet"
                if newest is None
                else f"{STATES[newest.state]} at tick {newest.tick}, {newest.t_s:.2f} s"
            )
            facts.append(
                "driven from here"
                if self.drives
                else "may be driven"
                if self.trusted
                else "observed, without its token"
            )
        return f"<Robot {self.link.uri}: {'; '.join(facts)}>"

    def command(self, command: str, **arguments: Any) -> int:
        """Command the robot, taking control first if need be.

        Args:
            command: One of the robot's commands that need control.
            arguments: What belongs to it.

        Returns:
            The first tick in which it holds.

        Raises:
            KickctlError: The robot refuses, does not answer, or cannot be reached.
        """
        self.require_control()
        self.unanswered = command
        try:
            try:
                answer = self.request(command, arguments, sealed=True)
            except LeaseLost:
                # Either somebody has taken over, as the answer to a heartbeat says, or the robot
                # took this host for lost while the link was silent. What was refused has changed
                # nothing.
                self.request("heartbeat", sealed=True)
                if self.drives:
                    self.lease()
                self.require_control()
                answer = self.request(command, arguments, sealed=True)
        except NoLink:
            raise
        except KickctlError:  # the robot refuses, and that is an answer
            self.unanswered = ""
            raise
        self.confirmed[command] += 1
        self.unanswered = ""
        return int(answer["tick"])

    def require_control(self) -> None:
        """Take control unless this connection has it, or somebody has taken over from it.

        Raises:
            LeaseLost: Another host controls the robot, or somebody has taken over: then only
                `lease` and `take_over` take control again.
            RefusedByRobot: This machine does not have the robot's token.
        """
        if self.drives:
            return
        winner = self._control.taken_over_by
        if winner is not None:
            raise LeaseLost(
                f"{person(winner)} has taken over, so this program no longer drives the robot",
                "robot.lease() takes control again once they have finished, robot.take_over() at"
                " once. Anyone may stop the robot",
            )
        self.lease()

    def start(self) -> int:
        """Run from random membrane potentials.

        Returns:
            The first tick of the run.
        """
        return self.command("start")

    def stop(self) -> int:
        """Stop the motors; needs neither token nor control, and waits for no other call.

        It works after `close` too, over a link of its own.

        Returns:
            The first tick of the stop.

        Raises:
            NoLink: Nobody has confirmed the stop, so the motors may be running.
            RobotFault: A motor has not obeyed it.
        """
        stopped = self.stop_at_once()
        stopped.require_obeyed()
        return stopped.tick

    def clear(self) -> int:
        """Leave a fault whose cause is mended.

        Returns:
            The tick from which on the robot is stopped and no longer in fault.
        """
        return self.command("clear")

    def set(self, **changes: float | str) -> int:
        """Change parameters, all or none.

        Args:
            changes: Values by the parameters' names, as in `robot.set(k=2, tau_s=1)`.

        Returns:
            The first tick in which they hold.
        """
        return self.command("set", set=changes)

    def kick(self, mode: str, **details: Any) -> int:
        """Kick the robot, and do not wait for what comes of it.

        Args:
            mode: 'membrane', 'position', 'phase', 'pulse', 'jump' or 'waveform'.
            details: What `kickctl kick` takes: ticks, wheel, shift (rad), shape, param, value,
                variable, delta; and waveform, a list of one value for each tick.

        Returns:
            The tick in which the kick began.
        """
        kick = {"id": uuid.uuid4().hex, "mode": mode}
        kick.update((name, value) for name, value in details.items() if value is not None)
        return self.command("kick", kick=kick)


connect = Robot.connect
