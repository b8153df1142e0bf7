"""Callbacks and loops that take long, raise, or use the robot themselves: nothing else waits."""

import threading

import pytest

import kickctl
from robot.record import STATES
from tests.link.machines import TcpRobot
from tests.rig import TOKEN

PATIENCE_S = 30.0  # nothing here takes so long; it only ends what would hang
# How long the robot keeps the lease of a silent host; a busy machine may silence one for a while.
LEASE_S = 1.5
FEW = 5


@pytest.fixture
def machine():
    machine = TcpRobot(link_loss_s=LEASE_S)
    yield machine
    machine.close()


@pytest.fixture
def robot(machine):
    with kickctl.Robot(machine.link(), TOKEN) as robot:
        robot.lease()
        yield robot


@pytest.fixture
def leave():
    """Set at the end, so that no callback holds the tests up."""
    leave = threading.Event()
    yield leave
    leave.set()


def state(machine):
    return STATES[machine.loop.safety.state]


def misuse(kind, leave):
    """What a user's function may do for each record, before it returns, if it does."""

    def misused():
        if isinstance(kind, float):
            leave.wait(kind)
        else:
            raise kind

    return misused


KINDS = pytest.mark.parametrize("kind", [0.05, 5.0, ValueError("odd"), SystemExit(3)], ids=repr)


@KINDS
def test_a_callback_costs_neither_link_nor_lease_nor_stop_anything(machine, robot, leave, kind):
    reached = threading.Event()
    misused = misuse(kind, leave)
    ticks = []

    def callback(record):
        reached.set()
        ticks.append(record.tick)
        misused()

    with robot.recording() as log, robot.on_record(callback) as listener:
        assert reached.wait(PATIENCE_S)
        listener.backlog._length = FEW
        robot.wait(1.5 * LEASE_S)
        if isinstance(kind, float):
            assert robot.wait(PATIENCE_S, until=lambda: listener.dropped > FEW)
        assert robot.drives
        assert machine.loop.lease.holder is not None
        assert robot.stop() > 0
        assert state(machine) == "stopped"
    assert log.missing() == []
    assert ticks == sorted(ticks)
    assert len(listener.backlog) == 0
    if isinstance(kind, float):
        assert listener.failures == 0
    else:
        assert listener.failures >= len(ticks) - 1
        assert listener.error is kind


@KINDS
def test_nothing_is_taken_twice_or_disappears_uncounted(kind, leave):
    """All that came was taken, was dropped, or still waits."""
    misused = misuse(kind, leave)
    taken = []

    def callback(record):
        taken.append(record.tick)
        if isinstance(kind, float):
            robot.wait(kind)  # of the robot's time: 5 s are 167 records
        else:
            misused()

    with kickctl.connect("sim://", seed=1) as robot:
        listener = robot.on_record(callback)
        listener.backlog._length = FEW
        robot.wait(12.0)
        assert len(listener.backlog) <= FEW
        came = robot.newest.tick - taken[0] + 1
        assert came == len(taken) + listener.dropped + len(listener.backlog)
    assert taken == sorted(set(taken))
    assert (listener.dropped > 0) == isinstance(kind, float)


def test_a_slow_loop_costs_neither_link_nor_lease_nor_stop_anything(machine, robot):
    with robot.recording() as log, robot.records() as records:
        records._backlog._length = FEW
        first = next(records)
        stopped = threading.Event()
        threading.Timer(1.5 * LEASE_S, stopped.set).start()
        assert stopped.wait(PATIENCE_S)  # the loop's body takes longer than a silent lease lasts
        assert machine.loop.lease.holder is not None
        assert robot.stop() > 0
        assert state(machine) == "stopped"
        second = next(records)
        assert second.tick - first.tick - 1 == records.dropped > 0
        assert len(records._backlog) <= FEW
    assert log.missing() == []


def test_a_loop_that_fails_leaves_nothing_behind(machine, robot):
    with pytest.raises(ValueError, match="odd"), robot.records() as records:
        for _ in records:
            raise ValueError("odd")
    assert robot.stream._live._taps == []
    robot.wait(1.5 * LEASE_S)
    assert machine.loop.lease.holder is not None
    assert robot.stop() > 0


# A callback that uses the robot


def test_a_callback_may_kick_stop_and_close_a_real_robot(machine, robot):
    steps = iter(
        (
            lambda: robot.kick("membrane"),
            robot.stop,
            robot.start,
            lambda: robot.kick("phase", ticks=2),
            robot.stop,
            robot.close,
        )
    )
    done = []

    def callback(record):
        step = next(steps, None)
        if step is not None:
            done.append(step())

    listener = robot.on_record(callback)
    (thread,) = [one for one in threading.enumerate() if one.name == "kickctl listener"]
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
    assert len(done) == 6
    assert (listener.failures, listener.error) == (0, None)
    assert state(machine) == "stopped"
    assert machine.loop.lease.holder is None
    kicks = [event for _, event in machine.loop.blackbox._journal if event["event"] == "kick"]
    assert [event["kick"]["mode"] for event in kicks] == ["membrane", "phase"]
    with pytest.raises(kickctl.NoLink, match="closed"):
        robot.wait(1)


@pytest.mark.parametrize("use", ["kick", "stop", "close"])
def test_a_callback_may_use_the_robot_while_others_wait_for_it(machine, robot, use):
    """The one who waits holds the link's lock now and then, and the callback needs it."""
    calls = {"kick": lambda: robot.kick("membrane"), "stop": robot.stop, "close": robot.close}
    used = threading.Event()

    def callback(record):
        if not used.is_set():
            calls[use]()
            used.set()

    listener = robot.on_record(callback)
    if use == "close":
        with pytest.raises(kickctl.NoLink, match="closed"):
            robot.wait(PATIENCE_S)
        assert used.wait(PATIENCE_S)
    else:
        assert robot.wait(PATIENCE_S, until=used.is_set)
    assert listener.failures == 0


def test_a_stop_from_outside_waits_for_no_callback_of_an_embedded_robot(leave):
    """The callback runs in the thread that lets time pass; the stop comes from another one."""
    reached = threading.Event()

    def callback(record):
        reached.set()
        leave.wait(PATIENCE_S)

    with kickctl.connect("sim://", seed=1) as robot:
        robot.on_record(callback)
        driver = threading.Thread(target=robot.wait, args=(0.1,))
        driver.start()
        assert reached.wait(PATIENCE_S)
        assert robot.stop() > 0
        assert driver.is_alive()
        assert STATES[robot.link.loop.safety.state] == "stopped"
        leave.set()
        driver.join(PATIENCE_S)


def test_an_embedded_robot_that_its_callback_closes_says_so():
    ticks = []

    def callback(record):
        ticks.append(record.tick)
        robot.close()

    robot = kickctl.connect("sim://", seed=1)
    listener = robot.on_record(callback)
    with pytest.raises(kickctl.NoLink, match="closed"):
        robot.wait(1)
    assert len(ticks) == 1
    assert listener.failures == 0
