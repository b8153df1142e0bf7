"""Exports hold one row a tick, bit for bit, under the promised names."""

import csv
import json

import numpy as np
import pytest

from host.logs.mcap_files import LogError
from host.logs.tables import COLUMNS
from robot.record import KICK_NAMES, STATES
from tests.fakes import eventful

PROMISED = (
    "tick,t_s,dt_s,"
    "left_phi_rad,left_x1,left_x2,left_force,left_torque,left_duty_pct,left_omega_rad_s,"
    "right_phi_rad,right_x1,right_x2,right_force,right_torque,right_duty_pct,right_omega_rad_s,"
    "kick,state,late_s,missed"
)


@pytest.fixture(scope="module")
def log():
    log = eventful().log(brick="sim://", seed=7)
    log.records[3] = log.records[3]._replace(left_x1=-0.0, left_x2=5e-324, left_force=0.1 + 0.2)
    return log


def test_csv_reads_back_bit_for_bit(log, tmp_path):
    with log.to_csv(tmp_path / "log.csv").open(newline="") as file:
        assert file.readline() == PROMISED + "\n"
        file.seek(0)
        rows = list(csv.DictReader(file))
    assert len(rows) == len(log)
    omega = {side: log.omega(side) for side in ("left", "right")}
    for number, (row, record) in enumerate(zip(rows, log.records, strict=True)):
        assert row.pop("kick") == KICK_NAMES[record.kick]
        assert row.pop("state") == STATES[record.state]
        for side, speeds in omega.items():
            assert float(row.pop(side + "_omega_rad_s")) == speeds[number]
        for name, text in row.items():
            assert text == repr(getattr(record, name))


def test_npz_holds_the_same_columns(log, tmp_path):
    with np.load(log.to_npz(tmp_path / "log.npz")) as table:
        assert set(table) == {*COLUMNS, "info", "events"}
        assert json.loads(str(table["info"])) == log.info
        assert json.loads(str(table["events"])) == log.events
        assert {name: len(table[name]) for name in COLUMNS} == dict.fromkeys(COLUMNS, len(log))
        assert table["left_x1"].tobytes() == log.column("left_x1").tobytes()
        assert table["right_omega_rad_s"].tobytes() == log.omega("right").tobytes()
        assert set(table["kick"]) == set(KICK_NAMES)
        assert table["state"][0] == "idle"
        assert table["tick"].dtype == np.int64


def test_an_export_replaces_what_was_there(log, tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("x" * 10**7)
    log.to_csv(path)
    assert path.stat().st_size < 10**6


def test_a_log_without_ticks_has_its_names(log, tmp_path):
    empty = type(log)()
    assert empty.to_csv(tmp_path / "log.csv").read_text() == PROMISED + "\n"
    with np.load(empty.to_npz(tmp_path / "log.npz")) as table:
        assert len(table["left_x1"]) == 0


def test_a_table_has_the_ending_of_its_kind(log, tmp_path):
    """Also one that is written from Python; without an ending, or in capitals, it is accepted."""
    for write, ending in (
        (log.to_csv, "csv"),
        (log.to_npz, "npz"),
        (log.to_parquet, "parquet"),
    ):
        for name in ("a.txt", "a.csv" if ending == "npz" else "a.npz", "a.xlsx", "a.v2"):
            with pytest.raises(LogError, match=rf"end its name with \.{ending}"):
                write(tmp_path / name)
        assert list(tmp_path.iterdir()) == []
        for name in ("a", f"a.{ending.upper()}", f"a.v2.{ending}"):
            assert write(tmp_path / name).stat().st_size > 0
            assert write(tmp_path / name).stat().st_size > 0  # a cell that runs twice
        for path in tmp_path.iterdir():
            path.unlink()
