"""Long logs are replayed, exported and recovered as a stream: their length takes no memory."""

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

# getrusage would count the process that started this one, too.
_MEASURE = """
import re, sys
from pathlib import Path
from host.logs.mcap_reading import LogFile
from host.logs.recovery import recover
from host.logs.replay import replay
from host.logs.parquet import save_parquet
from host.logs.tables import save_csv, save_npz

log, out = LogFile(sys.argv[2]), Path(sys.argv[3])
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
    peaks_kb = []
    for number, path in enumerate(logs):
        command = [sys.executable, "-c", _MEASURE, work, str(path), str(tmp_path / str(number))]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
        peaks_kb.append(int(done.stdout))
    more = (LONG - SHORT) * TICKS
    assert (peaks_kb[1] - peaks_kb[0]) * 1024 < BYTES_PER_TICK * more
    assert peaks_kb[0] < 200 * 1024
