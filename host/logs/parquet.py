"""Logs as Parquet tables, which pandas, polars, DuckDB and R read: the columns of host.logs.tables.

Each column says its unit and what it is; the file says what was run. All values read back bit for
bit. A log passes through as a stream, so that its length does not matter.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

from host.logs.tables import BLOCK, COLUMNS, Row, format_of, keep_events, kind_of, rows_of
from host.logs.tap import Event
from host.util.extras import need
from host.util.whole_files import whole_file
from robot.kicks import WHEELS
from robot.record import CHANNELS, KICK_NAMES, STATES, Record

# How many blocks of rows share a row group: readers take in one group at a time.
_BLOCKS = 4
_SPEED = "speed of the wheel, forward positive: its turn since the record before over the time"
# (unit, meaning) of the columns that are not numbers of robot.record.CHANNELS.
_OTHERS = {
    "kick": ("", f"the kick that acts: {', '.join(KICK_NAMES[1:])}; empty for none"),
    "state": ("", f"state of the robot: {', '.join(STATES)}"),
    **dict.fromkeys((side + "_omega_rad_s" for side in WHEELS), ("rad/s", _SPEED)),
}
MEANINGS = {channel.name: (channel.unit, channel.doc) for channel in CHANNELS} | _OTHERS


def save_parquet(
    stream: Iterable[Event | Record], info: dict[str, Any], path: str | Path, *, new: bool = False
) -> int:
    """Write the table as a Parquet file, which appears when it is whole.

    Each column has `unit` and `doc` in its metadata. The file's metadata has `info` and `events` as
    JSON text.

    Args:
        stream: A log's events and records, in their order.
        info: What was run, as in Log.
        path: The file; what it held is replaced, unless that is a log.
        new: Whether the file must not exist.

    Returns:
        How many rows it has.

    Raises:
        WrongUse: pyarrow is not installed.
        LogError: The file is a log, or its ending is that of another format.
        FileTaken: `new`, and there is such a file.
        OSError: It cannot be written.
    """
    format_of(path, "parquet")
    need("pyarrow", "parquet")
    from pyarrow.parquet import ParquetWriter

    events: list[Event] = []
    count = 0
    schema = _schema()
    with (
        whole_file(path, new=new) as draft,
        draft.open("wb") as out,
        ParquetWriter(out, schema) as writer,
    ):
        for group in _groups(rows_of(keep_events(stream, events)), schema):
            writer.write_table(group)
            count += len(group)
        writer.add_key_value_metadata(
            {
                name: json.dumps(value, allow_nan=False)
                for name, value in (("info", info), ("events", events))
            }
        )
    return count


def _schema() -> Any:
    import pyarrow as pa

    types = {str: pa.string(), int: pa.int64(), float: pa.float64()}
    return pa.schema(
        pa.field(
            name,
            types[kind_of(name)],
            metadata=dict(zip(("unit", "doc"), MEANINGS[name], strict=True)),
        )
        for name in COLUMNS
    )


def _groups(rows: Iterator[Row], schema: Any) -> Iterator[Any]:
    """Yield the rows as Arrow tables of some blocks each."""
    import pyarrow as pa

    batches = (
        pa.record_batch(
            [
                pa.array(values, type=field.type)
                for values, field in zip(zip(*block, strict=True), schema, strict=True)
            ],
            schema=schema,
        )
        for block in iter(lambda: list(islice(rows, BLOCK)), [])
    )
    while group := list(islice(batches, _BLOCKS)):
        yield pa.Table.from_batches(group)
