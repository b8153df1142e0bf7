"""Faults of the processes: the loop or the watchdog dies, crashes or falls silent."""

import os
import signal
import time


def kill_loop(number):
    """The loop's process ends by a signal."""

    def attempt(live, chance):
        live.run(chance)
        with live.watch() as watch:
            since = time.monotonic()
            live.process.send_signal(number)
            seconds = watch.stopped_after(since)
        return seconds, live.refusal(live.robot.status)

    return attempt


def silence_loop(number, wakes):
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
            reason = live.reason_of("fault")
            assert watch.running() == 0
        live.robot.clear()
        live.run(chance)
        return seconds, reason

    return attempt


def crash_loop(live, chance):
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        live.process.send_signal(signal.SIGUSR2)
        seconds = watch.stopped_after(since)
    reason = live.reason_of("fault")
    assert live.process.wait(5.0) == 1
    return seconds, reason


def kill_watchdog(live, chance):
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        os.kill(live.watchdog, signal.SIGKILL)
        seconds = watch.stopped_after(since)
    return seconds, live.reason_of("fault")


def freeze_watchdog(live, chance):
    """And the program still ends when it is told to."""
    live.run(chance)
    with live.watch() as watch:
        since = time.monotonic()
        os.kill(live.watchdog, signal.SIGSTOP)
        seconds = watch.stopped_after(since)
    reason = live.reason_of("fault")
    live.process.terminate()
    assert live.process.wait(5.0) == 0
    return seconds, reason
