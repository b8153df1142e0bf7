"""`make bench-arm`: what a tick, the imports and the start cost on the brick's processor.

docs/arm.md explains the numbers.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.bench_arm.emulator import ROOT, Emulator, Mark, Unavailable
from tests.bench_arm.tick import TICKS
from tests.bench_arm.ways import make_tree

RATIO_AT_MOST, TICK_MS_AT_MOST = 0.7, 4.0

# How an instruction here becomes time on the brick; docs/arm.md has the sources.
CLOCK_HZ = 300e6
CYCLES, FEWEST_CYCLES, MOST_CYCLES = 13.0, 10.5, 15.7
TICK_PYTHON35 = 1.6


def main() -> int:
    """Print everything. Returns the exit status."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder, "class")
        make_tree(tree)
        robot = (
            "-m",
            "robot",
            "--idle",
            "--host",
            "127.0.0.1",
            "--port",
            "0",
            "--token",
            f"{folder}/token",
            "--sysfs",
            str(tree),
        )
        try:
            emulator = Emulator(Path(folder))
            emulator.until_line(*robot)  # leaves .pyc files behind, as the deploy does
            bare, imported = (
                emulator.run("-c", f"{what}print(1)")[0]
                for what in ("", "import robot.__main__, robot.ev3\n")
            )
            ticks = emulator.run("-m", "tests.bench_arm.tick", str(tree))
            ready = emulator.until_line(*robot)
        except Unavailable as reason:
            print(f"make bench-arm: {reason}", file=sys.stderr)
            return 1
        rss_mb = _memory(robot)
    _show_tick(*ticks)
    print(f"imports of the robot's program: {_start(imported.instructions - bare.instructions)}")
    print(f"start to READY, the interpreter's own start included: {_start(ready.instructions)}")
    print(
        f"memory: {rss_mb:.1f} MB resident on this machine, whose pointers are twice as wide as the"
        " brick's"
    )
    return 0


def _show_tick(ours_begin: Mark, ours_end: Mark, library_begin: Mark, library_end: Mark) -> None:
    ours, library = (
        ((end.instructions - begin.instructions) / TICKS, (end.calls - begin.calls) / TICKS)
        for begin, end in ((ours_begin, ours_end), (library_begin, library_end))
    )
    print(f"whole tick through robot.ev3: {ours[0]:,.0f} instructions, {ours[1]:.0f} system calls")
    print(
        f"whole tick through python-ev3dev2's properties: {library[0]:,.0f} instructions,"
        f" {library[1]:.0f} system calls"
    )
    ratio = ours[0] / library[0]
    print(f"ratio: {ratio:.2f} ({_verdict(ratio <= RATIO_AT_MOST)}: at most {RATIO_AT_MOST})")
    milliseconds = [
        1000 * ours[0] * TICK_PYTHON35 * cycles / CLOCK_HZ
        for cycles in (CYCLES, FEWEST_CYCLES, MOST_CYCLES)
    ]
    verdict = _verdict(milliseconds[0] <= TICK_MS_AT_MOST)
    print(
        "estimate for the brick: {:.1f} ms a tick, {:.1f} to {:.1f}".format(*milliseconds),
        f"({verdict}: at most {TICK_MS_AT_MOST})",
    )


def _verdict(met: bool) -> str:
    return "PASS" if met else "FAIL"


def _start(instructions: float) -> str:
    seconds = (instructions * cycles / CLOCK_HZ for cycles in (CYCLES, FEWEST_CYCLES, MOST_CYCLES))
    return "{:.0f} million instructions, about {:.1f} s on the brick, {:.1f} to {:.1f}".format(
        instructions / 1e6, *seconds
    )


def _memory(arguments: tuple[str, ...]) -> float:
    """What the robot's process keeps in memory (MB) when it is READY, on this machine."""
    with subprocess.Popen(
        [sys.executable, *arguments], cwd=ROOT, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            process.stdout.readline()
            status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
        finally:
            process.terminate()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024


if __name__ == "__main__":
    sys.exit(main())
