"""Faults of the host's machine: a full disk, and a wall clock that jumps."""

import os
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

from host.logs.log import Log
from robot.params import TABLE
from tests.live import PORTS
from tests.sysfs.mount import ROOT

TICK_S = TABLE["tick_s"].default
JUMP_S = 86400


def _kickctl(live, *arguments, **options):
    """A kickctl of its own on the robot; it records."""
    command = [sys.executable, "-m", "host", "--brick", live.address, *arguments]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=60, **options
    )


@contextmanager
def _small_disk(kilobytes):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(
            ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", folder], check=True
        )
        try:
            yield Path(folder)
        finally:
            subprocess.run(["umount", "-l", folder], check=True)


def fill_disk(live, chance):
    live.run(chance)
    with _small_disk(24) as folder, live.watch() as watch:
        done = _kickctl(live, "record", "30", "--out", str(folder / "log.mcap"))
        assert watch.running() == len(PORTS)
        assert "Traceback" not in done.stderr, (
            "a traceback: " + done.stderr.strip().splitlines()[-1]
        )
        assert done.returncode == 1
        kept = Log.load(folder / "log.mcap")
        assert len(kept) > 1.0 / TICK_S / 2
        assert kept.missing() == []
    (reason,) = [line for line in done.stderr.splitlines() if line.startswith("kickctl: ")]
    return None, reason


def jumping_clock(folder):
    """The environment of a process whose wall clock jumps when the file $CLOCK_JUMP is written."""
    library, jump = folder / "clock_jump.so", folder / "jump"
    subprocess.run(
        ["gcc", "-shared", "-fPIC", "-o", library, ROOT / "tests" / "clock_jump.c"], check=True
    )
    jump.write_text("0", encoding="ascii")
    return {"LD_PRELOAD": str(library), "CLOCK_JUMP": str(jump)}


def turn_clock(live, chance):
    """Host and robot see a clock that jumps by a day, back and forth, several times a second."""
    live.robot.set(link_loss_s=10.0)  # a busy machine, too, keeps a host from speaking
    live.run(chance)
    jump = Path(live.environment["CLOCK_JUMP"])
    path = jump.with_name("log.mcap")
    environment = os.environ | live.environment
    with live.watch() as watch:
        command = [
            sys.executable,
            "-m",
            "host",
            "--brick",
            live.address,
            "record",
            "1.5",
            "--out",
            str(path),
        ]
        with subprocess.Popen(
            command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as recorder:
            while recorder.poll() is None:
                jump.write_text(str(chance.choice((-JUMP_S, 0, JUMP_S))), encoding="ascii")
                time.sleep(0.05)
                assert watch.running() == len(PORTS)
        assert recorder.returncode == 0
    log = Log.load(path)
    path.unlink()
    assert log.missing() == []
    assert {record.state for record in log.records} == {1}
    steps = [
        after.t_s - before.t_s for before, after in zip(log.records, log.records[1:], strict=False)
    ]
    assert 0.0 < min(steps) <= max(steps) < 10 * TICK_S
    return None, ""


def no_mounts():
    return "" if os.geteuid() == 0 else "only root may mount a small disk (tmpfs): sudo make faults"


def no_compiler():
    return (
        ""
        if shutil.which("gcc")
        else "there is no gcc to build the clock that jumps: apt-get install gcc"
    )
