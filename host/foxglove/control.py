"""What viewers may do with robots: services and parameters, for those who have the key.

Any web site that is open in a browser of this computer may open a WebSocket to it, and the protocol
of Foxglove knows no password. So a connection drives nothing before it has called /unlock with the
key that this program has printed. A stop takes no key.
"""

from __future__ import annotations

import json
import secrets
import time
import uuid
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from queue import Empty, SimpleQueue
from typing import Any

from foxglove import MessageSchema, Parameter, Schema, Service, ServiceRequest, ServiceSchema
from foxglove.websocket import Client

from host.errors import KickctlError, NotDone, RefusedByRobot, WrongUse, quotable
from host.foxglove.station import ShownStation
from host.foxglove.topics import parameter, split_parameter
from host.foxglove.watching import Watching
from host.lab.requests import MAX_BYTES
from host.lab.station import STOP
from host.logs.messages import TICKS
from robot.kick_requests import CHANGED, FIELDS
from robot.kicks import MAX_TICKS, MODES, RECTANGULAR, SMOOTH, WHEELS
from robot.params import TABLE

# How long nobody may watch a robot that is driven from here until it counts as left alone (s).
ALONE_S = 1.0
# How long a service may take: a connection that drives has to be opened, and to answer (s).
PATIENCE_S = 20.0
_KEY_BYTES = 16
_ENDED = NotDone("kickctl foxglove has ended", "start it again")

_Answers = SimpleQueue[dict[str, Any] | KickctlError]


class Refused(Exception):
    """Why a service does nothing. Viewers show its name and its words."""


