"""The host's side of the protocol, without any I/O: what to send, and what the bytes that came in mean."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import Any

from host.errors import NoLink, RefusedByRobot, WrongUse, from_robot
from robot import wire
from robot.record import Record, unpack

_MAX_UNCLAIMED = 64


class Conversation:
    """One robot's answers, in order. `session` counts how often it was begun anew; answers belong to the session they came in."""

    def __init__(self, token: bytes | None, name: str, client: str) -> None:
        self.token = token
        self.hello: dict[str, Any] = {}
        self.trusted = False
        self.session = 0
        self._name = name
        self._client = client
        self._nonce = b""
        self._handshake: Any = None
        self._counter = 0
        self._number = 0
        self._decoder = wire.Decoder()
        self._answers: dict[int | None, dict[str, Any]] = {}
        self._refusal: dict[str, Any] | None = None

    def begin(self) -> None:
        """Start anew on a new link."""
        self.hello = {}
        self.trusted = False
        self.session += 1
        self._counter = 0
        self._decoder = wire.Decoder()
        self._answers.clear()
        self._refusal = None

    def hello_frame(self) -> bytes:
        """What the host says first."""
        self._nonce = os.urandom(wire.NONCE_BYTES)
        message = {"protocol": wire.PROTOCOL, "name": self._name, "client": self._client, "nonce": self._nonce.hex()}
        return _bytes(wire.encode_json(wire.HELLO, message))

    def auth_frame(self) -> bytes:
        """The proof that the host has the token."""
        self._handshake = wire.Handshake(self.token, self._nonce, bytes.fromhex(self.hello["nonce"]))
        return _bytes(wire.encode_json(wire.AUTH, {"proof": self._handshake.host_proof.hex()}))

    def stop_frame(self) -> tuple[None, bytes]:
        """The frame that stops the motors, which anyone may send."""
        self._answers.pop(None, None)
        return None, _bytes(wire.encode(wire.STOP, b""))

    def request(self, command: str, arguments: dict[str, Any], sealed: bool) -> tuple[int, bytes]:
        """(number, frame) of a request; its answer will carry the number."""
        self._number += 1
        try:
            body = wire.dump({"id": self._number, "do": command, **arguments})
        except ValueError as error:
            raise WrongUse(f"'{command}' cannot be sent: {error}", "numbers must be finite") from error
        if not sealed:
            return self._number, _bytes(wire.encode(wire.ASK, body))
        self._counter += 1
        return self._number, _bytes(wire.encode(wire.COMMAND, wire.seal(self._handshake.key, self._counter, body)))

    def answer(self, number: int | None) -> dict[str, Any] | None:
        """The result that answers request `number`, None if it has not come. Raises the error that came instead."""
        message = self._answers.pop(number, None)
        if message is None:
            self.raise_refusal()
            return None
        if "error" in message:
            raise from_robot(message["error"])
        result: dict[str, Any] = message.get("result", {})
        return result

    def raise_refusal(self) -> None:
        """Raise what ended the conversation, if the robot has ended it."""
        if self._refusal is not None:
            refusal, self._refusal = self._refusal, None
            raise from_robot(refusal)

    def feed(self, data: bytes) -> Iterator[tuple[dict[str, Any] | None, list[Record]]]:
        """Take in bytes; yields the events and the records among what they complete, in order. Raises NoLink if it is no robot."""
        self._decoder.feed(data)
        return iter(list(self._messages()))

    def _messages(self) -> Iterator[tuple[dict[str, Any] | None, list[Record]]]:
        while (frame := self._decoder.next()) is not None:
            kind, payload = frame
            try:
                if kind == wire.SAMPLES:
                    yield None, unpack(payload)
                elif kind == wire.EVENT:
                    yield wire.load(payload), []
                else:
                    self._control(kind, wire.load(payload))
            except (wire.BadMessage, ValueError, KeyError) as error:
                raise NoLink(f"the robot sends what this release does not understand: {error}", "run the same release on both") from error

    def _control(self, kind: int, message: dict[str, Any]) -> None:
        if kind == wire.HELLO:
            if not isinstance(message.get("nonce"), str) or "boot" not in message:
                raise wire.BadMessage("a hello without nonce or boot")
            self.hello = message
        elif kind == wire.AUTH:
            if not wire.same(bytes.fromhex(str(message.get("proof"))), self._handshake.robot_proof):
                raise RefusedByRobot(
                    "this robot does not have the token either: it may be another one", "check its address and the token file"
                )
            self.trusted = True
        elif kind == wire.REPLY:
            number = message.get("id")
            if number is None and "error" in message:
                self._refusal = message["error"]
            else:
                self._answers[number] = message
                while len(self._answers) > _MAX_UNCLAIMED:
                    del self._answers[next(iter(self._answers))]


def _bytes(frame: Any) -> bytes:
    """The robot's modules are not annotated; a frame is bytes."""
    return bytes(frame)
