"""What can go wrong with a running robot.

How each fault is brought about, how long the motors may run on, what the host is told.
"""

import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from host.logs.log import Log
from robot import wire
from robot.params import TABLE
from robot.watchdog import MOST_UNANSWERED
from tests.live import PORTS, open_files, wait_until
from tests.sysfs.mount import ROOT

LOOP_S = 0.25
TICK_S = TABLE["tick_s"].default
LINK_LOSS_S = TABLE["link_loss_s"].default
UNANSWERED_S = MOST_UNANSWERED * TICK_S
FAST_TICK_S = 0.01
BATTERY_S = 300 * FAST_TICK_S  # the battery is read so rarely
FULL_V, EMPTY_V = 8.0, 4.0
JUMP_S = 86400
LOST = "lost for 0.5 s"


class Row(NamedTuple):
    """A fault.

    attempt(live, chance) brings it about once. Returns how long the motors ran on in s, None where
    they are to go on, and what the host was told, in which `words` must stand. program and
    arguments are the robot's; a `lasting` one serves all tries, else each has its own; the link to
    a `relayed` one can be cut. lacks() is what this machine lacks for the row, in words, and
    environment(folder) what the robot's process gets besides.
    """

    name: str
    limit_s: float | None
    words: str
    attempt: Callable
    program: str = "robot"
    arguments: tuple = ()
    lasting: bool = False
    relayed: bool = False
    lacks: Callable = lambda: ""
    environment: Callable = lambda folder: {}


def _dies(number):
    """The loop's process ends by a signal."""

    def attempt(live, chance):
        live.run(chance)
        with live.watch() as watch:
            since = time.monotonic()
            live.process.send_signal(number)
            seconds = watch.stopped_after(since)
        return seconds, live.refusal(live.robot.status)

    return attempt


def _silent(number, wakes):
    """The loop is silent, and finds itself stopped when it goes on.

    Once that is cleared, all is as before.
    """

    def attempt(live, chance):
        live.run(chance)
        with live.watch() as watch:
            since = time.monotonic()
            live.process.send_signal(number)
            seconds = watch.stopped_after(since)
            if wakes:
                assert "does not answer" in live.refusal(live.robot.status)
                live.process.send_signal(signal.SIGCONT)
            told = live.told("fault")
            assert watch.running() == 0
        live.robot.clear()
        live.run(chance)
        return seconds, told

    return attempt


def _crashes(live, chance):
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        live.process.send_signal(signal.SIGUSR2)
        seconds = watch.stopped_after(since)
    told = live.told("fault")
    assert live.process.wait(5.0) == 1
    return seconds, told


def _loses_watchdog(live, chance):
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        os.kill(live.watchdog, signal.SIGKILL)
        seconds = watch.stopped_after(since)
    return seconds, live.told("fault")


def _freezes_watchdog(live, chance):
    """And the program still ends when it is told to."""
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        os.kill(live.watchdog, signal.SIGSTOP)
        seconds = watch.stopped_after(since)
    told = live.told("fault")
    live.process.terminate()
    assert live.process.wait(5.0) == 0
    return seconds, told


def _loses_link(policy):
    """No byte passes between host and robot for a while; then they go on."""

    def attempt(live, chance):
        live.robot.lease()
        live.robot.set(link_loss=policy)
        live.run(chance)
        first = len(live.log.events)
        with live.watch() as watch:
            since = time.monotonic()
            live.relay.silent = True
            try:
                if policy == "continue":
                    time.sleep(LINK_LOSS_S + LOOP_S)
                    assert watch.running() == len(PORTS)
                    seconds = None
                else:
                    seconds = watch.stopped_after(since)
            finally:
                live.relay.silent = False
            told = live.told("link_loss", first)
            state = live.state()
            assert state == {"stop": "stopped", "hold": "held", "continue": "running"}[policy], (
                state
            )
            live.robot.lease()
            assert live.state() == {"stop": "stopped"}.get(policy, "running")
        return seconds, told

    return attempt


_HOLDER = """
import sys, time
from host.client.robot import connect
with connect(sys.argv[1], name="killed host") as robot:
    robot.lease()
    robot.set(link_loss="stop")
    print("ready", flush=True)
    time.sleep(3600)
"""


def _loses_host(live, chance):
    live.run(chance)
    live.robot.release()
    first = len(live.log.events)
    with (
        subprocess.Popen(
            [sys.executable, "-c", _HOLDER, live.address], cwd=ROOT, stdout=subprocess.PIPE
        ) as host,
        live.watch() as watch,
    ):
        try:
            host.stdout.readline()
            time.sleep(chance.uniform(0.1, 0.4))
            assert watch.running() == len(PORTS)
        finally:
            since = time.monotonic()
            host.kill()
        seconds = watch.stopped_after(since)
    told = live.told("link_loss", first)
    assert "killed host" in told
    return seconds, told


def _hears_stranger(live, chance):
    """Somebody without token or greeting sends a stop frame."""
    live.run(chance)
    first = len(live.log.events)
    with (
        live.watch() as watch,
        socket.create_connection(("127.0.0.1", int(live.address.rpartition(":")[2]))) as stranger,
    ):
        time.sleep(chance.uniform(0.0, 2 * TICK_S))
        since = time.monotonic()
        stranger.sendall(wire.encode(wire.STOP, b""))
        seconds = watch.stopped_after(since)
    return seconds, live.told("stop", first)


def _cable_out(live, chance):
    live.run(chance)
    port = chance.choice(PORTS)
    first = len(live.log.events)
    with live.watch() as watch:
        since = time.monotonic()
        live.inject("unplug " + port)
        seconds = watch.stopped_after(since)
    told = live.told("fault", first)
    assert port in told
    live.inject("replug " + port)
    return seconds, told


