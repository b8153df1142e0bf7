"""One peer's conversation with the robot, without any I/O: frames in, frames out.

The order of it is in PROTOCOL.md.
"""

import binascii
import os
import re
import sys
from functools import lru_cache

from robot import __version__, commands, wire
from robot.errors import Refused
from robot.hardware import hardware_id
from robot.record import STATES, STRUCT
from robot.sources import of_robot
from robot.words import person

_BATCH = wire.MAX_SAMPLES // STRUCT.size
_SEALED = (wire.COMMAND, wire.BEAT)
# Computed before the loop runs: reading files would delay a tick.
_SOURCES = of_robot()
_HARDWARE_ID = hardware_id()
# Not by `platform`, which starts a program on Python 3.5.
_MACHINE = "{} {} {}".format(
    os.uname().machine,
    sys.implementation.name.replace("cpython", "CPython"),
    ".".join(map(str, sys.version_info[:3])),
)
# What a screen would obey, or show as nothing: controls, zero widths, directions, halves of pairs
# and private letters. Not what `isprintable` says: Python 3.5 knows no letter younger than 2015.
_NOT_FOR_SCREENS = (
    ("\x00", "\x1f"),
    ("\x7f", "\xa0"),
    ("\xad", "\xad"),
    ("\u061c", "\u061c"),
    ("\u180e", "\u180e"),
    ("\u2000", "\u200f"),
    ("\u2028", "\u202f"),
    ("\u205f", "\u206f"),
    ("\ud800", "\uf8ff"),
    ("\ufeff", "\ufeff"),
    ("\ufff0", "\uffff"),
    ("\U000e0000", "\U0010ffff"),
)
# What nearly every beat is answered by.
_NOBODY_TOOK_OVER = wire.encode_json(wire.BEAT, {"taken_over_by": None})
# A name that stays as it is, as nearly all of them.
_PLAIN_NAME = re.compile(r"[ -&(-~]{0,40}\Z").match
SEE_PROTOCOL = "see PROTOCOL.md for what the robot understands"


def new_id():
    """The name of a boot: sixteen random bytes as hexadecimal text."""
    return binascii.hexlify(os.urandom(16)).decode("ascii")


@lru_cache(maxsize=1)
def _about(boot, seed, motor, sources):
    """What every hello of this run of the program says, as JSON: bytes."""
    facts = {
        "protocol": wire.PROTOCOL,
        "software": __version__,
        "sources": sources,
        "boot": boot,
        "seed": seed,
        "machine": _MACHINE,
        "motor": motor,
    }
    return wire.dump(facts)


def _printable(name):
    """A peer's name, cut to a decent length and without anything that a screen would obey."""
    if _PLAIN_NAME(name):
        return name
    # People are shown names in single quotes, which a name must not seem to end.
    letters = [
        letter
        for letter in name[:40]
        if " " <= letter <= "~" or not any(low <= letter <= high for low, high in _NOT_FOR_SCREENS)
    ]
    return "".join(letters).replace("'", "\u2019")


def _name_in(payload):
    """The name in what a STOP carries; empty if there is none, since a STOP may carry anything."""
    try:
        name = wire.load(payload).get("name")
    except wire.BadMessage:
        return ""
    return _printable(name) if isinstance(name, str) else ""


def _identity(message):
    """The number of a request, which its reply repeats. Raises BadMessage if there is none."""
    number = message.get("id")
    if type(number) is not int or not 0 <= number < 2**63:  # True is an int too
        raise wire.BadMessage("a request needs an id, a whole number from 0 to 2^63 - 1")
    return number


