"""Stop a robot by one frame: without hello, token or lock, and without a success nobody saw."""

from __future__ import annotations

import os
import struct
from typing import Any, NamedTuple

from host.client.hello import hello_frame
from host.errors import KickctlError, NoLink, RobotFault, printable
from host.link.patience import Patience
from host.link.transport import Link, LinkLost
from host.util.installation import deploy_command
from host.util.own_name import own_name
from robot import wire
from robot.kicks import WHEELS
from robot.record import STATES, unpack

# How long the robot may take to confirm a stop.
CONFIRM_S = 5.0
# How long a robot that has obeyed may take to say which one it is.
WHO_S = 1.0
# A line may garble or lose a frame; a second STOP changes nothing.
REPEAT_S = 0.25
_AT_REST = ("stopped", "fault")


class Stopped(NamedTuple):
    """What the robot has said about a stop.

    tick: the first tick of the stop, or a tick in which the motors were off. state: the robot's
    state, 'unknown' if an older program answered. reason: why it is in that state. unstopped: the
    wheels whose motor did not obey, as far as the robot says so.
    """

    tick: int
    state: str
    reason: str
    unstopped: tuple[str, ...] = ()

    def sentence(self) -> str:
        """What is known, and no more: a robot in fault may have a motor that does not obey."""
        if self.unstopped:
            return (
                f"the {' and the '.join(self.unstopped)} motor has NOT obeyed the stop, and may be"
                f" running: {self.reason}"
            )
        if self.state == "fault":
            return (
                f"the robot has obeyed the stop before tick {self.tick}, and is in fault:"
                f" {self.reason or 'see `kickctl status`'}; look whether the wheels stand still"
            )
        if self.state == "unknown":
            return f"the robot, which runs another release, has obeyed the stop in tick {self.tick}"
        return f"motors stopped before tick {self.tick}; the robot is {self.state}"

    def require_obeyed(self) -> None:
        """Raise RobotFault if a motor did not obey."""
        if self.unstopped:
            raise RobotFault(self.sentence(), "press the back button, or cut the motors' power")


def stop_frame(name: str) -> bytes:
    """The frame that stops the motors, with the name of who sends it (at most 40 characters)."""
    return bytes(wire.encode_json(wire.STOP, {"name": name[:40]}))


def confirmation(kind: int, payload: bytes) -> Stopped | None:
    """What a frame of the robot says about a stop: an answer to STOP, or motors off in a record.

    Args:
        kind: The frame's type.
        payload: What it carries.

    Returns:
        What is known, None if the frame says nothing about a stop.
    """
    try:
        if kind == wire.REPLY:
            message = wire.load(payload)
            if message["id"] is None and "result" in message:
                return answered(message["result"])
        elif kind == wire.SAMPLES:
            record = unpack(wire.open_samples(payload)[1])[-1]
            state = STATES[record.state]
            if state in _AT_REST and record.left_duty_pct == record.right_duty_pct == 0:
                return Stopped(record.tick, state, "")
    except (wire.BadMessage, struct.error, LookupError, TypeError, ValueError):
        pass  # another version's frame, which proves nothing
    return None


def answered(result: dict[str, Any]) -> Stopped:
    """A robot's answer to STOP. Raises KeyError, TypeError or ValueError if it is none."""
    said = {"state": "unknown", "reason": "", "unstopped": [], **result}
    if said["state"] not in (*_AT_REST, "unknown"):
        raise ValueError(f"a stopped robot is not '{said['state']}'")
    unstopped = tuple(side for side in WHEELS if side in said["unstopped"])
    return Stopped(int(said["tick"]), str(said["state"]), printable(str(said["reason"])), unstopped)


