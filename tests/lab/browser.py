"""What a page's browser does, without a browser: WebSockets to a lab over real sockets."""

import asyncio
import struct
import threading
from contextlib import contextmanager

import aiohttp

from robot.record import STRUCT

HEADER = struct.Struct("<BBHI")


def site(url):
    """Where a lab listens, without a key: http://HOST:PORT."""
    return url.partition("/#")[0]


def key(url):
    """The key in a lab's address."""
    return url.rpartition("=")[2]


@contextmanager
def held_up(lab):
    """Block the server's event loop until the end of the block."""
    begun, end = threading.Event(), threading.Event()

    def wait():
        begun.set()
        end.wait()

    lab.call(wait)
    begun.wait()
    try:
        yield
    finally:
        end.set()


class Tab:
    """A page that has joined."""

    def __init__(self, socket):
        self.socket = socket
        self.got = []
        self.records = []
        self.missed = 0

    async def send(self, kind, **fields):
        await self.socket.send_json({"type": kind, **fields})

    async def read(self):
        """Take in the next message. Returns what it is; None if the server has hung up."""
        message = await self.socket.receive(timeout=20.0)
        if message.type == aiohttp.WSMsgType.TEXT:
            self.got.append(message.json())
            return self.got[-1]
        if message.type == aiohttp.WSMsgType.BINARY:
            kind, robot, count, missed = HEADER.unpack_from(message.data)
            assert kind == 1
            if robot:  # another than the first
                return {"type": "records"}
            size = (len(message.data) - HEADER.size) // count
            for at in range(HEADER.size, len(message.data), size):
                self.records.append(STRUCT.unpack_from(message.data, at))
            self.missed += missed
            return {"type": "records"}
        return None

    async def until(self, condition):
        """Read until a condition on this tab holds."""
        while not condition(self):
            assert await self.read() is not None, "the server has hung up"
        return self

    async def latest(self, kind):
        """The next message of a type, or one that has come already."""
        await self.until(lambda tab: any(one["type"] == kind for one in tab.got))
        return [one for one in self.got if one["type"] == kind][-1]

    async def until_nobody_drives(self):
        """Read until the baton is free: the lab may not have noticed yet that a page has gone."""
        await self.latest("baton")
        await self.until(
            lambda tab: [one for one in tab.got if one["type"] == "baton"][-1]["driver"] is None
        )

    async def ask(self, kind, **fields):
        """The reply to a request."""
        number = len(self.got) + 1000
        await self.send(kind, request=number, **fields)
        await self.until(lambda tab: any(one.get("request") == number for one in tab.got))
        return next(one for one in self.got if one.get("request") == number)


class Browser:
    """A browser; `async with Browser() as browser`."""

    async def __aenter__(self):
        self.http = aiohttp.ClientSession()
        return self

    async def __aexit__(self, *_):
        await self.http.close()

    async def connect(self, url, **options):
        """A WebSocket to a lab, which has not joined yet."""
        options = {"origin": site(url), **options}
        return await self.http.ws_connect(site(url) + "/messages", **options)

    async def open(self, url, **options):
        """A page at an address with a key, which has been let in."""
        tab = Tab(await self.connect(url, **options))
        await tab.send("join", key=key(url), resume=None)
        await tab.latest("pages")
        return tab


def browse(scenario):
    """Run a function that takes a Browser."""

    async def run():
        async with Browser() as browser:
            return await asyncio.wait_for(scenario(browser), 60.0)

    return asyncio.run(run())
