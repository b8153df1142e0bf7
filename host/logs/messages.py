"""A robot's stream as JSON messages with schemas: the same in a log and for a live viewer.

There are two topics: /ticks has one message for each tick, /events one for each event.
"""

from __future__ import annotations

import json
from typing import Any, NamedTuple

from host.logs.tap import Event
from robot.record import CHANNELS, KICK_NAMES, NAMES, STATES, Record

TICKS, EVENTS = "/ticks", "/events"
# Channels whose numbers messages give as words.
NAMED = {"state": STATES, "kick": KICK_NAMES}
# json.dumps would make an encoder for each message.
_to_json = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode


class Message(NamedTuple):
    """What is written or sent.

    Attributes:
        topic: TICKS or EVENTS.
        time_ns: When it happened (ns, UTC, since 1970).
        tick: The tick that it belongs to.
        data: The message, JSON in UTF-8.
    """

    topic: str
    time_ns: int
    tick: int
    data: bytes


class Messages:
    """Turns a stream into messages, in the order of the stream.

    An event has the time of the record that follows it, so it waits for that.

    Args:
        clock_zero_s: What turns the robot's clock into UTC (s). After a `restart` event that has
            one of its own, that one does.
    """

    def __init__(self, clock_zero_s: float) -> None:
        self._zero_ns = nanoseconds(clock_zero_s)
        self._now_ns = self._zero_ns
        self._waiting: list[Event] = []

    def take_event(self, event: Event) -> None:
        """Keep an event until the next record gives it its time."""
        if event["event"] == "restart" and "clock_zero_s" in event:
            self._zero_ns = nanoseconds(event["clock_zero_s"])
        self._waiting.append(event)

    def take_record(self, record: Record) -> list[Message]:
        """The messages of the next record: those of the events before it, and its own."""
        self._now_ns = self._zero_ns + nanoseconds(record.t_s)
        message = record._asdict()
        for name, words in NAMED.items():
            message[name] = words[message[name]]
        own = self._message(TICKS, message, record.tick)
        return [*self.rest(), own]

    def rest(self) -> list[Message]:
        """The messages of the events that wait, with the time of the record before them."""
        messages = [self._message(EVENTS, event, event["tick"]) for event in self._waiting]
        self._waiting.clear()
        return messages

    def _message(self, topic: str, message: dict[str, Any], tick: int) -> Message:
        return Message(topic, self._now_ns, tick, _to_json(message).encode())


def nanoseconds(seconds: float) -> int:
    """A time in whole ns."""
    return round(seconds * 1e9)


def _ticks_schema() -> dict[str, Any]:
    properties: dict[str, Any] = {}
    for channel in CHANNELS:
        if channel.name in NAMED:
            properties[channel.name] = {"type": "string", "enum": list(NAMED[channel.name])}
        else:
            properties[channel.name] = {"type": "number" if channel.code in "df" else "integer"}
        doc = channel.doc.split(":")[0] if channel.name in NAMED else channel.doc
        properties[channel.name]["description"] = f"[{channel.unit}] {doc}"
    return {
        "title": "tick",
        "description": "one tick of the robot",
        "type": "object",
        "properties": properties,
        "required": list(NAMES),
    }


def _events_schema() -> dict[str, Any]:
    properties = {
        "event": {"type": "string", "description": "what happened"},
        "tick": {"type": "integer", "description": "[1] the first tick that it concerns"},
        "reason": {"type": "string", "description": "why, for people"},
    }
    return {
        "title": "event",
        "description": "what changed the robot's course",
        "type": "object",
        "properties": properties,
    }


class Schema(NamedTuple):
    """The JSON schema of a topic: its name, and its text in UTF-8."""

    name: str
    data: bytes


def _schema(name: str, schema: dict[str, Any]) -> Schema:
    return Schema(name, json.dumps(schema, allow_nan=False).encode())


SCHEMAS = {
    TICKS: _schema("kickctl.Tick", _ticks_schema()),
    EVENTS: _schema("kickctl.Event", _events_schema()),
}
