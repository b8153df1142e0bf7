"""Logs as tables for spreadsheets and numpy: one row a tick, with the columns COLUMNS.

Columns have the names, units and meaning of robot.record.CHANNELS, but state and kick are words.
left_omega_rad_s and right_omega_rad_s are those of Log.omega. Floats read back bit for bit. A log
passes through as a stream, so that its length does not matter.
"""

from __future__ import annotations

import csv
import json
import shutil
import tempfile
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack
from itertools import islice
from math import isnan, nan
from pathlib import Path
from typing import IO, Any, TextIO

from host.logs.mcap_files import LogError
from host.logs.mcap_reading import require_no_log
from host.logs.tap import Event
from host.util.whole_files import is_stream, naming, whole_file
from robot.kicks import WHEELS
from robot.record import CHANNELS, KICK_NAMES, NAMES, STATES, Record

_WHEEL = ("phi_rad", "x1", "x2", "force", "torque", "duty_pct", "omega_rad_s")
# The order is a promise; new columns come last.
COLUMNS = (
    ("tick", "t_s", "dt_s")
    + tuple(f"{side}_{name}" for side in WHEELS for name in _WHEEL)
    + ("kick", "state", "late_s", "missed")
)
_NAMED = {"kick": KICK_NAMES, "state": STATES}
# Where a row's values stand in a record that is followed by the wheels' speeds.
_PLACES = tuple([*NAMES, *(side + "_omega_rad_s" for side in WHEELS)].index(n) for n in COLUMNS)
_ANGLES = tuple(NAMES.index(side + "_phi_rad") for side in WHEELS)
_TIME = NAMES.index("t_s")
# How many rows are converted at a time.
BLOCK = 4096

Row = tuple[Any, ...]

FORMATS = ("csv", "npz", "parquet")


def format_of(path: str | Path, wanted: str | None = None) -> str:
    """The format of a table that is to be written to a file, as its ending says.

    Args:
        path: The file. An ending that says nothing, as that of /dev/stdout, is one of any format.
        wanted: The format if it is known: one of FORMATS.

    Returns:
        One of FORMATS; csv if nothing says which.

    Raises:
        LogError: The file is a log, or its ending is that of another format, or, if no format is
            `wanted`, of none.
    """
    require_no_log(path)
    ending = Path(path).suffix.lower().removeprefix(".")
    if ending in FORMATS and wanted in (ending, None):
        return ending
    if ending in FORMATS:
        raise LogError(
            f"{path} cannot be written as {wanted}: its ending says {ending}",
            f"end its name with .{wanted}, or choose --format {ending}",
        )
    if ending and wanted is None:
        raise LogError(
            f"the ending of {path} does not say which table to write",
            f"end its name with .{' or .'.join(FORMATS)}, or say --format",
        )
    return wanted or "csv"


def require_ending(path: str | Path, form: str) -> None:
    """Raise LogError if a file's ending says that it is no table of this format.

    A name without an ending says nothing, and neither does that of a device.

    Args:
        path: The file.
        form: One of FORMATS.
    """
    ending = Path(path).suffix
    if ending and ending.lower() != "." + form and not is_stream(path):
        raise LogError(
            f"{path} would be a table of the kind .{form} under the ending {ending}",
            f"end its name with .{form}",
        )


def save_csv(
    stream: Iterable[Event | Record], path: str | Path, *, new: bool = False, excel: bool = False
) -> int:
    """Write the table as a file of comma-separated values, which appears when it is whole.

    Args:
        stream: A log's events and records, in their order.
        path: The file; what it held is replaced, unless that is a log.
        new: Whether the file must not exist.
        excel: See `write_csv`.

    Returns:
        How many rows it has.

    Raises:
        LogError: The file is a log, or its ending is that of another format.
        FileTaken: `new`, and there is such a file.
        OSError: It cannot be written.
    """
    format_of(path, "csv")
    with whole_file(path, new=new) as draft, draft.open("w", encoding="utf-8", newline="") as out:
        return write_csv(stream, out, excel=excel)


def write_csv(stream: Iterable[Event | Record], out: TextIO, *, excel: bool = False) -> int:
    """Write the table as comma-separated values below a line of column names.

    Args:
        stream: A log's events and records, in their order.
        out: Where to write.
        excel: Whether to separate values by semicolons, and write decimal commas, as spreadsheets
            expect them in most of Europe. A number that is not known is empty.

    Returns:
        How many rows there are.
    """
    writer = csv.writer(out, lineterminator="\n", delimiter=";" if excel else ",")
    writer.writerow(COLUMNS)
    count = 0
    for row in rows_of(stream):
        writer.writerow(map(_with_comma, row) if excel else row)
        count += 1
    return count