class Session(object):
    """What the robot knows of one peer.

    Args:
        loop: The robot, a robot.loop.Loop.
        token: The robot's token, 32 bytes.
        boot: The name of this run of the robot's program.

    Attributes:
        client: The peer's own id, None before its hello.
        name: The peer's name for people.
        claims: Whether the peer has said that it will prove that it has the token.
        trusted: Whether it has done so.
        closing: Whether the conversation is over, so that only the last frames are to be sent.
    """

    def __init__(self, loop, token, boot):
        self.client = None
        self.name = ""
        self.closing = False
        self.claims = False
        self.trusted = False
        self._loop = loop
        self._token = token
        self._boot = boot
        self._host_nonce = self._own_nonce = b""
        self._handshake = None
        self._counter = 0
        self._cursor = None
        self._event_cursor = 0
        self._introduced = False

    @property
    def greeted(self):
        """Whether the peer has said a valid hello."""
        return bool(self._own_nonce)

    @property
    def subscribed(self):
        """Whether the peer wants records."""
        return self._cursor is not None

    def waits(self, records_due):
        """Whether there is something for the peer, if it wants records.

        Args:
            records_due: Whether records are due. Events always are.
        """
        return self._cursor is not None and (
            records_due
            or not self._introduced
            or self._event_cursor != self._loop.blackbox.next_event
        )

    def receive(self, kind, payload):
        """Take in a frame.

        Args:
            kind: The frame's type.
            payload: What it carries, bytes.

        Returns:
            The frames that answer it, as bytes.
        """
        try:
            if kind == wire.BEAT and self.trusted:
                return self._beat(self._unseal(payload))
            if kind == wire.HELLO:
                return self._hello(wire.load(payload))
            if kind == wire.STOP:
                return self._stop(payload)
            if not self.greeted:
                raise wire.BadMessage("there was no hello before it")
            if kind == wire.AUTH:
                return self._authenticate(wire.load(payload))
            return self._carry_out(kind, payload)
        except (
            wire.BadMessage,
            RecursionError,
        ) as error:  # what is nested too deeply to be shown in a refusal
            return self.refuse("broken", str(error), SEE_PROTOCOL)

    def _carry_out(self, kind, payload):
        """Do what a request says, and answer it. Raises BadMessage if it is none."""
        if kind in _SEALED:
            if not self.trusted:
                return self.refuse(
                    "token",
                    "commands need the robot's token",
                    "without it you may only look, and stop the robot",
                )
            payload = self._unseal(payload)
        elif kind != wire.ASK:
            raise wire.BadMessage("frames of type {} come from the robot only".format(kind))
        message = wire.load(payload)
        identity = _identity(message)
        try:
            result = commands.execute(self._loop, self, message, sealed=kind == wire.COMMAND)
        except Refused as refusal:
            return wire.encode_json(wire.REPLY, {"id": identity, "error": refusal.as_dict()})
        return wire.encode(wire.REPLY, b'{"id":%d,"result":%s}' % (identity, result))

    def refuse(self, code, message, hint, **more):
        """End the conversation.

        Args:
            code: The kind of refusal, for programs.
            message: What is refused, and why.
            hint: What to do.
            more: What programs get beside it.

        Returns:
            The last frame, as bytes.
        """
        self.closing = True
        self.trusted = False
        self._host_nonce = self._own_nonce = b""
        self._handshake = None
        self._cursor = None
        error = dict(Refused(code, message, hint).as_dict(), **more)
        return wire.encode_json(wire.REPLY, {"id": None, "error": error})

    def _stop(self, payload):
        tick = self._loop.stop(person(self.name or _name_in(payload)) + " stopped it")
        safety = self._loop.safety
        result = {
            "tick": tick,
            "state": STATES[safety.state],
            "reason": safety.reason,
            "unstopped": self._loop.unstopped,
        }
        return wire.encode_json(wire.REPLY, {"id": None, "result": result})

    def _hello(self, message):
        protocol = message.get("protocol")
        if not isinstance(protocol, list) or len(protocol) != 2 or protocol[0] != wire.PROTOCOL[0]:
            ours = "{}.{}".format(*wire.PROTOCOL)
            return self.refuse(
                "version",
                "the robot understands protocol {}, this host {!r}".format(ours, protocol),
                "bring the same release to both: kickctl deploy",
            )
        name, client = message.get("name"), message.get("client")
        try:
            nonce = binascii.unhexlify(message.get("nonce"))
        except (TypeError, ValueError):
            nonce = b""
        if (
            len(nonce) != wire.NONCE_BYTES
            or not isinstance(client, str)
            or not 0 < len(client) <= 64
            or not isinstance(name, str)
        ):
            raise wire.BadMessage(
                "a hello needs protocol, name, client and a nonce of {} bytes".format(
                    wire.NONCE_BYTES
                )
            )
        self.name = _printable(name)
        self.client = client
        self.claims = message.get("token") is True
        self.trusted = False
        self._counter = 0
        self._cursor = None
        self._host_nonce, self._own_nonce = nonce, os.urandom(wire.NONCE_BYTES)
        loop = self._loop
        lease, box, now = loop.lease, loop.blackbox, loop.clock.now()
        answer = {
            "nonce": binascii.hexlify(self._own_nonce).decode("ascii"),
            "host_nonce": message["nonce"],
            "tick": box.next_tick,
            "oldest_tick": box.oldest_tick,
            "clock_s": now - loop.epoch,
            "controller": None if lease.holder is None else lease.name,
            "controller_held_s": lease.held_s(now),
            "taken_over_by": lease.taken_over_by(client),
        }
        if _HARDWARE_ID:
            answer["hardware_id"] = _HARDWARE_ID
        about = _about(self._boot, loop.seed, loop.motor, _SOURCES)
        return wire.encode(wire.HELLO, wire.join(about, wire.dump(answer)))

    def _authenticate(self, message):
        try:
            proof = binascii.unhexlify(message.get("proof"))
        except (TypeError, ValueError):
            proof = b""
        self._handshake = wire.Handshake(self._token, self._host_nonce, self._own_nonce)
        if not wire.same(proof, self._handshake.host_proof):
            refusal = self.refuse(
                "token",
                "this computer has the token of another robot",
                "copy the robot's ~/.config/kickctl/token to the same place on this computer, then"
                " type: chmod 600 ~/.config/kickctl/token",
            )
            # Who may look on says hello again over the same link: a second one through ssh may ask
            # a person for the password again.
            self.closing = False
            return refusal
        self.trusted = True
        robot_proof = binascii.hexlify(self._handshake.robot_proof).decode("ascii")
        return wire.encode_json(wire.AUTH, {"proof": robot_proof})

    def _beat(self, payload):
        """Answer a sign of life by who has taken over."""
        if payload:
            raise wire.BadMessage("a beat carries nothing but its seal")
        winner = self._loop.lease.taken_over_by(self.client)
        if winner is None:
            return _NOBODY_TOOK_OVER
        return wire.encode_json(wire.BEAT, {"taken_over_by": winner})

    def _unseal(self, payload):
        self._counter, payload = wire.unseal(self._handshake.key, self._counter, payload)
        loop = self._loop
        loop.lease.heard(self.client, loop.clock.now())
        return payload

    def subscribe(self, tick):
        """Send records from now on.

        Args:
            tick: The first tick to send, if it is still there.

        Returns:
            The first tick that will be sent.
        """
        self._cursor = tick
        self._introduced = False
        return max(tick, self._loop.blackbox.oldest_tick)

    def unsubscribe(self):
        """Send no more records."""
        self._cursor = None

    def stream(self):
        """The next frame of the subscription. Events stand before the record that they concern.

        Returns:
            The frame as bytes, None if the peer has everything.
        """
        box = self._loop.blackbox
        news = self._cursor != box.next_tick or self._event_cursor != box.next_event
        if self._cursor is None or (self._introduced and not news):
            return None
        oldest = box.oldest_tick
        if self._cursor < oldest:
            lost = {"event": "lost", "tick": oldest, "from": self._cursor}
            self._cursor = oldest
            self._introduced = False
            return wire.encode_json(wire.EVENT, lost)
        if not self._introduced:
            self._introduced = True
            self._event_cursor, snapshot = box.snapshot(self._cursor)
            return wire.encode_json(wire.EVENT, dict(snapshot, number=self._event_cursor))
        event = box.event(self._event_cursor)
        if event is not None and event["tick"] <= self._cursor:
            self._event_cursor += 1
            return box.event_frame(self._event_cursor - 1)
        until = box.next_tick if event is None else event["tick"]
        count = min(_BATCH, until - self._cursor)
        if not count:
            return None
        count, frame = box.samples(self._cursor, count, self._event_cursor)
        self._cursor += count
        return frame