class Control(Watching):
    """The services and parameters of some robots; a listener of the SDK's server.

    Args:
        robots: The robots by the prefix of their topics.
        clock: The time (s).

    Attributes:
        key: Unlocks a connection.
        tell: Gets words for those who watch.
    """

    def __init__(
        self, robots: dict[str, ShownStation], clock: Callable[[], float] = time.monotonic
    ) -> None:
        super().__init__()
        self.key = secrets.token_urlsafe(_KEY_BYTES)
        self.tell: Callable[[str], object] = lambda words: None
        self._robots = robots
        self._clock = clock
        self._unlocked: set[int] = set()
        self._watched_s: dict[str, float] = {}
        self._waiting: set[_Answers] = set()
        self._closed = False

    # Who is there.

    def look(self) -> None:
        """Attend to robots that are watched by who may drive; to be called several times a second.

        By its station's rule a robot stops, or is given back, if nobody watches it any more.
        """
        now = self._clock()
        watched = self.topics_of(self._unlocked)
        for prefix, station in self._robots.items():
            if prefix + TICKS in watched:
                self._watched_s[prefix] = now
            if prefix not in self._watched_s:
                continue
            if now - self._watched_s[prefix] < ALONE_S:
                station.attend()
            else:
                del self._watched_s[prefix]
                station.abandon()

    def _require_key(self, client: int) -> None:
        if client not in self._unlocked:
            raise RefusedByRobot(
                "this connection may only look, and stop the robot",
                "call the service /unlock with the key that kickctl foxglove has printed",
            )

    def _require_watcher(self, client: int, prefix: str) -> None:
        if not self.watches(client, prefix + TICKS):
            raise NotDone(
                "who drives a robot must watch it, and this connection does not",
                f"subscribe to {prefix + TICKS}: open a plot of it",
            )

    # Services.

    def services(self) -> list[Service]:
        """The services to offer."""
        described = [("/unlock", _UNLOCK, self._unlock)]
        for prefix, station in self._robots.items():
            described.append((prefix + "/stop", _NOTHING, partial(self._stop, station)))
            described += [
                (f"{prefix}/{command}", schema, partial(self._do, prefix, command))
                for command, schema in _COMMANDS.items()
            ]
        return [_service(*one) for one in described]

    def _unlock(self, request: ServiceRequest) -> dict[str, Any]:
        key = _fields(request.payload).get("key")
        data = key.encode(errors="replace") if isinstance(key, str) else b""
        if not secrets.compare_digest(data, self.key.encode()):
            raise RefusedByRobot("this is not the key", "kickctl foxglove has printed it")
        self._unlocked.add(request.client_id)
        return {"unlocked": True, "viewer": request.client_id}

    def _stop(self, station: ShownStation, request: ServiceRequest) -> dict[str, Any]:
        """Stop a robot, and cancel what waits. It asks for no key, and looks at no request."""
        station.stop()
        stopped = station.stop_now()
        return {"tick": stopped.tick, "state": stopped.state, "said": stopped.sentence()}

    def _do(self, prefix: str, command: str, request: ServiceRequest) -> dict[str, Any]:
        self._require_key(request.client_id)
        self._require_watcher(request.client_id, prefix)
        fields = _fields(request.payload)
        if command == "kick":
            fields = {**fields, "id": uuid.uuid4().hex}
        elif command == "set":
            fields = self._changes(prefix, fields)
        answers: _Answers = SimpleQueue()
        with self._waiting_for(answers):
            self._robots[prefix].do(command, fields, answers.put)
            try:
                answer = answers.get(timeout=PATIENCE_S)
            except Empty:
                raise NotDone(
                    "the robot has not answered in time", "look whether it did it; /stop stops it"
                ) from None
        if isinstance(answer, KickctlError):
            raise answer
        return answer

    @contextmanager
    def _waiting_for(self, answers: _Answers) -> Iterator[None]:
        """Let `close` end the wait for an answer."""
        with self._lock:
            if self._closed:
                raise _ENDED
            self._waiting.add(answers)
        try:
            yield
        finally:
            with self._lock:
                self._waiting.discard(answers)

    def close(self) -> None:
        """Have no request wait any longer: the program could not end before."""
        with self._lock:
            self._closed = True
            for answers in self._waiting:
                answers.put(_ENDED)

    # Parameters.

    def values(self, names: Iterable[str] = ()) -> list[Parameter]:
        """Parameters in force.

        Args:
            names: Those wanted; all of them if it is empty.
        """
        wanted = set(names)
        found = {
            parameter(prefix, name): value
            for prefix, station in self._robots.items()
            for name, value in station.params().items()
        }
        return [
            Parameter(name, value=value)
            for name, value in found.items()
            if not wanted or name in wanted
        ]

    def on_get_parameters(
        self, client: Client, param_names: list[str], request_id: str | None = None
    ) -> list[Parameter]:
        return self.values(param_names)

    def on_set_parameters(
        self, client: Client, parameters: list[Parameter], request_id: str | None = None
    ) -> list[Parameter]:
        """Have parameters set, and return those in force until then.

        It waits for no robot: while it does, this connection's stop would wait, too. The SDK tells
        a refusal to all viewers or to none, so the words say whose it is.
        """
        wanted = ", ".join(f"{one.name} = {one.get_value()!r}" for one in parameters)
        asked = f"viewer {client.id}, who wants {quotable(wanted)}"
        tell = partial(self._tell_refusal, asked)
        try:
            self._require_key(client.id)
            for prefix, changes in self._by_robot(parameters).items():
                self._require_watcher(client.id, prefix)
                self._robots[prefix].do("set", self._changes(prefix, changes), tell)
        except KickctlError as error:
            tell(error)
        return self.values([one.name for one in parameters])

    def _by_robot(self, parameters: list[Parameter]) -> dict[str, dict[str, Any]]:
        changes: dict[str, dict[str, Any]] = {}
        for one in parameters:
            found = split_parameter(one.name, list(self._robots))
            if found is None:
                raise WrongUse(
                    f"no robot here has the parameter {one.name}", "it begins with a robot's name"
                )
            prefix, name = found
            changes.setdefault(prefix, {})[name] = one.get_value()
        return changes

    def _tell_refusal(self, asked: str, result: dict[str, Any] | KickctlError) -> None:
        if isinstance(result, KickctlError):
            self.tell(f"{asked}: {result.in_a_line}")

    def _changes(self, prefix: str, changes: dict[str, Any]) -> dict[str, Any]:
        """What a station takes to set parameters. Raises RefusedByRobot."""
        if self._robots[prefix].rule == STOP and changes.get("link_loss") == "continue":
            raise RefusedByRobot(
                "with link_loss = continue the robot would drive on when nobody watches it, and it"
                " is to stop then",
                "start kickctl foxglove with --unattended continue if that is what you want",
            )
        return {"set": changes}