def _with_comma(value: Any) -> Any:
    if not isinstance(value, float):
        return value
    return "" if isnan(value) else repr(value).replace(".", ",")


def save_npz(
    stream: Iterable[Event | Record], info: dict[str, Any], path: str | Path, *, new: bool = False
) -> int:
    """Write the columns as arrays of an .npz file, and `info` and `events` as JSON text.

    The columns wait in temporary files beside it, because an .npz file has one after the other.

    Args:
        stream: A log's events and records, in their order.
        info: What was run, as in Log.
        path: The file; what it held is replaced, unless that is a log.
        new: Whether the file must not exist.

    Returns:
        How many rows it has.

    Raises:
        LogError: The file is a log, or its ending is that of another format.
        FileTaken: `new`, and there is such a file.
        OSError: It cannot be written.
    """
    format_of(path, "npz")
    events: list[Event] = []
    with ExitStack() as stack:
        draft = stack.enter_context(whole_file(path, new=new))
        stack.enter_context(naming(path))
        files = {
            name: stack.enter_context(tempfile.TemporaryFile(dir=draft.parent)) for name in COLUMNS
        }
        count = _fill(files, rows_of(keep_events(stream, events)))
        _write_archive(draft, files, count, {"info": info, "events": events})
    return count


def keep_events(stream: Iterable[Event | Record], events: list[Event]) -> Iterator[Event | Record]:
    """Yield a log's events and records, and append the events to a list."""
    for item in stream:
        if isinstance(item, dict):
            events.append(item)
        yield item


def _fill(files: Mapping[str, IO[bytes]], rows: Iterator[Row]) -> int:
    """Write the bytes of each column to its file. Returns how many rows there were."""
    import numpy as np

    count = 0
    while block := list(islice(rows, BLOCK)):
        count += len(block)
        for name, values in zip(COLUMNS, zip(*block, strict=True), strict=True):
            files[name].write(np.array(values, _dtype(name)).tobytes())
    return count


def kind_of(name: str) -> type[str | int | float]:
    """What a column's values are."""
    if name in _NAMED:
        return str
    codes = {channel.name: channel.code for channel in CHANNELS}
    return float if codes.get(name, "d") in "df" else int


def _dtype(name: str) -> Any:
    """numpy's type of a column."""
    import numpy as np

    kind = kind_of(name)
    return np.array(_NAMED[name]).dtype if kind is str else np.dtype(kind)


def _write_archive(
    path: Path, files: Mapping[str, IO[bytes]], count: int, texts: dict[str, Any]
) -> None:
    import numpy as np

    form = np.lib.format
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, file in files.items():
            file.seek(0)
            with archive.open(name + ".npy", "w", force_zip64=True) as member:
                form.write_array_header_1_0(
                    member,
                    {
                        "descr": form.dtype_to_descr(_dtype(name)),
                        "fortran_order": False,
                        "shape": (count,),
                    },
                )
                shutil.copyfileobj(file, member)
        for name, value in texts.items():
            with archive.open(name + ".npy", "w", force_zip64=True) as member:
                form.write_array(member, np.array(json.dumps(value, allow_nan=False)))


def rows_of(stream: Iterable[Event | Record]) -> Iterator[Row]:
    """Yield the rows of a log's records, with state and kick as words; no kick is empty."""
    named = [(COLUMNS.index(name), words) for name, words in _NAMED.items()]
    for record, speeds in _with_speeds(stream):
        values = (*record, *speeds)
        row = [values[place] for place in _PLACES]
        for place, words in named:
            row[place] = words[row[place]]
        yield tuple(row)


def _with_speeds(stream: Iterable[Event | Record]) -> Iterator[tuple[Record, list[float]]]:
    """Yield each record and the wheels' speeds (rad/s) as Log.omega has them.

    The first record, and the first one after a restart, waits for the speeds of the next.
    """
    before: Record | None = None
    waiting: list[Record] = []
    for item in stream:
        if isinstance(item, dict):
            before = None if item["event"] == "restart" else before
            continue
        if before is None:
            waiting.append(item)
        else:
            speeds = [
                _ratio(item[angle] - before[angle], item[_TIME] - before[_TIME])
                for angle in _ANGLES
            ]
            for record in waiting:
                yield record, speeds
            waiting.clear()
            yield item, speeds
        before = item
    for record in waiting:
        yield record, [nan] * len(_ANGLES)


def _ratio(turn: float, time: float) -> float:
    """A quotient by the rules of IEEE 754, as numpy computes it: infinite or NaN for no time."""
    if time:
        return turn / time
    import numpy as np

    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.float64(turn) / np.float64(time))
