"""`make bench-arm`: what ticks, hosts and a start cost on the brick's processor.

docs/arm.md explains the numbers. PYTHON_ARM=... names the Python that is counted.
"""

import re
import subprocess
import sys
import tempfile
from collections import defaultdict
from itertools import dropwhile, pairwise
from pathlib import Path
from statistics import mean

from host.client.lasting_link import HEARTBEAT_S
from robot.params import TABLE
from tests.bench_arm.emulator import ROOT, Emulator, Mark, Unavailable
from tests.bench_arm.tick import TICKS
from tests.bench_arm.ways import make_tree

# How an instruction here becomes time on the brick; docs/arm.md has the sources.
CLOCK_HZ = 300e6
CYCLES, FEWEST_CYCLES, MOST_CYCLES = 13.0, 10.5, 15.7
# Goals in ms, for the brick's own Python alone; a share of the processor in %.
BRICKS_PYTHON = "3.5."
TICK_MS, RECORDS_MS, BEAT_MS, ANSWER_MS, READY_MS, SHARE = 4.5, 1.5, 4.0, 10.0, 5000.0, 35.0
TICK_S = TABLE["tick_s"].default
# As robot/service/brick.sh starts it.
PROGRAM = "import gc; gc.disable(); from robot.__main__ import main; raise SystemExit(main())"


def main() -> int:
    """Print everything. Returns the exit status."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder, "class")
        make_tree(tree)
        robot = f"--idle --host 127.0.0.1 --port 0 --token {folder}/token --sysfs {tree}"
        arguments = ["-c", PROGRAM, *robot.split()]
        try:
            emulator = Emulator(Path(folder))
            version = emulator.run("-c", "import sys; print(sys.version.split()[0])")[0].line
            emulator.run("-m", "robot.compile")  # as deploy does
            emulator.until_line("-S", *arguments)  # leaves the other .pyc files behind
            bare = emulator.run("-c", "print(1)")[0]
            ticks = emulator.run("-m", "tests.bench_arm.tick", str(tree))
            hosts = emulator.run("-m", "tests.bench_arm.hosts", str(tree))
            ready = emulator.until_line("-S", *arguments)
        except Unavailable as reason:
            print(f"make bench-arm: {reason}", file=sys.stderr)
            return 1
        rss_mb = _memory(arguments)
    show = Show(version)
    tick = _show_ticks(show, ticks)
    _show_hosts(show, tick, _stretches(hosts))
    show.work("the interpreter's own start", bare.instructions)
    show.work("start to READY", ready.instructions, READY_MS)
    print(
        f"memory: {rss_mb:.1f} MB resident on this machine, whose pointers are twice as wide as the"
        " brick's"
    )
    return 0


class Show:
    """Prints the rows, with a verdict if it is the brick's Python that was counted."""

    def __init__(self, version: str) -> None:
        print(f"Python {version} on an emulated ARM926, with estimates for the brick")
        self._judges = version.startswith(BRICKS_PYTHON)
        if not self._judges:
            print("the brick's Python 3.5 takes about 1.6 times as much: PYTHON_ARM=... names one")

    def work(self, what: str, instructions: float, goal_ms: float | None = None) -> None:
        """A row of instructions."""
        ms, least, most = (
            _milliseconds(instructions, cycles) for cycles in (CYCLES, FEWEST_CYCLES, MOST_CYCLES)
        )
        bounds = f"{ms:,.1f} ms ({least:,.1f} to {most:,.1f})"
        self._print(f"{what}: {instructions:,.0f} instructions, {bounds}", ms, goal_ms, "ms")

    def share(self, what: str, share: float, goal: float) -> None:
        """A row of percent."""
        self._print(f"{what}: {share:.0f} %", share, goal, "%")

    def _print(self, text: str, value: float, goal: float | None, unit: str) -> None:
        if self._judges and goal is not None:
            text += f"; {'PASS' if value <= goal else 'FAIL'}: at most {goal:g} {unit}"
        print(text)


def _show_ticks(show: Show, marks: list[Mark]) -> float:
    """Print what a tick costs in both ways. Returns the instructions of one through robot.ev3."""
    ours, library = (
        ((end.instructions - begin.instructions) / TICKS, (end.calls - begin.calls) / TICKS)
        for begin, end in (marks[:2], marks[2:])
    )
    show.work(f"whole tick, {ours[1]:.0f} system calls", ours[0], TICK_MS)
    show.work(f"the same through python-ev3dev2's properties, {library[1]:.0f} calls", library[0])
    return ours[0]


def _stretches(marks: list[Mark]) -> dict[str, float]:
    """The mean instructions of each stretch by its name, without those of printing its edges."""
    spent = defaultdict(list)
    counted = list(dropwhile(lambda mark: mark.line != "warm", marks))[1:]
    for begin, end in pairwise(counted):
        name, edge = end.line.split()
        if edge == "end":
            spent[name].append(end.instructions - begin.instructions)
    nothing = mean(spent.pop("nothing"))
    return {name: mean(each) - nothing for name, each in spent.items()}


def _show_hosts(show: Show, tick: float, spent: dict[str, float]) -> None:
    records = spent["records"] - spent["idle"]
    beat, hello, auth, status = (
        spent[name] - spent["again"] for name in ("beat", "hello", "auth", "status")
    )
    show.work("serving nobody between two ticks", spent["idle"])
    show.work("records to one host, mean of a tick", records, RECORDS_MS)
    show.work("a heartbeat", beat, BEAT_MS)
    show.work("HELLO", hello, ANSWER_MS)
    show.work("AUTH", auth, ANSWER_MS)
    show.work("status", status, ANSWER_MS)
    whole = tick + spent["idle"] + records + beat * TICK_S / HEARTBEAT_S
    show.share(
        f"the processor with a host that drives and records, at ticks of {1000 * TICK_S:.0f} ms",
        _milliseconds(whole) / (10.0 * TICK_S),
        SHARE,
    )


def _milliseconds(instructions: float, cycles: float = CYCLES) -> float:
    return 1000.0 * instructions * cycles / CLOCK_HZ


def _memory(arguments: list[str]) -> float:
    """What the robot's process keeps in memory (MB) when it is READY, on this machine."""
    with subprocess.Popen(
        [sys.executable, *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    ) as process:
        try:
            process.stdout.readline()
            status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii")
        finally:
            process.terminate()
    return int(re.search(r"VmRSS:\s+(\d+) kB", status)[1]) / 1024


if __name__ == "__main__":
    sys.exit(main())
