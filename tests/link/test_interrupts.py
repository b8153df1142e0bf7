"""^C falls between the ticks and the commands of an embedded robot, never into one."""

import signal
import sys
from contextlib import contextmanager

import pytest

from host.client.robot import connect
from host.link.sim import SimLink
from host.logs.log import Log
from host.logs.replay import replay
from host.util.interrupts import uninterrupted
from tests.rig import packed

OURS = ("/robot/", "/sim_motor/", "/host/")


@contextmanager
def interrupted_at(line):
    """Have ^C come at the n-th line of the project's own code that runs in the block."""
    left = [line]

    def trace(frame, event, argument):
        if not any(part in frame.f_code.co_filename for part in OURS):
            return None
        if event == "line":
            left[0] -= 1
            if left[0] == 0:
                sys.settrace(None)
                signal.raise_signal(signal.SIGINT)
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        yield
    except KeyboardInterrupt:
        assert left[0] <= 0
    finally:
        sys.settrace(before)


def drive(robot):
    for number in range(3):
        robot.set(k=3.0 + number)
        robot.kick("membrane")
        robot.wait(0.12)
    robot.stop()
    robot.start()
    robot.wait(0.1)


# A prime number of lines apart, all over the 20,431 lines that run.
@pytest.mark.parametrize("line", range(1, 20500, 397))
def test_an_interrupted_recording_replays_and_the_robot_goes_on(line):
    with connect("sim://", seed=1) as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        with interrupted_at(line):
            drive(robot)
        robot.set(k=7.0)
        robot.wait(0.3)
        robot.remove_tap(log)
        loop = robot.link.loop
        box = loop.blackbox
        first, end = log.records[0].tick, log.records[-1].tick + 1
        kept = b"".join(box.read(tick, 1) for tick in range(first, end))
        assert packed(log.records) == kept
        assert box.snapshot(box.next_tick)[1]["params"] == loop.params.values()
        heard = [event["number"] for event in log.events if event["event"] != "snapshot"]
        assert heard == list(range(heard[0], heard[0] + len(heard)))
        assert replay(log).reproduced


def test_a_tick_is_whole(link, monkeypatch):
    real = link.loop.tick
    monkeypatch.setattr(link.loop, "tick", lambda: (signal.raise_signal(signal.SIGINT), real()))
    before = link.loop.blackbox.next_tick
    with pytest.raises(KeyboardInterrupt):
        SimLink.run_tick(link)
    assert link.loop.blackbox.next_tick == before + 1


def test_nested_blocks_are_interrupted_at_the_end_of_the_outermost():
    done = []
    with pytest.raises(KeyboardInterrupt), uninterrupted():
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            done.append("inner")
        done.append("outer")
    assert done == ["inner", "outer"]


def test_an_interrupt_is_not_lost_when_the_block_fails():
    with pytest.raises(KeyboardInterrupt), uninterrupted():
        signal.raise_signal(signal.SIGINT)
        raise OSError
