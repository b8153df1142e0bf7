"""A Parquet table holds what a log holds, bit for bit, and says units and what was run."""

import json
import re
import struct
import sys

import numpy as np
import pytest
from pyarrow.parquet import ParquetFile, read_table

from host.errors import WrongUse
from host.logs.log import Log
from host.logs.tables import BLOCK, COLUMNS
from robot.record import CHANNELS, KICK_NAMES, STATES
from tests.fakes import eventful
from tests.lint.sources import ROOT

# A NaN whose bits are not those of Python's own.
OTHER_NAN = struct.unpack("<d", bytes.fromhex("0123456789abf87f"))[0]


@pytest.fixture(scope="module")
def log():
    log = eventful().log(brick="sim://", params={"k": 8.0})
    odd = {"left_x1": -0.0, "left_x2": 5e-324, "left_force": 0.1 + 0.2, "right_x1": OTHER_NAN}
    log.records[3] = log.records[3]._replace(**odd)
    return log


def test_every_value_reads_back_bit_for_bit(log, tmp_path):
    table = read_table(log.to_parquet(tmp_path / "log.parquet"))
    assert tuple(table.column_names) == COLUMNS
    for name, column in log.arrays().items():
        read = table[name]
        if name in ("kick", "state"):
            words = {"kick": KICK_NAMES, "state": STATES}[name]
            assert read.to_pylist() == [words[value] for value in column]
        else:
            assert read.to_numpy().dtype == column.dtype
            assert read.to_numpy().tobytes() == column.tobytes()
    assert np.array(OTHER_NAN).tobytes() in table["right_x1"].to_numpy().tobytes()


def test_columns_say_their_units_and_the_file_what_was_run(log, tmp_path):
    file = ParquetFile(log.to_parquet(tmp_path / "log.parquet"))
    said = {field.name: field.metadata for field in file.schema_arrow}
    for channel in CHANNELS:
        if channel.name not in ("kick", "state"):
            unit, doc = channel.unit.encode(), channel.doc.encode()
            assert said[channel.name] == {b"unit": unit, b"doc": doc}
    assert said["left_omega_rad_s"][b"unit"] == b"rad/s"
    assert b"fault" in said["state"][b"doc"]
    assert json.loads(file.metadata.metadata[b"info"]) == log.info
    assert json.loads(file.metadata.metadata[b"events"]) == log.events


def test_the_page_reads_a_table_as_it_says(log, tmp_path, monkeypatch, capsys):
    page = (ROOT / "docs" / "logs.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    log.to_parquet("mine.parquet")
    exec(page.partition("```python\n")[2].partition("```")[0], {})  # noqa: S102
    assert capsys.readouterr().out == "rad 8.0\n"
    columns = re.findall(r"`(\w+)`", page.partition("| columns |")[2].partition("\n\n")[0])
    assert set(columns) == {name for name in COLUMNS if not name.startswith("right_")}


def test_a_long_log_has_its_rows_in_their_order(log, tmp_path):
    record = log.records[0]
    long = Log()
    ticks = 5 * BLOCK + 5
    long.take_records([record._replace(tick=tick) for tick in range(ticks)])
    file = ParquetFile(long.to_parquet(tmp_path / "long.parquet"))
    assert file.num_row_groups == 2
    assert np.array_equal(file.read(["tick"])["tick"], np.arange(ticks))


def test_a_log_without_ticks_has_its_columns(tmp_path):
    table = read_table(Log().to_parquet(tmp_path / "log.parquet"))
    assert (tuple(table.column_names), len(table)) == (COLUMNS, 0)


def test_without_pyarrow_it_says_how_to_get_it_and_writes_nothing(log, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(WrongUse, match="pyarrow, which is not installed") as refused:
        log.to_parquet(tmp_path / "log.parquet")
    assert refused.value.hint.startswith("install it: ")
    assert list(tmp_path.iterdir()) == []
