"""A viewer that speaks the WebSocket protocol of Foxglove, and knows nothing of this project."""

import asyncio
import json
import struct
from collections import deque
from contextlib import asynccontextmanager
from typing import NamedTuple

from aiohttp import ClientSession, WSMsgType

PROTOCOL = "foxglove.sdk.v1"
PATIENCE_S = 60.0
_DATA, _ANSWER, _CALL = 1, 3, 2


class Message(NamedTuple):
    """A message of a channel, as it came."""

    topic: str
    time_ns: int
    data: bytes

    def json(self):
        return json.loads(self.data)


class Failed(Exception):
    """A service has failed; the words are the server's."""


class Viewer:
    """An open connection.

    info: the server's own description. channels, services: what it offers, by topic and by name.
    """

    def __init__(self, socket):
        self._socket = socket
        self.info = {}
        self.channels = {}
        self.services = {}
        self.params = {}
        self.statuses = []
        self.messages = deque()
        self._calls = 0
        self._answers = {}
        self._topics = {}

    async def until(self, condition):
        """Take in what comes until a condition holds."""
        async with asyncio.timeout(PATIENCE_S):
            while not condition():
                self._take(await self._socket.receive())

    def _take(self, message):
        if message.type == WSMsgType.BINARY:
            self._take_binary(message.data)
            return
        assert message.type == WSMsgType.TEXT, f"the server hung up: {message}"
        said = json.loads(message.data)
        kind = said.pop("op")
        if kind == "serverInfo":
            self.info = said
        elif kind == "advertise":
            self.channels |= {one["topic"]: one for one in said["channels"]}
        elif kind == "advertiseServices":
            self.services |= {one["name"]: one for one in said["services"]}
        elif kind == "parameterValues":
            self.params |= {one["name"]: one.get("value") for one in said["parameters"]}
        elif kind == "serviceCallFailure":
            self._answers[said["callId"]] = Failed(said["message"])
        elif kind in ("status", "removeStatus"):
            self.statuses.append(said)

    def _take_binary(self, data):
        if data[0] == _DATA:
            subscription, time_ns = struct.unpack_from("<IQ", data, 1)
            self.messages.append(Message(self._topics[subscription], time_ns, data[13:]))
        elif data[0] == _ANSWER:
            _, call, length = struct.unpack_from("<III", data, 1)
            self._answers[call] = json.loads(data[13 + length :])

    async def send(self, **message):
        await self._socket.send_json(message)

    async def subscribe(self, *topics):
        """Subscribe, once the channels are there."""
        await self.until(lambda: set(topics) <= set(self.channels))
        wanted = []
        for topic in topics:
            self._topics[len(self._topics) + 1] = topic
            wanted.append({"id": len(self._topics), "channelId": self.channels[topic]["id"]})
        await self.send(op="subscribe", subscriptions=wanted)

    async def unsubscribe(self):
        await self.send(op="unsubscribe", subscriptionIds=list(self._topics))

    async def begin_call(self, service, request=None):
        """Call a service, and return the call's number without waiting."""
        self._calls += 1
        number = self.services[service]["id"] if service in self.services else 1
        head = struct.pack("<BIII", _CALL, number, self._calls, 4)
        data = request if isinstance(request, bytes) else json.dumps(request or {}).encode()
        await self._socket.send_bytes(head + b"json" + data)
        return self._calls

    async def end_call(self, number):
        """The answer to a call. Raises Failed."""
        await self.until(lambda: number in self._answers)
        answer = self._answers.pop(number)
        if isinstance(answer, Failed):
            raise answer
        return answer

    async def call(self, service, request=None):
        """Call a service, and return its answer. Raises Failed."""
        return await self.end_call(await self.begin_call(service, request))

    async def refusal(self, service, request=None):
        """The words with which a service fails; empty if it does not."""
        try:
            await self.call(service, request)
        except Failed as failure:
            return str(failure)
        return ""

    def of(self, topic):
        """What has come of a topic, as JSON."""
        return [message.json() for message in self.messages if message.topic == topic]


@asynccontextmanager
async def viewer_of(url, *, services=0, origin=None):
    """A viewer that has been greeted, and knows as many services."""
    async with (
        ClientSession() as session,
        session.ws_connect(url, protocols=[PROTOCOL], origin=origin, max_msg_size=0) as socket,
    ):
        assert socket.protocol == PROTOCOL
        viewer = Viewer(socket)
        await viewer.until(lambda: viewer.info and viewer.channels)
        await viewer.until(lambda: len(viewer.services) >= services)
        yield viewer