def _cable_back(permissions_s):
    """Time until `clear` finds the motor that was plugged in again; nothing may turn before."""

    def attempt(live, chance):
        live.run(chance)
        files = open_files(live.process.pid)
        port = chance.choice(PORTS)
        with live.watch() as watch:
            live.inject("unplug " + port)
            watch.stopped_after(0.0)
        wait_until(lambda: live.state() == "fault", "the fault")
        refusals = [live.refusal(live.robot.clear)]
        assert "there is none" in refusals[0]
        since = time.monotonic()
        live.inject(f"replug {port} {permissions_s}")
        while refusals[-1]:
            refusals.append(live.refusal(live.robot.clear))
            assert time.monotonic() - since < 5.0, refusals[-1]
        seconds = time.monotonic() - since
        with live.watch() as watch:
            assert watch.running() == 0
        assert live.state() == "stopped"
        assert open_files(live.process.pid) == files
        return seconds, refusals[-2]

    return attempt


def _eio(times):
    """The kernel fails some accesses to one motor's files.

    The other one is watched, for a look would be such an access.
    """

    def attempt(live, chance):
        live.run(chance)
        disturbed, other = chance.sample(PORTS, 2)
        first = len(live.log.events)
        with live.watch([other]) as watch:
            since = time.monotonic()
            live.inject(f"eio {disturbed} {times}")
            seconds = watch.stopped_after(since)
        told = live.told("fault", first)
        assert disturbed in told
        time.sleep(3 * TICK_S)
        with live.watch([disturbed]) as watch:
            assert watch.running() == 0
        return seconds, told

    return attempt


def _battery_empties(live, chance):
    live.run(chance)
    try:
        with live.watch() as watch:
            since = time.monotonic()
            live.inject(f"battery {EMPTY_V}")
            seconds = watch.stopped_after(since)
        assert "is low" in live.told("battery")
        return seconds, live.told("stop")
    finally:
        live.inject(f"battery {FULL_V}")


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


def _disk_full(live, chance):
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
    return None, done.stderr.strip().splitlines()[-2]


def jumping_clock(folder):
    """The environment of a process whose wall clock jumps whenever the file $CLOCK_JUMP is written."""
    library, jump = folder / "clock_jump.so", folder / "jump"
    subprocess.run(
        ["gcc", "-shared", "-fPIC", "-o", library, ROOT / "tests" / "clock_jump.c"], check=True
    )
    jump.write_text("0", encoding="ascii")
    return {"LD_PRELOAD": str(library), "CLOCK_JUMP": str(jump)}


def _clock_jumps(live, chance):
    """Host and robot see a clock that jumps by a day, back and forth, several times a second."""
    live.robot.lease()
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


def _no_mounts():
    return "" if os.geteuid() == 0 else "only root may mount a small disk (tmpfs): sudo make faults"


def _no_compiler():
    return (
        ""
        if shutil.which("gcc")
        else "there is no gcc to build the clock that jumps: apt-get install gcc"
    )


ROWS = (
    Row("SIGKILL of the loop", LOOP_S, "no robot's program runs", _dies(signal.SIGKILL)),
    Row("SIGSEGV of the loop", LOOP_S, "no robot's program runs", _dies(signal.SIGSEGV)),
    Row("SIGSTOP of the loop", LOOP_S, "the loop was silent", _silent(signal.SIGSTOP, wakes=True)),
    Row(
        "hang in the loop",
        LOOP_S,
        "the loop was silent",
        _silent(signal.SIGUSR1, wakes=False),
        program="tests.faulty",
    ),
    Row("crash in Python", LOOP_S, "ZeroDivisionError", _crashes, program="tests.faulty"),
    Row("watchdog killed", LOOP_S, "the watchdog has ended", _loses_watchdog),
    Row(
        "watchdog frozen", UNANSWERED_S + LOOP_S, "the watchdog does not answer", _freezes_watchdog
    ),
    Row(
        "link cut, policy stop",
        LINK_LOSS_S + LOOP_S,
        LOST,
        _loses_link("stop"),
        lasting=True,
        relayed=True,
    ),
    Row(
        "link cut, policy hold",
        LINK_LOSS_S + LOOP_S,
        LOST,
        _loses_link("hold"),
        lasting=True,
        relayed=True,
    ),
    Row(
        "link cut, policy continue", None, LOST, _loses_link("continue"), lasting=True, relayed=True
    ),
    Row("host killed", LINK_LOSS_S + LOOP_S, LOST, _loses_host, lasting=True),
    Row(
        "stop frame of a stranger", TICK_S, "stop frame from a peer", _hears_stranger, lasting=True
    ),
    Row("cable out", LOOP_S, "its cable came off", _cable_out, lasting=True),
    Row("cable back, then clear", None, "", _cable_back(0.3), lasting=True),
    Row(
        "permission race after replug",
        None,
        "may not command it yet",
        _cable_back(0.6),
        lasting=True,
    ),
    Row("EIO once", LOOP_S, "EIO", _eio(1), lasting=True),
    Row("EIO six times", LOOP_S, "EIO", _eio(6), lasting=True),
    Row(
        "battery empty",
        BATTERY_S + LOOP_S,
        "the battery is empty",
        _battery_empties,
        arguments=("--tick", str(FAST_TICK_S)),
    ),
    Row(
        "disk of the host full",
        None,
        "log.mcap cannot be written or read: No space left",
        _disk_full,
        lasting=True,
        lacks=_no_mounts,
    ),
    Row(
        "clock jump",
        None,
        "",
        _clock_jumps,
        lasting=True,
        lacks=_no_compiler,
        environment=jumping_clock,
    ),
)
