"""The table of faults: how each is caused, how long motors may run on, what the host hears."""

import signal
from collections.abc import Callable
from typing import NamedTuple

from robot.params import TABLE
from robot.watchdog import MOST_UNANSWERED
from tests.faults.hardware import disturb, empty_battery, replug, unplug
from tests.faults.host import fill_disk, jumping_clock, no_compiler, no_mounts, turn_clock
from tests.faults.links import cut_link, kill_host, send_stop_frame
from tests.faults.processes import (
    crash_loop,
    freeze_watchdog,
    kill_loop,
    kill_watchdog,
    silence_loop,
)

LOOP_S = 0.25
TICK_S = TABLE["tick_s"].default
LINK_LOSS_S = TABLE["link_loss_s"].default
UNANSWERED_S = MOST_UNANSWERED * TICK_S
FAST_TICK_S = 0.01
BATTERY_S = 300 * FAST_TICK_S  # the robot reads its battery once in 300 ticks
LOST = "was silent for 0.5 s"


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


ROWS = (
    Row("SIGKILL of the loop", LOOP_S, "no robot's program runs", kill_loop(signal.SIGKILL)),
    Row("SIGSEGV of the loop", LOOP_S, "no robot's program runs", kill_loop(signal.SIGSEGV)),
    Row(
        "SIGSTOP of the loop",
        LOOP_S,
        "the loop was silent",
        silence_loop(signal.SIGSTOP, wakes=True),
    ),
    Row(
        "hang in the loop",
        LOOP_S,
        "the loop was silent",
        silence_loop(signal.SIGUSR1, wakes=False),
        program="tests.faulty",
    ),
    Row("crash in Python", LOOP_S, "ZeroDivisionError", crash_loop, program="tests.faulty"),
    Row("watchdog killed", LOOP_S, "the watchdog has ended", kill_watchdog),
    Row("watchdog frozen", UNANSWERED_S + LOOP_S, "the watchdog does not answer", freeze_watchdog),
    Row(
        "link cut, policy stop",
        LINK_LOSS_S + LOOP_S,
        LOST,
        cut_link("stop"),
        lasting=True,
        relayed=True,
    ),
    Row(
        "link cut, policy hold",
        LINK_LOSS_S + LOOP_S,
        LOST,
        cut_link("hold"),
        lasting=True,
        relayed=True,
    ),
    Row("link cut, policy continue", None, LOST, cut_link("continue"), lasting=True, relayed=True),
    Row("host killed", LINK_LOSS_S + LOOP_S, LOST, kill_host, lasting=True),
    Row(
        "stop frame of a stranger",
        TICK_S,
        "somebody without a name stopped it",
        send_stop_frame,
        lasting=True,
    ),
    Row("cable out", LOOP_S, "its cable came off", unplug, lasting=True),
    Row("cable back, then clear", None, "", replug(0.3), lasting=True),
    Row(
        "permission race after replug",
        None,
        "may not command it yet",
        replug(0.6),
        lasting=True,
    ),
    Row("EIO once", LOOP_S, "EIO", disturb(1), lasting=True),
    Row("EIO six times", LOOP_S, "EIO", disturb(6), lasting=True),
    Row(
        "battery empty",
        BATTERY_S + LOOP_S,
        "the battery is empty",
        empty_battery,
        arguments=("--tick", str(FAST_TICK_S)),
    ),
    Row(
        "disk of the host full",
        None,
        "log.mcap cannot be written or read: No space left",
        fill_disk,
        lasting=True,
        lacks=no_mounts,
    ),
    Row(
        "clock jump",
        None,
        "",
        turn_clock,
        lasting=True,
        lacks=no_compiler,
        environment=jumping_clock,
    ),
)
