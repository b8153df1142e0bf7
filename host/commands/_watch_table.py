"""The table of `kickctl watch`, from the lines that say what happens."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from host.commands._watched import event_words
from robot.kicks import WHEELS
from robot.words import duration

if TYPE_CHECKING:
    from rich.console import Group
    from rich.live import Live
    from rich.table import Table

_ROWS = {
    "turns_per_s": "speed (turns/s)",
    "torque": "torque M",
    "duty_pct": "duty (%)",
    "x1": "x1",
    "x2": "x2",
    "phi_rad": "phi (rad)",
}
_HAPPENINGS = 5
# A stop takes three lines for each robot: it was sent, what the robot answered, and the event.
_STOP_LINES = 3
_DRAW_S = 0.1


class Screen(ABC):
    """What a person sees of watched robots.

    A thread draws it, so that neither a robot's link nor a stop ever waits for a terminal, and so
    that words about a stop appear while a link is broken.

    Args:
        foot: The lines below all others, which say what keys do.
        happenings: How many lines of what has happened are shown.
    """

    def __init__(self, foot: list[str], happenings: int = _HAPPENINGS) -> None:
        self._foot = foot
        self._happened: deque[str] = deque(maxlen=happenings)
        self._lock = threading.Lock()
        self._live: Live | None = None
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    @abstractmethod
    def body(self) -> list[Any]:
        """What stands above the words, for rich."""

    def add(self, words: str) -> None:
        """Show words among what has happened."""
        with self._lock:
            self._happened.append(words)

    def change_foot(self, foot: list[str]) -> None:
        """Show other lines below all others."""
        with self._lock:
            self._foot = foot

    def render(self) -> Group:
        """All of it, for rich."""
        from rich.console import Group
        from rich.text import Text

        body = self.body()
        with self._lock:
            words = [*self._happened, *self._foot]
        return Group(*body, *map(Text, words))

    def open(self) -> None:
        """Draw on the terminal from now on, below what is there."""
        from rich.live import Live

        self._live = Live(self.render(), auto_refresh=False)
        self._live.start()
        self._ended.clear()
        self._thread = threading.Thread(target=self._draw, name="kickctl table", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Draw for the last time, and leave the table where it is."""
        live, self._live = self._live, None
        if live is not None:
            self._ended.set()
            if self._thread is not None:
                self._thread.join()
            live.update(self.render())
            live.stop()

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Draw until the end of the block."""
        try:
            self.open()
            yield
        finally:
            self.close()

    def _draw(self) -> None:
        live = self._live
        try:
            while live is not None and not self._ended.wait(_DRAW_S):
                live.update(self.render(), refresh=True)
        except OSError:
            pass  # the terminal is gone; `close` says so


class OneRobot(Screen):
    """The screen for one robot.

    Args:
        uri: The robot's address.
        foot: As for Screen.
    """

    def __init__(self, uri: str, foot: list[str]) -> None:
        super().__init__(foot)
        self._uri = uri
        self._line: dict[str, Any] | None = None

    def take(self, line: dict[str, Any]) -> None:
        """Show the next line."""
        self._line = line
        for event in line["events"]:
            self.add(event_words(event))

    def body(self) -> list[Any]:
        from rich.text import Text

        line = self._line
        if line is None:
            return [Text(f"{self._uri}: no record yet")]
        return [_title(self._uri, line), _wheels(line), *map(Text, _facts(line))]


class SeveralRobots(Screen):
    """The screen for several robots: a row for each.

    Args:
        names: The robots, in the order of their rows.
        foot: As for Screen.
    """

    def __init__(self, names: list[str], foot: list[str]) -> None:
        super().__init__(foot, max(_HAPPENINGS, _STOP_LINES * len(names)))
        self._lines: dict[str, dict[str, Any] | None] = dict.fromkeys(names)

    def take(self, name: str, line: dict[str, Any]) -> None:
        """Show a robot's next line."""
        self._lines[name] = line
        for event in line["events"]:
            self.add(f"{name}: {event_words(event)}")

    def body(self) -> list[Any]:
        from rich.table import Table
        from rich.text import Text

        table = Table()
        for title in ("robot", "state", "kick", "driven by"):
            table.add_column(title)
        for title in ("left (turns/s)", "right (turns/s)", "missed", "lost"):
            table.add_column(title, justify="right")
        for name, line in self._lines.items():
            cells = ["no record yet"] if line is None else _cells(line)
            table.add_row(*map(Text, [name, *cells]))
        return [table]


def _cells(line: dict[str, Any]) -> list[str]:
    speeds = (f"{line[side]['turns_per_s']:.2f}" for side in WHEELS)
    driver = line["controller"] or "nobody"
    counts = str(line["missed"]), str(line["lost"])
    return [line["state"], line["recent_kick"], driver, *speeds, *counts]


def _title(uri: str, line: dict[str, Any]) -> Any:
    from rich.text import Text

    title = Text(f"{uri}  tick {line['tick']}  {line['state']}  ")
    if line["recent_kick"]:
        title.append(f" kick: {line['recent_kick']} ", style="reverse")
    return title


def _wheels(line: dict[str, Any]) -> Table:
    from rich.table import Table

    table = Table()
    table.add_column("")
    for side in WHEELS:
        table.add_column(side, justify="right", min_width=9)
    for name, title in _ROWS.items():
        table.add_row(title, *(f"{line[side][name]:.2f}" for side in WHEELS))
    return table


def _facts(line: dict[str, Any]) -> list[str]:
    """Why it is in its state, who drives it, and how punctual it is."""
    held_s = line["controller_held_s"]
    since = "" if line["controller"] is None or held_s is None else f", for {duration(held_s)}"
    restarts = line["restarts"]
    again = f"; its program has started again {restarts} times" if restarts else ""
    punctual = (
        f"{line['missed']} deadlines missed and {line['overruns']} ticks overrun so far;"
        f" {line['lost']} records lost here; now at most {1000 * line['late_s']:.1f} ms late{again}"
    )
    driver = line["controller"] or "nobody"
    return [f"{line['state']}: {line['reason']}", f"driven by {driver}{since}", punctual]