def stop_robot(link: Link, name: str | None = None, patience_s: float | None = None) -> Stopped:
    """Open another link, send the STOP frame first and alone, and wait until it is confirmed.

    The other link is closed in the end.

    Args:
        link: A way to the robot, which stays as it is.
        name: Who stops the robot, for people; by default this program's own name.
        patience_s: How long the robot may take, by default as long as it may for a hello.

    Returns:
        What the robot says about the stop.

    Raises:
        NoLink: Nobody has confirmed the stop, or another robot than the one that is meant, so the
            motors may be running.
        RobotFault: The robot's program does not answer. Its machine was reached by ssh, and says
            that the motors are off.
    """
    name = name or own_name()
    frame, decoder = stop_frame(name), wire.Decoder()
    link, other = link.another(), None
    try:
        link.open()
        patience = Patience(link, patience_s or CONFIRM_S)
        repeat = link.now()
        while not patience.is_over():
            if link.now() >= repeat:
                link.send(frame)
                repeat = link.now() + REPEAT_S
            decoder.feed(link.receive(min(REPEAT_S, 0.1)))
            while (received := decoder.next()) is not None:
                stopped = confirmation(*received)
                if stopped is not None:
                    other = _other_robot(link, decoder, name)
                    if other is None:
                        return stopped
                    raise other
        failure = unconfirmed(link.uri, "no answer has come")
    except LinkLost as error:
        failure = unconfirmed(link.uri, f"the link broke ({error})")
    except NoLink as error:
        failure = error
    finally:
        reached = _logged_in(link)
        link.close()
    raise _halted(link, failure) if reached and other is None else failure


def _other_robot(link: Link, decoder: Any, name: str) -> NoLink | None:
    """The error if another robot than the one that is meant has obeyed; it is asked who it is.

    A line leads where its cable does, and another program may be talking over it.
    """
    hello = {} if link.meant is None or link.is_line else _hello(link, decoder, name)
    if link.meant is None or not link.meant.is_other(hello):
        return None
    return NoLink(
        f"another robot has obeyed the stop: {link.uri} does not lead to {link.meant.name} any"
        " more, whose motors may still be running",
        f"press the back button on {link.meant.name}, or take out its battery. `kickctl discover"
        " --save` finds it again",
    )


def _hello(link: Link, decoder: Any, name: str) -> dict[str, Any]:
    """What a robot says of itself; empty if it says nothing."""
    nonce = os.urandom(wire.NONCE_BYTES)
    try:
        link.send(hello_frame(name, nonce.hex(), nonce, token=False))
        patience = Patience(link, WHO_S)
        while not patience.is_over():
            decoder.feed(link.receive(0.1))
            while (received := decoder.next()) is not None:
                kind, payload = received
                if kind == wire.HELLO:
                    return dict(wire.load(payload))
                if kind == wire.REPLY and "error" in wire.load(payload):
                    return {}  # it has no place for another host
    except (LinkLost, wire.BadMessage):
        pass  # an older program
    return {}


def _logged_in(link: Any) -> bool:
    """Whether ssh has reached the robot's machine, which can switch its motors off itself."""
    return hasattr(link, "halt") and bool(link.logged_in())


def _halted(link: Any, failure: NoLink) -> KickctlError:
    """Have the robot's machine switch its motors off, as its program has not confirmed the stop.

    Returns:
        The error that says what is known then.
    """
    words = link.halt()
    if words not in ("the motors are off", "the brick sees no motor"):
        return NoLink(f"{failure.message}. {words}", failure.hint) if words else failure
    return RobotFault(
        f"the robot's program at {link.uri} does not answer. Its motors were switched off over ssh"
        f" without it, and the kernel there says: {words}",
        f"`{deploy_command()}` ends the program and starts it again",
    )


def unconfirmed(uri: str, why: str) -> NoLink:
    """The error for a stop that was sent and that nobody has confirmed."""
    return NoLink(
        f"the stop was sent to {uri}, but {why}: the motors may still be running",
        "is this the robot's port? Try again, press the back button on the brick, or take out its"
        " battery",
    )
