"""How long commands take in a first process on a machine, which compiles, and in a second one."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# With this seed `drive` needs the kick map: the wheels do not begin to spin to the left.
COMMANDS = (
    ("experiment reliability", "experiment", "reliability", "--out", "runs"),
    ("drive spin-left, no map kept", "drive", "spin-left", "--seed", "3"),
    ("theory hopf", "theory", "hopf", "--out", "runs"),
    ("theory portrait", "theory", "portrait", "--out", "runs"),
)


def starts() -> None:
    """Each command twice, with compiled code that is kept between them and nothing else."""
    for title, *command in COMMANDS:
        with tempfile.TemporaryDirectory() as compiled:
            (cold_s, cold_cpu_s), (warm_s, warm_cpu_s) = (_run(command, compiled) for _ in range(2))
        print(
            f"{title}: {cold_s:.1f} s cold, {warm_s:.1f} s warm, {cold_s / warm_s:.1f} times faster"
            f" (on the processor {cold_cpu_s:.1f} s, {warm_cpu_s:.1f} s)",
            flush=True,
        )


def _run(command: list[str], compiled: str) -> tuple[float, float]:
    """(time, processor time) in s of a command in an empty folder."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "NUMBA_CACHE_DIR": compiled, "XDG_CACHE_HOME": folder}
        environment["PYTHONPATH"] = str(Path(__file__).parents[1])
        before_s, used_s = time.perf_counter(), _used_s()
        subprocess.run(
            [sys.executable, "-m", "host", *command],
            check=True,
            cwd=folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        return time.perf_counter() - before_s, _used_s() - used_s


def _used_s() -> float:
    """Processor time (s) of all processes that this one has waited for."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
