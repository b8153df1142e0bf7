"""Faults of the motors, their cables and the battery."""

import time

from robot.params import TABLE
from tests.live import PORTS, open_files, wait_until

TICK_S = TABLE["tick_s"].default
FULL_V, EMPTY_V = 8.0, 4.0


def unplug(live, chance):
    live.run(chance)
    port = chance.choice(PORTS)
    first = len(live.log.events)
    with live.watch() as watch:
        since = time.monotonic()
        live.inject("unplug " + port)
        seconds = watch.stopped_after(since)
    reason = live.reason_of("fault", first)
    assert port in reason
    live.inject("replug " + port)
    return seconds, reason


def replug(permissions_s):
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
            live.robot.pump(TICK_S)
            refusals.append(live.refusal(live.robot.clear))
            assert time.monotonic() - since < 5.0, refusals[-1]
        seconds = time.monotonic() - since
        with live.watch() as watch:
            assert watch.running() == 0
        assert live.state() == "stopped"
        assert open_files(live.process.pid) == files
        return seconds, refusals[-2]

    return attempt


def disturb(times):
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
        reason = live.reason_of("fault", first)
        assert disturbed in reason
        time.sleep(3 * TICK_S)
        with live.watch([disturbed]) as watch:
            assert watch.running() == 0
        return seconds, reason

    return attempt


def empty_battery(live, chance):
    live.run(chance)
    try:
        with live.watch() as watch:
            since = time.monotonic()
            live.inject(f"battery {EMPTY_V}")
            seconds = watch.stopped_after(since)
        assert "is low" in live.reason_of("battery")
        return seconds, live.reason_of("stop")
    finally:
        live.inject(f"battery {FULL_V}")
