"""Makes a whole log of what can be read of a damaged one, and marks in it what is lost."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from host.logs.log_folder import under_free_name
from host.logs.mcap_files import LogError, new_log
from host.logs.mcap_reading import LogFile, lost_event


class Recovered(NamedTuple):
    """What came of a log that breaks off or is damaged.

    Attributes:
        path: The new log.
        ticks: How many ticks it has.
        was_whole: Whether the old one was whole.
        lost: How many ticks of the old one are not in it; None if the old one has no index, and
            no gap before its end says so.
        total: How many ticks the old one had by its index; None if it has none.
    """

    path: Path
    ticks: int
    was_whole: bool
    lost: int | None
    total: int | None


def recover(path: str | Path, out: Path | None = None) -> Recovered:
    """Write what can be read of a log to a new one, which has an index again.

    Intact parts behind a damaged place are recovered too; the new log has the event `lost` there,
    as after a gap in the robot's stream.

    Args:
        path: The log; it is not changed.
        out: The new log, which must not exist; by default NAME-recovered.mcap beside it.

    Returns:
        The new log.

    Raises:
        LogError: There is no such log, nothing of it can be read, or the new one cannot be written.
        OSError: The disk fails, or is full.
    """
    source = LogFile(path)

    def write(place: Path) -> Recovered:
        with new_log(place, source.info) as tap:
            empty = True
            for item in source.stream(past_damage=True):
                empty = False
                if isinstance(item, dict):
                    tap.take_event(item)
                else:
                    tap.take_records([item])
            if empty and not source.whole:
                raise LogError(
                    f"no tick and no event of {source.path} can be read, so no log was written",
                    "if the robot's program still runs, its black box has the last seconds:"
                    " kickctl log pull",
                )
            lost, total = source.lost, source.total
            if source.open_end and total is not None and not source.left_out:
                due = 0 if source.last_tick is None else source.last_tick + 1
                at_end = total - source.ticks - source.skipped
                if at_end > 0:
                    tap.take_event(lost_event(due, due + at_end))
        if lost is None and source.skipped:
            lost = source.skipped
        return Recovered(place, source.ticks, source.whole, lost, total)

    if out is not None:
        return write(out)
    return under_free_name(source.path.with_name(f"{source.path.stem}-recovered.mcap"), write)
