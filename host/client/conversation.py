"""The host's side of the protocol, without any I/O: what to send, and what arriving bytes mean."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Iterator
from math import isfinite
from typing import Any, NamedTuple

from host.client.hello import hello_frame
from host.client.stop import Stopped, answered
from host.errors import NoLink, RefusedByRobot, WrongUse, from_robot, printable
from host.util.arguments import plain, shown, wrong
from robot import wire
from robot.record import Record, unpack

_MAX_UNCLAIMED = 64
_HELLO_FIELDS: dict[str, Callable[[Any], Any]] = {
    "protocol": lambda protocol: [int(number) for number in protocol],
    "boot": str,
    "software": str,
    "machine": str,
    "seed": int,
    "tick": int,
    "oldest_tick": int,
    "clock_s": float,
}


class Samples(NamedTuple):
    """Records that follow one another and stand before the event numbered `next_event`."""

    next_event: int
    records: list[Record]


class Conversation:
    """One robot's answers, in order.

    session: how often the conversation has begun; an answer belongs to the session it came in.
    stopped: the robot's latest answer to a STOP. taken_over_by: who has taken control from this
    program, as the robot has said last. token_refused: whether the robot has another token than
    this host, which goes on without one.
    """

    def __init__(self, token: bytes | None, name: str, client: str) -> None:
        self.token = token
        self.hello: dict[str, Any] = {}
        self.trusted = False
        self.token_refused = False
        self.session = 0
        self.stopped: Stopped | None = None
        self.taken_over_by: str | None = None
        self._name = name
        self._client = client
        self._nonce = b""
        self._handshake: Any = None
        self._counter = 0
        self._number = 0
        self._decoder = wire.Decoder()
        self._answers: dict[int, dict[str, Any]] = {}
        self._refusal: dict[str, Any] | None = None

    def begin(self) -> None:
        """Start a session on a link that has just been opened."""
        self.hello = {}
        self.trusted = False
        self.session += 1
        self._counter = 0
        self._handshake = None
        self._decoder = wire.Decoder()
        self._answers.clear()
        self._refusal = None

    def hello_frame(self) -> bytes:
        """What the host says first."""
        self._nonce = os.urandom(wire.NONCE_BYTES)
        return hello_frame(self._name, self._client, self._nonce, token=self.token is not None)

    def auth_frame(self) -> bytes:
        """The proof that the host has the token."""
        self._handshake = wire.Handshake(
            self.token, self._nonce, bytes.fromhex(self.hello["nonce"])
        )
        return _bytes(wire.encode_json(wire.AUTH, {"proof": self._handshake.host_proof.hex()}))

    def request(self, command: str, arguments: dict[str, Any], sealed: bool) -> tuple[int, bytes]:
        """(number, frame) of a request; its answer will carry the number.

        Raises WrongUse for what cannot be sent.
        """
        number, counter = self._number + 1, self._counter + 1
        body = _body(number, command, arguments)
        try:
            if sealed:
                payload = wire.seal(self._handshake.key, counter, body)
                frame = wire.encode(wire.COMMAND, payload)
            else:
                frame = wire.encode(wire.ASK, body)
        except ValueError as error:
            raise WrongUse(
                f"what was given to '{command}' is too long to be sent", "give less"
            ) from error
        self._number = number
        if sealed:
            self._counter = counter
        return number, _bytes(frame)

    def beat(self) -> bytes:
        """A sign of life for a robot that this host controls; an older one gets it as a request."""
        if self.hello["protocol"] < [1, 3]:
            return self.request("heartbeat", {}, sealed=True)[1]
        self._counter += 1
        sealed = wire.seal(self._handshake.key, self._counter, b"")
        return _bytes(wire.encode(wire.BEAT, sealed))

    def answer(self, number: int) -> dict[str, Any] | None:
        """The result that answers request `number`, None if it has not come.

        Raises the error that came instead.
        """
        message = self._answers.pop(number, None)
        if message is None:
            return None
        if "error" in message:
            raise from_robot(message["error"])
        result: dict[str, Any] = message["result"]
        return result

    @property
    def refused(self) -> str | None:
        """Why the robot has ended the conversation, in its words; None if it has not."""
        return None if self._refusal is None else printable(str(self._refusal.get("message")))

    def overlook_broken(self) -> None:
        """Forget a refusal of a frame that was no message."""
        if self._refusal is not None and self._refusal.get("code") == "broken":
            self._refusal = None

    def raise_refusal(self) -> None:
        """Raise what ended the conversation, if the robot has ended it."""
        if self._refusal is not None:
            refusal, self._refusal = self._refusal, None
            raise from_robot(refusal)

    def feed(self, data: bytes) -> Iterator[dict[str, Any] | Samples]:
        """Take in bytes; yields the events and the records among what they complete, in order.

        Raises NoLink if it is no robot.
        """
        self._decoder.feed(data)
        return iter(list(self._messages()))

    def _messages(self) -> Iterator[dict[str, Any] | Samples]:
        while (frame := self._decoder.next()) is not None:
            kind, payload = frame
            try:
                if kind == wire.SAMPLES:
                    number, records = wire.open_samples(payload)
                    yield Samples(number, _finite(unpack(records)))
                elif kind == wire.EVENT:
                    yield _checked_event(wire.load(payload))
                else:
                    self._control(kind, wire.load(payload))
            except (
                wire.BadMessage,
                ValueError,
                KeyError,
                TypeError,
                AttributeError,
                struct.error,
            ) as error:
                raise NoLink(
                    f"the robot sends what this release does not understand: {error}",
                    "run the same release on both",
                ) from error

    def _control(self, kind: int, message: dict[str, Any]) -> None:
        if kind == wire.HELLO:
            if message["host_nonce"] == self._nonce.hex():
                bytes.fromhex(message["nonce"])
                self._refusal = None  # of what came before it
                self._hear_of_takeover(message)
                self.hello = {
                    **message,
                    **{name: of_type(message[name]) for name, of_type in _HELLO_FIELDS.items()},
                }
        elif kind == wire.AUTH and self._handshake is not None:
            if not wire.same(bytes.fromhex(str(message.get("proof"))), self._handshake.robot_proof):
                raise RefusedByRobot(
                    "this robot does not have the token either: it may be another one",
                    "check its address and the token file",
                )
            self.trusted = True
        elif kind == wire.BEAT and self.hello:  # an earlier user of the line had others
            self._hear_of_takeover(message)
        elif kind == wire.REPLY:
            number, outcome = message["id"], "error" if "error" in message else "result"
            reply = {outcome: {**message[outcome]}}
            if number is None and outcome == "result":
                self.stopped = answered(reply["result"])
            elif number is None:
                # Those that follow only say that there was no new hello.
                self._refusal = self._refusal or reply["error"]
            elif self.hello:  # before it, answers to an earlier user of the line may come
                self._hear_of_takeover(reply.get("result", {}))
                self._answers[number] = reply
                while len(self._answers) > _MAX_UNCLAIMED:
                    del self._answers[next(iter(self._answers))]

    def _hear_of_takeover(self, message: dict[str, Any]) -> None:
        if "taken_over_by" in message:
            name = message["taken_over_by"]
            self.taken_over_by = None if name is None else printable(str(name))


def _body(number: int, command: str, arguments: dict[str, Any]) -> bytes:
    """A request as JSON. Raises WrongUse for what JSON does not have."""
    if not isinstance(command, str):
        raise wrong("a command", command, "its name, as in 'status'")
    try:
        given = plain(arguments)
        if not isinstance(given, dict):
            raise TypeError(shown(arguments))
        for name in ("id", "do"):
            if name in given:
                raise WrongUse(f"'{command}' takes no '{name}'", "leave it out")
        return _bytes(wire.dump({"id": number, "do": command, **given}))
    except ValueError as error:
        raise WrongUse(
            f"'{command}' was given NaN, an infinity or a number of thousands of digits, which is"
            " no value for anything",
            "give finite numbers",
        ) from error
    except (TypeError, RecursionError) as error:
        raise WrongUse(
            f"'{command}' was given what is neither a number nor text: {error}",
            "give numbers and text",
        ) from error


def _checked_event(event: dict[str, Any]) -> dict[str, Any]:
    """The event, if it has what everybody relies on; raises KeyError or BadMessage."""
    places = event["tick"], event["from" if event["event"] == "lost" else "number"]
    if event["event"] == "snapshot":
        _ = {**event["params"]}, event["kick"]
    if not all(isinstance(place, int) for place in places):
        raise wire.BadMessage("an event that has no place in the stream")
    return event


def _finite(records: list[Record]) -> list[Record]:
    """The records, if all their numbers are finite: no log holds others. Raises ValueError."""
    for record in records:
        if not all(map(isfinite, record)):
            raise ValueError(f"numbers that are not finite in tick {record.tick}")
    return records


def _bytes(frame: Any) -> bytes:
    """The robot's modules are not annotated; a frame is bytes."""
    return bytes(frame)
