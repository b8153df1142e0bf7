"""How late ticks begin on the desk robot, beside what else a machine has to do.

`python -m tests.bench_jitter 120` measures for 120 s in each case, instead of 30 s.
"""

import itertools
import multiprocessing
import os
import random
import re
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

from host.client.robot import connect
from host.logs.log import Log
from robot.params import TABLE
from robot.schedule import WATCHDOG_PRIORITY, take_priority
from tests.deploy.brick import SSHD, Brick

SECONDS = 30.0
TICK_S = TABLE["tick_s"].default
KICKS = 40
PARTS = (("median", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("at most", 1.0))
# The goals for p99.9 (ms) with real-time priority.
GOALS_MS = {"loaded": 1.0, "beside sshd, which sends a file": 3.0}
FILE_BYTES = 1 << 26
# The robot's program, but Python looks for garbage whenever it likes.
OWN_COLLECTOR = """
from robot import schedule
schedule.Collector.__init__ = schedule.Collector.serve = lambda *_: None
from sim_motor.__main__ import main
main()
"""


class _NoPriority(Exception):
    """This user may have no real-time priority."""


def schedules(seconds: float = SECONDS) -> None:
    """Print how late ticks begin, by processors, load and priority, and how long kicks take."""
    everywhere = os.sched_getaffinity(0)
    for cores, (load, burden), priority in itertools.product(
        (everywhere, {min(everywhere)}),
        (("idle", _nothing), ("loaded", _burn), ("beside sshd, which sends a file", _send_file)),
        (True, False),
    ):
        if burden is _send_file and (len(cores) > 1 or SSHD is None):
            continue
        title = f"{len(cores)} core{'s' * (len(cores) > 1)}, {load}"
        title += f", with{'' if priority else 'out'} real-time priority"
        try:
            with burden(cores), _waiting(cores, priority) as waits:
                late, kicks, missed = _desk_robot(cores, seconds, priority)
        except _NoPriority as reason:
            print(f"real time, {title}: not tried: {reason}", flush=True)
            continue
        _show(title, late, missed, GOALS_MS.get(load), waits)
        print(
            "  kick, from command to the beginning of its tick: median"
            f" {1000 * statistics.median(kicks):.1f} ms, at most {1000 * max(kicks):.1f} ms"
            f" ({len(kicks)} kicks; the tick is 30 ms)",
            flush=True,
        )


def collector(seconds: float = SECONDS) -> None:
    """Print how late ticks begin if the robot says when to look for garbage, and if Python does."""
    for title, program in (
        ("collected between ticks", ["-m", "sim_motor"]),
        ("collected by Python itself", ["-c", OWN_COLLECTOR]),
    ):
        late, _, missed = _desk_robot(os.sched_getaffinity(0), seconds, None, program)
        _show(f"garbage {title}", late, missed)


def _show(title, late, missed, goal_ms=None, waits=()):
    """Print a row. Its verdict needs to know how late a program is that only waits."""
    parts = _parts(late)
    verdict = ""
    if waits:
        machine_ms = _parts(waits)["p99.9"]
        verdict = f" (a program that only waits: p99.9 {machine_ms:.2f})"
        if goal_ms is not None:
            word = "PASS" if parts["p99.9"] <= goal_ms else "FAIL"
            if word == "FAIL" and machine_ms > goal_ms:
                word = "UNDECIDED, the machine is late by itself"
            verdict += f" ({word}: p99.9 at most {goal_ms:g})"
    print(
        f"real time, {title}: ticks begin late by"
        f" {', '.join(f'{name} {late:.2f}' for name, late in parts.items())} ms{verdict};"
        f" {len(late)} ticks, {missed} deadlines missed, load average {os.getloadavg()[0]:.1f}",
        flush=True,
    )


def _parts(late):
    """The PARTS of times in s, in ms."""
    late_ms = [1000.0 * late_s for late_s in sorted(late)]
    return {name: late_ms[min(len(late) - 1, int(part * len(late)))] for name, part in PARTS}


@contextmanager
def _waiting(cores, priority):
    """A list: how late a program woke that only waits, s. Empty without real-time priority.

    It comes before the robot and all else on these processors, so this is the machine's own doing.
    """
    waits = []
    if not priority:
        yield waits
        return
    ours, theirs = multiprocessing.Pipe()
    waiter = multiprocessing.Process(target=_wait, args=(theirs,), daemon=True)
    waiter.start()
    try:
        os.sched_setaffinity(waiter.pid, cores)
        yield waits
        ours.send("enough")
        waits += ours.recv()
    finally:
        waiter.terminate()


def _wait(link):
    take_priority(WATCHDOG_PRIORITY + 1)
    late, due = [], time.monotonic()
    while not link.poll():
        due += TICK_S
        time.sleep(max(0.0, due - time.monotonic()))
        late.append(time.monotonic() - due)
    link.send(late)


@contextmanager
def _nothing(cores):
    yield


@contextmanager
def _burn(cores):
    """A busy loop on each of these processors."""
    burners = [multiprocessing.Process(target=_work, daemon=True) for _ in cores]
    try:
        for burner in burners:
            burner.start()
            os.sched_setaffinity(burner.pid, cores)
        yield
    finally:
        for burner in burners:
            burner.terminate()


def _work():
    while True:
        pass


@contextmanager
def _send_file(cores):
    """An sshd on these processors, from which another processor, if there is one, copies a file."""
    everywhere = os.sched_getaffinity(0)
    with tempfile.TemporaryDirectory() as folder:
        brick = Brick(Path(folder))
        (brick.home / "file").write_bytes(os.urandom(FILE_BYTES))
        os.sched_setaffinity(0, cores)  # sshd inherits it
        try:
            brick.boot()
        finally:
            os.sched_setaffinity(0, everywhere)
        ssh = ["ssh", "-F", str(brick.ssh_config), "brick", "while :; do cat file; done"]
        try:
            with subprocess.Popen(ssh, stdout=subprocess.PIPE) as copying:
                os.sched_setaffinity(copying.pid, everywhere - cores or cores)
                drain = multiprocessing.Process(target=_drain, args=(copying.stdout,), daemon=True)
                drain.start()
                try:
                    yield
                finally:
                    copying.terminate()
                    drain.terminate()
        finally:
            brick.shut_down()


def _drain(pipe):
    while pipe.read(1 << 16):
        pass


def _desk_robot(cores, seconds, priority, program=("-m", "sim_motor")):
    """How late each tick began, how long each kick took to its tick (s), and missed deadlines.

    priority: whether the robot has real-time priority; None: if it may.
    """
    with tempfile.TemporaryDirectory() as folder:
        token = str(Path(folder) / "token")
        command = [sys.executable, *program, "--port", "0", "--seed", "1", "--token", token]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as brick:
            try:
                os.sched_setaffinity(brick.pid, cores)
                uri = re.search(r"tcp://\S+", brick.stdout.readline())[0]
                with connect(uri, token=token) as robot:
                    if priority and not robot.status()["real_time"]:
                        raise _NoPriority("run it as root, or raise `ulimit -r`")
                    if priority is False:
                        os.sched_setscheduler(brick.pid, os.SCHED_OTHER, os.sched_param(0))
                    robot.set(link_loss_s=10.0)  # this host may have to wait for its turn
                    log = Log(robot.info())
                    robot.add_tap(log)
                    robot.wait(1.0)
                    kicks = [_kick_latency(robot, log) for _ in range(KICKS)]
                    first = len(log)
                    robot.wait(seconds)
            finally:
                brick.terminate()
    records = log.records[first:]
    return [record.late_s for record in records], kicks, sum(record.missed for record in records)


def _kick_latency(robot, log) -> float:
    """From sending a kick to the beginning of its tick, s, by this machine's clock."""
    asked = time.monotonic()
    clock_s = robot.status()["clock_s"]
    sent = time.monotonic()
    offset = (asked + sent) / 2 - clock_s
    tick = robot.kick("membrane")
    robot.wait(5.0, until=lambda: log.records[-1].tick >= tick)
    begin_s = next(record.t_s for record in reversed(log.records) if record.tick == tick)
    time.sleep(0.2 + random.uniform(0.0, 0.03))  # at any moment between two ticks
    return begin_s + offset - sent


if __name__ == "__main__":
    schedules(*map(float, sys.argv[1:2]))
    collector(*map(float, sys.argv[1:2]))
