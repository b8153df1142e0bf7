"""What a body does is kept in files while it runs, in memory that its time does not fill."""

import csv
import errno
import json
import subprocess
import sys

import numpy as np
import pytest
from mcap.reader import make_reader

from host.bodies import keeping
from host.bodies.build import BodyRequest, build_body
from host.bodies.keeping import BLOCK, Keeper, ThinRows
from sim_motor.bodies.measures import summary
from tests.lint.sources import ROOT


def run(body, keeper, seconds):
    body.run(seconds, lambda time_s: keeper.note())
    keeper.finish()


def in_csv(path):
    with path.open(newline="", encoding="utf-8") as file:
        _, *rows = csv.reader(file)
    return np.array(rows, dtype=float)


@pytest.mark.parametrize("count", [1, BLOCK - 1, BLOCK, 2 * BLOCK + 7])
def test_every_state_is_kept_once_in_both_files(tmp_path, count):
    whole = build_body(BodyRequest())
    seconds = 0.005 * (count - 1)
    whole.run(seconds)
    body = build_body(BodyRequest(), keep=BLOCK)
    keeper = Keeper(tmp_path, body, {"seed": 1})
    run(body, keeper, seconds)
    assert len(body.rows) <= BLOCK
    rows = in_csv(tmp_path / "state.csv")
    assert len(rows) == count
    assert rows.tobytes() == whole.rows.tobytes() == keeper.rows().tobytes()
    with (tmp_path / "state.mcap").open("rb") as file:
        messages = [json.loads(item.data) for _, _, item in make_reader(file).iter_messages()]
    assert np.array([list(message.values()) for message in messages]).tobytes() == rows.tobytes()
    expected, found = summary(whole.columns, whole.rows), keeper.summary()
    assert {name: found.pop(name) for name in ("end", "reversals", "started_s")} == {
        name: expected.pop(name) for name in ("end", "reversals", "started_s")
    }
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-12)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["state.csv", "state.mcap"]


def test_files_appear_at_the_end(tmp_path):
    body = build_body(BodyRequest(), keep=BLOCK)
    keeper = Keeper(tmp_path, body, {})
    body.run(0.01 * BLOCK, lambda time_s: keeper.note())
    assert not (tmp_path / "state.csv").exists()
    keeper.finish()
    assert (tmp_path / "state.csv").exists()


def test_a_file_that_fails_leaves_what_was_there_and_the_other_goes_on(tmp_path, monkeypatch):
    (tmp_path / "state.csv").write_text("old")

    def full(self, rows):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(keeping.CsvStates, "add", full)
    body = build_body(BodyRequest(), keep=BLOCK)
    keeper = Keeper(tmp_path, body, {})
    run(body, keeper, 0.05)
    assert keeper.failures["state.csv"].filename == str(tmp_path / "state.csv")
    assert set(keeper.failures) == {"state.csv"}
    assert (tmp_path / "state.csv").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["state.csv", "state.mcap"]


def test_a_folder_that_is_not_there_is_a_failure_of_both_files(tmp_path):
    body = build_body(BodyRequest(), keep=BLOCK)
    keeper = Keeper(tmp_path / "nowhere", body, {})
    run(body, keeper, 0.05)
    assert set(keeper.failures) == {"state.csv", "state.mcap"}


@pytest.mark.parametrize("count", [1, 99, 100, 101, 1000, 12345])
def test_rows_for_a_figure_are_evenly_apart_and_few(monkeypatch, count):
    monkeypatch.setattr(keeping, "FIGURE_ROWS", 100)
    thin, rows = ThinRows(), np.arange(count, dtype=float)[:, None]
    for block in np.array_split(rows, max(1, count // 37)):
        thin.add(block)
    kept = thin.rows()[:, 0]
    assert len(kept) <= 101
    assert (kept[0], kept[-1]) == (0.0, count - 1)
    steps = np.diff(kept)
    assert np.all(steps[:-1] == steps[0]) if len(steps) > 1 else True
    assert count > 100 or len(kept) == count


# Copies of a process that has loaded MuJoCo, one for each time.
_MEASURE = """
import os, re, sys
from pathlib import Path
from host.bodies.build import BodyRequest, build_body
from host.bodies import keeping
from host.bodies.keeping import BLOCK, Keeper

keeping.FIGURE_ROWS = 1000
for count in map(int, sys.argv[2:]):
    if os.fork():
        assert os.wait()[1] == 0
        continue
    body = build_body(BodyRequest(cars=3), keep=BLOCK)
    keeper = Keeper(Path(sys.argv[1]), body, {})
    for _ in range(count):
        body._note()
        body.step += 1
        keeper.note()
    keeper.finish()
    print(re.search("VmHWM: *\\t* *([0-9]+) kB", Path("/proc/self/status").read_text())[1])
    break
"""


def test_memory_does_not_grow_with_the_time(tmp_path):
    """12 000 states of three cars would take 6 MB as they are, and twice that as rows."""
    command = [sys.executable, "-c", _MEASURE, str(tmp_path), "2000", "14000"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    first_kb, second_kb = map(int, done.stdout.split())
    assert second_kb - first_kb < 3000
