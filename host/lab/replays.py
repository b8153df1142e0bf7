"""The replays that pages ask for. A process of its own reads the logs: no stop waits for it."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

from host.errors import KickctlError, NotDone
from host.lab.worker import Answer, Worker

# A class that opens the same log reads it once. A tape has up to 10 MB.
_KEPT = 4
_NICENESS = 10


class Replays:
    """Tapes as JSON text, see host.lab.tape. The latest ones are kept."""

    def __init__(self) -> None:
        self._worker = Worker("reads logs", _NICENESS)
        self.close = self._worker.close
        self._texts: dict[tuple[Path, int], str] = {}
        self._given: dict[str, str] = {}
        self._reading = asyncio.Lock()

    def give(self, tape: dict[str, Any]) -> None:
        """Have a tape shown under its name, before any log of this name."""
        self._given[tape["name"]] = json.dumps(tape, allow_nan=False)

    def given(self, name: str) -> str | None:
        """The text of a tape that was given; None if there is none of this name."""
        return self._given.get(name)

    async def read(self, path: Path) -> str:
        """The tape of a log, which may still be growing.

        Args:
            path: The log's file.

        Returns:
            JSON text.

        Raises:
            KickctlError: It cannot be read, or is too long.
        """
        async with self._reading:
            key = path, _size(path)
            if key not in self._texts:
                self._texts[key] = await self._ask(path)
                while len(self._texts) > _KEPT:
                    del self._texts[next(iter(self._texts))]
            return self._texts[key]

    async def _ask(self, path: Path) -> str:
        loop = asyncio.get_running_loop()
        future: asyncio.Future[Answer] = loop.create_future()

        def settle(answer: Answer) -> None:
            if not future.done():
                future.set_result(answer)

        def done(answer: Answer) -> None:
            with suppress(RuntimeError):  # the loop is closed, since the lab ends
                loop.call_soon_threadsafe(settle, answer)

        await asyncio.to_thread(self._worker.ask, _read, path, done)  # its process may begin
        answer = await future
        if isinstance(answer, KickctlError):
            raise answer
        return str(answer["text"])


def _size(path: Path) -> int:
    return path.stat().st_size


def _read(path: Path) -> Answer:
    from host.lab.tape import make_tape
    from host.logs.mcap_reading import LogFile

    try:
        return {"text": json.dumps(make_tape(LogFile(path), path.name), allow_nan=False)}
    except KickctlError as error:
        return NotDone(error.message, error.hint)