def _fields(payload: bytes) -> dict[str, Any]:
    """What a service is asked for. Raises WrongUse."""
    if len(payload) > MAX_BYTES:
        raise WrongUse(f"a request has more than {MAX_BYTES} bytes", "send less")
    try:
        fields = json.loads(payload or b"{}")
        json.dumps(fields, allow_nan=False)
    except (ValueError, RecursionError) as error:
        raise WrongUse("a request is not JSON", 'write it as in {"mode": "phase"}') from error
    if not isinstance(fields, dict):
        raise WrongUse("a request is no object", 'write it as in {"mode": "phase"}')
    return fields


def _service(
    name: str, schema: dict[str, Any], work: Callable[[ServiceRequest], dict[str, Any]]
) -> Service:
    def handle(request: ServiceRequest) -> bytes:
        try:
            return json.dumps(work(request), allow_nan=False).encode()
        except KickctlError as error:
            raise Refused(error.in_a_line) from error

    kind = name.rpartition("/")[2]
    return Service(
        name,
        schema=ServiceSchema(
            f"kickctl.{kind}",
            request=_message(f"kickctl.{kind}.Request", schema),
            response=_message(f"kickctl.{kind}.Response", {"type": "object"}),
        ),
        handler=handle,
    )


def _message(name: str, schema: dict[str, Any]) -> MessageSchema:
    data = json.dumps(schema, allow_nan=False).encode()
    return MessageSchema(
        encoding="json", schema=Schema(name=name, encoding="jsonschema", data=data)
    )


def _object(properties: dict[str, Any], *required: str) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(required)}


def _settings() -> dict[str, Any]:
    """The schema of parameters, from the robot's own table: units, ranges and choices."""
    properties: dict[str, Any] = {}
    for row in TABLE.values():
        limits = (
            {"enum": list(row.choices)}
            if row.choices is not None
            else {"type": "number", "minimum": row.minimum, "maximum": row.maximum}
        )
        unit = f"[{row.unit}] " if row.unit else ""
        properties[row.name] = {**limits, "description": unit + row.doc}
    return _object(properties)


def _kick() -> dict[str, Any]:
    number = {"type": "number"}
    fields = {
        "mode": {"enum": list(MODES)},
        "wheel": {"enum": [*WHEELS, "both"]},
        "ticks": {"type": "integer", "minimum": 1, "maximum": MAX_TICKS},
        "shape": {"enum": [RECTANGULAR, SMOOTH]},
        "shift": {**number, "description": "[rad] of a phase kick"},
        "param": {"enum": list(CHANGED), "description": "what a pulse or a waveform changes"},
        "value": {**number, "description": "of a pulse"},
        "variable": {"enum": ["x1", "x2"], "description": "of a jump"},
        "delta": {**number, "description": "of a jump"},
        "waveform": {"type": "array", "items": number, "description": "a value for each tick"},
    }
    return _object({name: fields[name] for name in FIELDS if name != "id"}, "mode")


_NOTHING = _object({})
_UNLOCK = _object({"key": {"type": "string"}}, "key")
# Commands of a station, with the schemas of their requests.
_COMMANDS = {
    "kick": _kick(),
    "start": _NOTHING,
    "set": _settings(),
    "clear": _NOTHING,
    "take_over": _NOTHING,
}
