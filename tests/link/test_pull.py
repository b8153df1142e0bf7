"""The whole record can be pulled while others follow the present; nobody gets a tick twice."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.client.robot import Robot
from host.logs.log import Log
from tests.link.machines import RigLink
from tests.rig import packed


def complete(log, link, first=None):
    """Assert that a log follows the robot's record: no gap, no repetition, no strange event."""
    ticks = [record.tick for record in log.records]
    begin = ticks[0] if first is None else first
    assert ticks == list(range(begin, begin + len(ticks)))
    assert packed(log.records) == packed(link.records()[begin : begin + len(ticks)])
    assert [event["event"] for event in log.events].count("snapshot") == 1
    heard = [event["number"] for event in log.events if event["event"] != "snapshot"]
    noted = [event["number"] for event in link.events() if begin <= event["tick"] <= ticks[-1]]
    assert heard[: len(noted)] == noted


def test_a_pull_gives_the_past_to_its_own_tap_alone(robot, link):
    log, history = Log(), Log()
    robot.wait(5.0)
    robot.add_tap(log)
    robot.wait(0.5)
    robot.kick("membrane")
    robot.pull(history)
    robot.wait(0.5)
    robot.remove_tap(log)
    complete(log, link)
    complete(history, link, first=0)
    assert len(history) >= len(log)
    assert robot.recent()[-1].tick == log.records[-1].tick
    ticks = [record.tick for record in robot.recent()]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))


def interrupt(link, times):
    """Have ^C come while the link is read for the n-th time."""
    real, left = link.receive, [times]

    def receive(timeout_s):
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        return real(timeout_s)

    link.receive = receive


@pytest.mark.parametrize("reads", range(1, 12))
@pytest.mark.parametrize("fresh", [True, False], ids=["first of all", "while recording"])
def test_an_interrupted_pull_leaves_nothing_behind(reads, fresh):
    link = RigLink()
    with Robot(link, None) as robot:
        for _ in range(2000):  # a minute of the past
            link.run_tick()
        log = Log()
        if not fresh:
            robot.add_tap(log)
            robot.wait(0.3)
        interrupt(link, reads)
        with pytest.raises(KeyboardInterrupt):
            robot.pull(Log())
            robot.wait(1.0)
        del link.receive
        present = link.loop.blackbox.next_tick
        begin = link.now()
        second = robot.record(1.0)
        assert link.now() - begin < 2.5
        complete(second, link)
        assert present - 10 < second.records[0].tick <= present + 5
        if not fresh:
            robot.remove_tap(log)
            complete(log, link)


@settings(max_examples=30)
@given(
    st.lists(
        st.tuples(
            st.sampled_from(("pull", "cut", "interrupt", "set", "forget")), st.integers(0, 3000)
        ),
        max_size=8,
    )
)
def test_every_tap_gets_everything_once_and_in_order_through_cuts_and_interrupts(deeds):
    link = RigLink()
    link.loop.set_params({"link_loss": "continue"})
    with Robot(link, link.token) as robot:
        log = Log()
        robot.add_tap(log)
        for deed, number in deeds:
            if deed == "pull":
                history = Log()
                robot.pull(history)
                complete(history, link, first=0)
            elif deed == "cut":
                link.left = number
            elif deed == "forget":
                link.forget()
            elif deed == "set":
                robot.set(k=number / 100)
            else:
                interrupt(link, 1 + number % 7)
                try:
                    robot.pull(Log())
                except KeyboardInterrupt:
                    pass
                finally:
                    del link.receive
            robot.wait(0.2)
        robot.wait(4.0)
        robot.remove_tap(log)
    complete(log, link)
    assert log.records[-1].tick > link.loop.blackbox.next_tick - 10
