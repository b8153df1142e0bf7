"""What many hosts cost the robot: one drives and kicks, all others watch.

`python -m tests.bench_storm 26` measures a class of 26 instead of a full robot.
"""

import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from host.client.robot import Robot
from host.link.addresses import make_link
from robot.token import load

SECONDS = 60.0
FEW, MANY = 7, 64
CPU_AT_MOST = 1.5
LATE_S = 0.01
CONNECTS_AT_MOST = 2.0


def many_hosts(many: int = MANY) -> None:
    """Print the robot's CPU time with many hosts against that with few, and what the driver saw."""
    few_s, before, *_ = _crowd(FEW, driver=False)
    many_s, lateness, kicks, connects = _crowd(many, driver=True)
    edges_s, per_minute = lateness["edges_s"], connects / many * 60.0 / SECONDS
    late, late_before = (
        sum(seen["counts"][edges_s.index(LATE_S) + 1 :]) for seen in (lateness, before)
    )
    print(
        f"{many} hosts, one of them driving, for {SECONDS:g} s: the robot's CPU time is"
        f" {_verdict(many_s / few_s, CPU_AT_MOST)} times that with {FEW} watchers"
        f" ({100 * many_s / SECONDS:.1f} % and {100 * few_s / SECONDS:.1f} % of a core);"
        f" {_verdict(per_minute, CONNECTS_AT_MOST)} connects per host and minute;"
        f" {late} of {sum(lateness['counts'])} ticks began late by more than {1000 * LATE_S:g} ms,"
        f" {lateness['missed']} deadlines were missed (with {FEW} watchers {late_before} and"
        f" {before['missed']})",
        flush=True,
    )
    print(
        "  the driver's kicks, from command to answer: median"
        f" {1000 * statistics.median(kicks):.1f} ms, at most {1000 * max(kicks):.1f} ms"
        f" ({len(kicks)} kicks)",
        flush=True,
    )


def _verdict(value: float, most: float) -> str:
    return f"{value:.2f} ({'PASS' if value <= most else 'FAIL'}: at most {most:g})"


def _crowd(hosts, driver):
    """(CPU time, punctuality, kick times, connects) of a robot with some hosts; times in s."""
    with tempfile.TemporaryDirectory() as folder:
        token = str(Path(folder) / "token")
        command = [sys.executable, "-m", "sim_motor", "--port", "0", "--seed", "1"]
        command += ["--token", token]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as brick:
            robots = []
            try:
                uri = re.search(r"tcp://\S+", brick.stdout.readline())[0]
                opens = []
                for number in range(hosts):
                    link = make_link(uri)
                    link.open = _counted(link.open, opens)
                    drives = driver and number == 0
                    robots.append(Robot(link, load(token) if drives else None, f"host {number}"))
                    robots[-1].wait(0.0)
                if driver:
                    robots[0].lease()
                time.sleep(2.0)
                return _minute(brick.pid, robots[0], driver, opens)
            finally:
                for robot in robots:
                    robot.close()
                brick.terminate()


def _minute(pid, robot, driver, opens):
    before, spent, end = robot.status(), _cpu_s(pid), time.monotonic() + SECONDS
    kicks = []
    while time.monotonic() < end:
        time.sleep(0.5)
        if driver:
            begin = time.monotonic()
            robot.kick("membrane")
            kicks.append(time.monotonic() - begin)
    spent, after = _cpu_s(pid) - spent, robot.status()
    counts = [
        new - old
        for new, old in zip(after["lateness"]["counts"], before["lateness"]["counts"], strict=True)
    ]
    lateness = {
        "edges_s": after["lateness"]["edges_s"],
        "counts": counts,
        "missed": after["missed"] - before["missed"],
    }
    return spent, lateness, kicks, len(opens)


def _counted(call, calls):
    def counted():
        calls.append(time.monotonic())
        return call()

    return counted


def _cpu_s(pid):
    """The CPU time that a process has taken, s."""
    return int(Path(f"/proc/{pid}/schedstat").read_text().split()[0]) / 1e9


if __name__ == "__main__":
    many_hosts(*map(int, sys.argv[1:2]))
