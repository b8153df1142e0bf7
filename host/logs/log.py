"""A log in memory: a robot's records and events in their order, and where they came from."""

from __future__ import annotations

from collections.abc import Iterator
from difflib import get_close_matches
from itertools import pairwise
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from host.errors import WrongUse
from host.logs.tap import Event, Tap
from host.util.arguments import need_path, need_tap, plain, wrong
from robot.kicks import WHEELS
from robot.record import CHANNELS, NAMES, Record

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# The columns that no channel has, and their wheels.
SPEEDS = {side + "_omega_rad_s": side for side in WHEELS}


class Gaps:
    """Finds the gaps in the numbers of a stream's ticks.

    Attributes:
        found: (first, end) of each gap: the ticks from first to end - 1 are missing.
    """

    def __init__(self) -> None:
        self.found: list[tuple[int, int]] = []
        self._due: int | None = None

    def take(self, item: Event | Record) -> None:
        """Look at the next event or record."""
        if isinstance(item, dict):
            self._due = item["tick"] if item["event"] == "restart" else self._due
            return
        if self._due is not None and item.tick > self._due:
            self.found.append((self._due, item.tick))
        self._due = item.tick + 1


class Log:
    """Records and events of one subscription; a Tap.

    >>> with connect("sim://", seed=1) as robot:
    ...     with robot.recording() as log:
    ...         robot.wait(3)
    ...         robot.kick_and_watch("phase", ticks=4).reversed
    False
    True
    >>> log
    <Log: 156 ticks, 4.65 s, kicks: 1, sim://>
    >>> log.column("left_duty_pct")[:4]
    array([85, 85, 85, 85])
    >>> log.save("kick.mcap"), log.to_csv("kick.csv")
    (PosixPath('kick.mcap'), PosixPath('kick.csv'))
    >>> Log.load("kick.mcap").records == log.records
    True

    Args:
        info: What was run; see below.

    Attributes:
        records: One Record for each tick, oldest first.
        events: What changed the robot's course, as dictionaries, oldest first.
        places: `places[i]` is the number of records that came before `events[i]`, so
            `records[places[i]]` is the first record that this event concerns.
        info: What was run, in plain JSON data: host_software, robot_software, sources and
            robot_sources (fingerprints of their code), commit, brick (its address), host_machine,
            robot_machine, motor (which the robot has), seed, boot, params, polarity, battery_v,
            clock_zero_s (Unix time at which the robot's clock showed 0), started_utc (ISO 8601),
            and truncated (True) if the log was read from a file that breaks off or is damaged, so
            that ticks or events are missing. What is unknown is left out.
    """

    def __init__(self, info: dict[str, Any] | None = None) -> None:
        self.info: dict[str, Any] = {} if info is None else _table("info", info)
        self.records: list[Record] = []
        self.events: list[Event] = []
        self.places: list[int] = []

    def take_records(self, records: list[Record]) -> None:
        """Append records.

        Args:
            records: The next records, oldest first.
        """
        if not isinstance(records, list) or not all(isinstance(one, Record) for one in records):
            raise wrong("records", records, "a list of Records, oldest first")
        self.records.extend(records)

    def take_event(self, event: Event) -> None:
        """Append an event that concerns the records that are still to come.

        Args:
            event: Its name (`event`), its tick, and what belongs to it.
        """
        if not isinstance(event, dict) or not isinstance(event.get("event"), str):
            raise wrong("event", event, "a dictionary with the event's name under 'event'")
        self.events.append(event)
        self.places.append(len(self.records))

    def until_now(self) -> Self:
        """What the log has now. A log that a robot still records into grows at any time.

        Returns:
            A log that stays as it is.
        """
        now, known = type(self)(), len(self.places)
        now.info, now.records, places = dict(self.info), self.records[:], self.places[:]
        # Of the events that come just now, those whose records are here.
        count = known + sum(place <= len(now.records) for place in places[known:])
        now.events, now.places = self.events[:count], places[:count]
        return now

    def _placed(self) -> Iterator[tuple[Event, int]]:
        # Another thread may have added an event whose place it is about to add.
        return zip(self.events, self.places, strict=False)

    def stream(self) -> Iterator[Event | Record]:
        """Events and records in the order in which they came, of what the log has now.

        Returns:
            An iterator of dictionaries (events) and Records.
        """
        now, done = self.until_now(), 0
        for event, place in zip(now.events, now.places, strict=True):
            yield from now.records[done:place]
            yield event
            done = place
        yield from now.records[done:]

    def play(self, tap: Tap) -> None:
        """Feed the whole log to a tap, as the robot's stream would.

        Args:
            tap: Has take_records(records) and take_event(event).
        """
        need_tap(tap)
        now, done = self.until_now(), 0
        for event, place in zip(now.events, now.places, strict=True):
            if place > done:
                tap.take_records(now.records[done:place])
            tap.take_event(event)
            done = place
        if now.records[done:]:
            tap.take_records(now.records[done:])

    def column(self, name: str) -> NDArray[Any]:
        """A column of the log as an array.

        Args:
            name: The column's name, as in an exported table: tick, t_s, left_torque,
                left_omega_rad_s ... All but the speeds are channels of robot.record.CHANNELS; kick
                and state are numbers here.

        Returns:
            One value for each tick: int64 for whole numbers, float64 for all others.

        Raises:
            WrongUse: There is no such column.
        """
        import numpy as np

        if not isinstance(name, str):
            raise wrong("name", name, "a column's name, as in left_torque")
        if name in SPEEDS:
            return self.omega(SPEEDS[name])
        if name not in NAMES:
            names = [*NAMES, *SPEEDS]
            close = [one for one in names if one.endswith("_" + name)]
            close += get_close_matches(name, names, 1)
            raise WrongUse(
                f"a log has no column '{name}'",
                f"did you mean '{close[0]}'?" if close else "it has " + ", ".join(names),
            )
        index = NAMES.index(name)
        dtype = np.float64 if CHANNELS[index].code in "df" else np.int64
        return np.fromiter(map(itemgetter(index), self.records), dtype, len(self.records))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All columns as arrays, equally long.

        Returns:
            Arrays by the columns' names, see `column`.
        """
        now = self.until_now()
        return {name: now.column(name) for name in (*NAMES, *SPEEDS)}

    def omega(self, side: str) -> NDArray[np.float64]:
        """Speed of a wheel, forward positive: turn over time since the record before.

        The first record, and the first one after a restart of the robot's program, has none before
        it and takes the value of the next; it is NaN if there is no next record either.

        Args:
            side: 'left' or 'right'.

        Returns:
            One value for each tick (rad/s).
        """
        import numpy as np

        if not isinstance(side, str) or side not in WHEELS:
            raise wrong("side", side, "'left' or 'right'")
        now = self.until_now()
        omega = np.full(len(now), np.nan)
        if len(omega) > 1:
            omega[1:] = np.diff(now.column(side + "_phi_rad")) / np.diff(now.column("t_s"))
        for first in reversed([0, *now.restarts()]):
            if first < len(omega):
                omega[first] = omega[first + 1] if first + 1 < len(omega) else np.nan
        return omega

    def restarts(self) -> list[int]:
        """Where the robot's program started again, so that tick and t_s count from its beginning.

        Returns:
            For each restart the index of the first record after it.
        """
        return [place for event, place in self._placed() if event["event"] == "restart"]

    def missing(self) -> list[tuple[int, int]]:
        """The gaps in the numbers of the ticks.

        Returns:
            (first, end) of each gap: the ticks from first to end - 1 are not in the log.
        """
        gaps = Gaps()
        for item in self.stream():
            gaps.take(item)
        return gaps.found

    def kicks(self) -> list[tuple[int, Event]]:
        """The kicks that began in the log.

        Returns:
            (index of the first record of the kick, the kick as a dictionary) of each.
        """
        return [
            (place, event["kick"]) for event, place in self._placed() if event["event"] == "kick"
        ]

    @property
    def seconds(self) -> float:
        """How long the log lasts by the robot's clock (s), from its first record to its last.

        Where the robot's program started again, the parts before and after add up.
        """
        edges = [0, *self.restarts(), len(self.records)]
        spans = [self.records[first:end] for first, end in pairwise(edges)]
        return float(sum(span[-1].t_s - span[0].t_s for span in spans if span))

    def save(self, path: str | Path) -> Path:
        """Write the log to a new MCAP file, which appears when it is whole.

        Args:
            path: The file, which must not exist.

        Returns:
            The file's path.

        Raises:
            LogError: The file exists already, or cannot be written.
            OSError: The disk fails, or is full.
        """
        from host.logs.mcap_files import new_log

        with new_log(need_path("path", path), self.info) as tap:
            self.play(tap)
        return tap.path

    @classmethod
    def load(cls, path: str | Path) -> Self:
        """Read a log from an MCAP file, bit for bit.

        Args:
            path: The file.

        Returns:
            The log. `info["truncated"]` is True if the file breaks off or is damaged; `kickctl
            log recover FILE` makes a whole log of what can be read.

        Raises:
            LogError: The file is not there, or is no log.
        """
        from host.logs.mcap_reading import play

        log = cls()
        log.info, whole = play(need_path("path", path), log)
        if not whole:
            log.info["truncated"] = True
        return log

    def to_csv(self, path: str | Path) -> Path:
        """Write a table, one row for each tick, in the columns of host.logs.tables.

        Args:
            path: The file, which ends in .csv. A file of this name is replaced without a question,
                because cells of a notebook run more than once; a log never is.

        Returns:
            The file's path.

        Raises:
            LogError: The file is a log, or has another ending.
            OSError: It cannot be written.
        """
        from host.logs.tables import require_ending, save_csv

        require_ending(need_path("path", path), "csv")
        save_csv(self.stream(), path)
        return Path(path)

    def to_npz(self, path: str | Path) -> Path:
        """Write the table's columns as numpy arrays, and `info` and `events` as JSON text.

        Args:
            path: The file, which ends in .npz. A file of this name is replaced without a question,
                because cells of a notebook run more than once; a log never is.

        Returns:
            The file's path.

        Raises:
            LogError: The file is a log, or has another ending.
            OSError: It cannot be written.
        """
        from host.logs.tables import require_ending, save_npz

        require_ending(need_path("path", path), "npz")
        save_npz(self.stream(), self.info, path)
        return Path(path)

    def to_parquet(self, path: str | Path) -> Path:
        """Write the table as a Parquet file, with units, `info` and `events` in its metadata.

        Args:
            path: The file, which ends in .parquet. A file of this name is replaced without a
                question, because cells of a notebook run more than once; a log never is.

        Returns:
            The file's path.

        Raises:
            WrongUse: pyarrow is not installed: it comes with `kickctl[parquet]`.
            LogError: The file is a log, or has another ending.
            OSError: It cannot be written.
        """
        from host.logs.parquet import save_parquet
        from host.logs.tables import require_ending

        require_ending(need_path("path", path), "parquet")
        save_parquet(self.stream(), self.info, path)
        return Path(path)

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        gone = sum(end - first for first, end in self.missing())
        parts = [f"{len(self)} ticks", f"{self.seconds:.2f} s", f"kicks: {len(self.kicks())}"]
        parts += [f"{gone} ticks missing"] if gone else []
        parts += [str(self.info["brick"])] if "brick" in self.info else []
        parts += ["the file breaks off or is damaged"] if self.info.get("truncated") else []
        return f"<Log: {', '.join(parts)}>"


def _table(name: str, value: object) -> dict[str, Any]:
    """What a log says beside its records: plain JSON data by names. Raises WrongUse."""
    wanted = "a dictionary of text, numbers, lists and dictionaries"
    try:
        table = plain(value)
    except (TypeError, RecursionError) as error:
        raise wrong(name, value, wanted) from error
    if not isinstance(table, dict):
        raise wrong(name, value, wanted)
    return table
