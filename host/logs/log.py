"""A log in memory: every tick's record and every event a robot sent, in their order, and where they came from."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from host.logs.tap import Event, Tap
from robot.kicks import WHEELS
from robot.record import CHANNELS, NAMES, Record

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Log:
    """Records and events of one subscription; a Tap.

    `info` says what was run, in plain JSON data; what is unknown is left out:
    host_software, robot_software, commit, brick (URI), host_machine, robot_machine (as the robot's hello names it), seed, boot,
    params, polarity, battery_v, clock_zero_s (Unix time at which the robot's clock showed 0), started_utc (ISO 8601); and
    truncated (True) if the log was read from a file that breaks off or is damaged.

    `places[i]` is the number of records that came before `events[i]`, so `records[places[i]]` is the first one it concerns.
    """

    def __init__(self, info: dict[str, Any] | None = None) -> None:
        self.info: dict[str, Any] = dict(info or {})
        self.records: list[Record] = []
        self.events: list[Event] = []
        self.places: list[int] = []

    def take_records(self, records: list[Record]) -> None:
        """Append records."""
        self.records.extend(records)

    def take_event(self, event: Event) -> None:
        """Append an event that concerns the records that are still to come."""
        self.events.append(event)
        self.places.append(len(self.records))

    def stream(self) -> Iterator[Event | Record]:
        """Events and records in the order in which they came."""
        done = 0
        for event, place in zip(self.events, self.places, strict=True):
            yield from self.records[done:place]
            yield event
            done = place
        yield from self.records[done:]

    def play(self, tap: Tap) -> None:
        """Feed the whole log to a tap, as the robot's stream would."""
        done = 0
        for event, place in zip(self.events, self.places, strict=True):
            if place > done:
                tap.take_records(self.records[done:place])
            tap.take_event(event)
            done = place
        if self.records[done:]:
            tap.take_records(self.records[done:])

    def column(self, name: str) -> NDArray[Any]:
        """A channel of robot.record.CHANNELS, one value a tick: int64 for whole numbers, else float64. KeyError if there is none."""
        import numpy as np

        if name not in NAMES:
            raise KeyError(f"a log has no column '{name}'; it has " + ", ".join(NAMES))
        index = NAMES.index(name)
        dtype = np.float64 if CHANNELS[index].code in "df" else np.int64
        return np.fromiter((record[index] for record in self.records), dtype, len(self.records))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All columns by name, and left_omega_rad_s and right_omega_rad_s."""
        speeds = {side + "_omega_rad_s": self.omega(side) for side in WHEELS}
        return {**{name: self.column(name) for name in NAMES}, **speeds}

    def omega(self, side: str) -> NDArray[np.float64]:
        """Speed of the 'left' or 'right' wheel in rad/s, one value a tick: the turn since the record before over the time since it.

        The first record, and the first of a robot that began anew, has none before it and takes the value of the next; NaN if there
        is no next either.
        """
        import numpy as np

        omega = np.full(len(self.records), np.nan)
        if len(omega) > 1:
            omega[1:] = np.diff(self.column(side + "_phi_rad")) / np.diff(self.column("t_s"))
        for first in reversed([0, *self.restarts()]):
            if first < len(omega):
                omega[first] = omega[first + 1] if first + 1 < len(omega) else np.nan
        return omega

    def restarts(self) -> list[int]:
        """The index of the first record after each new beginning of the robot's program, from which ticks and t_s count anew."""
        return [
            place
            for event, place in zip(self.events, self.places, strict=True)
            if event["event"] == "restart"
        ]

    def missing(self) -> list[tuple[int, int]]:
        """The gaps (first, end) in the numbers of the ticks: those from first to end - 1 are not in the log."""
        gaps = []
        due: int | None = None
        for item in self.stream():
            if isinstance(item, dict):
                due = item["tick"] if item["event"] == "restart" else due
                continue
            if due is not None and item.tick > due:
                gaps.append((due, item.tick))
            due = item.tick + 1
        return gaps

    def kicks(self) -> list[tuple[int, Event]]:
        """(index of the record in which it begins, the kick as plain data) of every kick that began in the log."""
        return [
            (place, event["kick"])
            for event, place in zip(self.events, self.places, strict=True)
            if event["event"] == "kick"
        ]

    @property
    def seconds(self) -> float:
        """How long the log lasts by the robot's clock, from its first record to its last; a robot that began anew counts anew."""
        edges = [0, *self.restarts(), len(self.records)]
        spans = [self.records[first:end] for first, end in pairwise(edges)]
        return float(sum(span[-1].t_s - span[0].t_s for span in spans if span))

    def save(self, path: str | Path) -> Path:
        """Write the log to a new MCAP file. Raises LogError if the file exists already."""
        from host.logs.mcap_files import McapTap

        with McapTap(path, self.info) as tap:
            self.play(tap)
        return tap.path

    @classmethod
    def load(cls, path: str | Path) -> Log:
        """The log in an MCAP file, bit for bit. Raises LogError."""
        from host.logs.mcap_files import play

        log = cls()
        log.info, whole = play(path, log)
        if not whole:
            log.info["truncated"] = True
        return log

    def to_csv(self, path: str | Path) -> Path:
        """Write one row a tick, as host.logs.tables describes it, over whatever the file held."""
        from host.logs.tables import write_csv

        path = Path(path)
        with path.open("w", encoding="utf-8", newline="") as out:
            write_csv(self.arrays(), out)
        return path

    def to_npz(self, path: str | Path) -> Path:
        """Write the same columns as numpy arrays, with `info` and `events` as JSON text, over whatever the file held."""
        from host.logs.tables import write_npz

        path = Path(path)
        with path.open("wb") as out:
            write_npz(self.arrays(), self.info, self.events, out)
        return path

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        gone = sum(end - first for first, end in self.missing())
        parts = [f"{len(self)} ticks", f"{self.seconds:.2f} s", f"kicks: {len(self.kicks())}"]
        parts += [f"{gone} ticks missing"] if gone else []
        parts += [str(self.info["brick"])] if "brick" in self.info else []
        parts += ["the file breaks off"] if self.info.get("truncated") else []
        return f"<Log: {', '.join(parts)}>"
