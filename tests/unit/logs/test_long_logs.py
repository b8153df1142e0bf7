"""Long logs are replayed, exported and recovered as a stream: their length takes no memory."""

import os
import subprocess
import sys

import pytest

from host.logs.mcap_files import McapTap
from tests.fakes import Rig
from tests.lint.sources import ROOT

# Of a log of 10 hours, which has 1.2 million ticks, whole columns in memory would take 200 MB, and
# records 800 MB.
TICKS = 6000
SHORT, LONG = 2, 10
# What the index of a file may take for each tick: a place for every second.
BYTES_PER_TICK = 60

# The peak of a process never falls: one process that reads both logs shows what the longer adds.
# getrusage would count the process that started this one, too.
_MEASURE = """
import re, sys
from pathlib import Path
from host.logs.mcap_reading import LogFile
from host.logs.recovery import recover
from host.logs.replay import replay
from host.logs.parquet import save_parquet
from host.logs.tables import save_csv, save_npz

for path in sys.argv[2:]:
    log, out = LogFile(path), Path(Path(path).stem)
    {
        "replay": lambda: replay(log),
        "csv": lambda: save_csv(log.stream(), out),
        "npz": lambda: save_npz(log.stream(), log.info, out),
        "parquet": lambda: save_parquet(log.stream(), log.info, out),
        "recover": lambda: recover(log.path, out),
    }[sys.argv[1]]()
    print(re.search("VmHWM: *\\t* *([0-9]+) kB", Path("/proc/self/status").read_text())[1])
"""


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    """Two logs, of SHORT and LONG times the ticks."""
    rig = Rig()
    rig.loop.start()
    rig.run(TICKS)
    once = rig.log()
    paths = []
    for times in (SHORT, LONG):
        paths.append(tmp_path_factory.mktemp("logs") / f"{times}.mcap")
        with McapTap(paths[-1], {}) as tap:
            for _ in range(times):
                once.play(tap)
                tap.take_event({"event": "restart", "tick": 0})
    return paths


@pytest.mark.parametrize("work", ["replay", "csv", "npz", "parquet", "recover"])
def test_memory_does_not_grow_with_the_log(logs, tmp_path, work):
    done = subprocess.run(
        [sys.executable, "-c", _MEASURE, work, *logs],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    short_kb, long_kb = map(int, done.stdout.split())
    more = (LONG - SHORT) * TICKS
    assert (long_kb - short_kb) * 1024 < BYTES_PER_TICK * more
    assert short_kb < 200 * 1024
