"""The lab as it runs: its stations, its session, and its web server in a thread of their own."""

from __future__ import annotations

import asyncio
import errno
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Self

from aiohttp import web

from host.errors import KickctlError, NotDone, WrongUse
from host.lab.forecasts import Forecasts
from host.lab.keys import Keys
from host.lab.page_files import PAGE_FOLDER
from host.lab.replays import Replays
from host.lab.session import Session
from host.lab.station import Station
from host.lab.urgent import UrgentThread
from host.lab.web import Site
from host.lab.worker import Worker

LOOPBACK = "127.0.0.1"
TICK_S = 0.1
STOP_PATIENCE_S = 5.0
# How late (s) an interrupt is seen in the worst case.
LOOK_S = 0.5


class Lab:
    """A lab that serves its page from entering the `with` block until leaving it.

    Stations are the caller's: they begin and end outside.

    Args:
        stations: The robots.
        port: The TCP port; 0 lets the system choose.
        host: An address of this machine on which others may watch, beside this computer; None if
            nobody else may.
        folder: The page's files.
        forecasts: Where kicks are predicted; None if nowhere. It is the caller's, too.
        basins: Where basins are computed; None if nowhere. It is the caller's, too.
        replays: Where logs are read for pages; None if nowhere. They end with the lab.
        checks: Where exercises are checked; None if nowhere. It is the caller's, too.

    Attributes:
        session: What pages and robots have to do with each other.
        drive_url: The page's address for who drives, with the key.
        view_url: The page's address for who watches, with the key.
    """

    def __init__(
        self,
        stations: Sequence[Station],
        port: int = 0,
        host: str | None = None,
        folder: Path = PAGE_FOLDER,
        forecasts: Forecasts | None = None,
        basins: Worker | None = None,
        replays: Replays | None = None,
        checks: Worker | None = None,
    ) -> None:
        self.keys = Keys()
        self.session = Session(self.keys, stations)
        self.session.marking.worker = checks
        self.drive_url = self.view_url = ""
        self._site = Site(self.session, folder, replays)
        self._stations = stations
        for station in stations:
            station.forecasts = forecasts
            station.basins = basins
        self._port = port
        self._hosts = [LOOPBACK, *([host] if host not in (None, LOOPBACK) else [])]
        self._loop = asyncio.new_event_loop()
        self._ready = threading.Event()
        self._ended = threading.Event()
        self._end = asyncio.Event()
        self._failure: BaseException | None = None
        self._woken = False
        self._thread = UrgentThread(target=self._run, name="lab server", daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        self._ready.wait()
        if self._failure is not None:
            self._thread.join()
            raise self._failure
        return self

    def __exit__(self, *_: object) -> None:
        self.call(self._end.set)
        self._thread.join()

    def wait(self) -> None:
        """Wait until the server ends, which it does by itself only if it fails. Raises that."""
        # A signal that comes just before a thread falls asleep does not wake it.
        while not self._ended.wait(LOOK_S):
            pass
        if self._failure is not None:
            raise self._failure

    # What stations call, from any thread.

    def hear(self, message: dict[str, Any]) -> None:
        """Give a message to all pages."""
        self.call(lambda: self.session.hear(message))

    def wake(self) -> None:
        """There are new records, or the state of a robot has changed."""
        if not self._woken:
            self._woken = True
            self.call(self._look)

    def call(self, function: Callable[[], object]) -> None:
        """Call a function in the server's thread; never after the server's end."""
        with suppress(RuntimeError):  # the loop is closed
            self._loop.call_soon_threadsafe(function)

    def _look(self) -> None:
        self._woken = False
        self.session.look()
        self._site.wake()

    # The server's thread.

    def _run(self) -> None:
        try:
            self._loop.run_until_complete(self._serve())
        except BaseException as error:  # noqa: BLE001 - raised in the thread that waits
            self._failure = error
        finally:
            self._loop.close()
            self._ready.set()
            self._ended.set()

    async def _serve(self) -> None:
        runner = web.AppRunner(self._site.application(), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        try:
            for host in self._hosts:
                await self._listen(runner, host)
            self.drive_url = f"http://{_written(LOOPBACK)}:{self._port}/#drive={self.keys.drive}"
            self.view_url = (
                f"http://{_written(self._hosts[-1])}:{self._port}/#view={self.keys.view}"
            )
            self.session.view_url = self.view_url
            for station in self._stations:
                station.pages = self
            self._ready.set()
            await self._tick_until_end()
        finally:
            for station in self._stations:
                station.pages = None
            await runner.cleanup()

    async def _listen(self, runner: web.AppRunner, host: str) -> None:
        try:
            await web.TCPSite(runner, host, self._port).start()
        except OSError as error:
            raise _words(error, host, self._port) from error
        self._port = runner.addresses[-1][1]

    async def _tick_until_end(self) -> None:
        while not self._end.is_set():
            self.session.tick(self._loop.time())
            try:
                await asyncio.wait_for(self._end.wait(), TICK_S)
            except TimeoutError:
                continue


def _written(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _words(error: OSError, host: str, port: int) -> KickctlError:
    """Why the server cannot listen at an address."""
    if error.errno == errno.EADDRINUSE:
        return NotDone(
            f"port {port} is taken: another lab may be running on this computer",
            f"end that one, or take another port: --port {port + 1}, or --port 0 for any",
        )
    if error.errno == errno.EACCES:
        return WrongUse(
            f"port {port} belongs to the system: only its administrator may use it",
            "take one above 1023: --port 5426",
        )
    return WrongUse(
        f"this computer cannot listen at {host}: {error.strerror or error}",
        "--host takes an address of this computer in its network, as `ip address` shows it",
    )
