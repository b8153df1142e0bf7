"""Programs that listen: callbacks and loops that are slow or fail leave the link untouched."""

import threading

import pytest

import kickctl
from host.client.listeners import Backlog
from robot.record import STATES, Record
from tests.link.machines import TcpRobot
from tests.rig import TOKEN

PATIENCE_S = 30.0  # nothing here takes so long; it only ends what would hang
LATE_S = 2.0  # a robot that takes a silent host for lost this late bears a busy machine


@pytest.fixture
def machine():
    machine = TcpRobot(link_loss_s=LATE_S)
    yield machine
    machine.close()


@pytest.fixture
def robot(machine):
    with kickctl.Robot(machine.link(), TOKEN) as robot:
        yield robot


def record(tick):
    return Record(*([tick] + [0] * (len(Record._fields) - 1)))


# On the embedded robot


def test_a_callback_gets_every_record_in_order_and_in_the_callers_thread():
    ticks, threads = [], set()

    def callback(record):
        ticks.append(record.tick)
        threads.add(threading.current_thread())

    with kickctl.connect("sim://", seed=1) as robot, robot.on_record(callback) as listener:
        robot.wait(1)
        assert ticks == list(range(ticks[0], robot.newest.tick + 1))
        assert threads == {threading.current_thread()}
        listener.close()
        before = len(ticks)
        robot.wait(0.5)
        assert len(ticks) == before
    assert listener.dropped == listener.failures == 0


def test_a_callback_may_drive_the_robot_and_let_time_pass():
    ticks = []

    def callback(record):
        ticks.append(record.tick)
        if len(ticks) == 10:
            robot.kick("membrane")
            robot.wait(0.2)

    with kickctl.connect("sim://", seed=1) as robot:
        robot.on_record(callback)
        robot.wait(1)
        assert ticks == list(range(ticks[0], robot.newest.tick + 1))


def test_a_callback_may_stop_the_robot():
    with kickctl.connect("sim://", seed=1) as robot:
        robot.on_record(lambda record: robot.stop() if record.tick == 20 else None)
        robot.wait(2)
        assert robot.status()["state"] == "stopped"


def test_a_callback_that_fails_is_logged_once_and_goes_on(caplog):
    def callback(record):
        raise ValueError(record.tick)

    with kickctl.connect("sim://", seed=1) as robot:
        listener = robot.on_record(callback)
        robot.wait(1)
        assert listener.failures > 20
        assert str(listener.error) == str(robot.newest.tick)
        assert robot.status()["state"] == "running"
    assert len(caplog.records) == 1
    assert f"{listener.failures} failures" in repr(listener)


@pytest.mark.parametrize("kind", [SystemExit, GeneratorExit])
def test_a_callback_does_not_end_the_program_that_waits(caplog, kind):
    def callback(record):
        raise kind

    with kickctl.connect("sim://", seed=1) as robot:
        listener = robot.on_record(callback)
        assert robot.wait(1) is False
        assert isinstance(listener.error, kind)
    assert len(caplog.records) == 1


def test_an_interrupt_of_a_person_is_no_failure_of_the_callback():
    """^C falls into the callback when the callback is what takes the time."""

    def callback(record):
        raise KeyboardInterrupt

    with kickctl.connect("sim://", seed=1) as robot:
        listener = robot.on_record(callback)
        with pytest.raises(KeyboardInterrupt):
            robot.wait(1)
        assert listener.failures == 0


def test_records_come_one_by_one_while_other_things_are_done():
    with kickctl.connect("sim://", seed=1) as robot:
        seen = []
        for record in robot.records(seconds=1):
            seen.append(record)
            if len(seen) == 5:
                robot.kick("membrane")
        assert [record.tick for record in seen] == list(range(seen[0].tick, seen[-1].tick + 1))
        assert 1.0 <= seen[-1].t_s - seen[0].t_s < 1.1
        assert any(record.kick for record in seen)
        assert len(list(robot.records(seconds=0))) == 1


def test_a_loop_that_is_left_early_leaves_nothing_behind():
    with kickctl.connect("sim://", seed=1) as robot:
        for _ in robot.records():
            break
        assert robot.stream._live._taps == []
        with robot.records() as records:
            next(records)
        assert list(records) == []


@pytest.mark.parametrize("seconds", [-1.0, float("nan")])
def test_there_are_no_records_of_no_time(seconds):
    with kickctl.connect("sim://") as robot, pytest.raises(kickctl.WrongUse):
        robot.records(seconds)


def test_a_recording_holds_what_is_done_within_it():
    with kickctl.connect("sim://", seed=1) as robot:
        robot.wait(1)
        with robot.recording() as log:
            robot.kick("phase", ticks=4)
            robot.wait(0.5)
        length = len(log)
        robot.wait(0.5)
    assert len(log) == length > 10
    assert [kick["mode"] for _, kick in log.kicks()] == ["phase"]
    assert log.missing() == []


# On a real link


def test_a_callback_that_never_returns_touches_neither_link_nor_lease_nor_stop(machine, robot):
    reached, leave = threading.Event(), threading.Event()

    def callback(record):
        reached.set()
        leave.wait(PATIENCE_S)

    robot.lease()
    listener = robot.on_record(callback)
    with robot.recording() as log:
        assert reached.wait(PATIENCE_S)
        robot.wait(1.25 * LATE_S)  # longer than the robot keeps the lease of a silent host
        assert machine.loop.lease.holder is not None
        assert robot.stop() > 0
        assert robot.status()["state"] == "stopped"
    assert log.missing() == []
    leave.set()
    listener.close()


@pytest.mark.parametrize("kind", [ValueError, SystemExit, KeyboardInterrupt])
def test_a_callback_that_fails_ends_neither_its_thread_nor_the_links(machine, robot, caplog, kind):
    enough = threading.Event()

    def callback(record):
        if listener.failures > 20:
            enough.set()
        raise kind

    robot.lease()
    listener = robot.on_record(callback)
    assert enough.wait(PATIENCE_S)
    assert machine.loop.lease.holder is not None
    assert robot.stop() > 0
    assert len(caplog.records) == 1


def test_a_tap_that_fails_in_the_links_thread_is_told_to_the_next_caller(machine, robot):
    """A full disk is an example: the recording ends, the link does not."""
    failed = threading.Event()

    class Full:
        def take_records(self, records):
            failed.set()
            raise OSError(28, "No space left on device")

        def take_event(self, event):
            pass

    robot.lease()
    robot.add_tap(Full())
    assert failed.wait(PATIENCE_S)
    with pytest.raises(OSError, match="No space left"):
        robot.wait(1.0)
    robot.wait(0.1)
    assert machine.loop.lease.holder is not None


@pytest.mark.parametrize("kind", [ValueError, SystemExit])
def test_words_for_people_that_fail_do_not_end_the_link(machine, robot, caplog, kind):
    tried = threading.Event()

    def on_trouble(words):
        tried.set()
        raise kind

    robot.lease()
    robot.on_trouble = on_trouble
    robot.wait(0.1)
    robot.link.close()
    assert tried.wait(PATIENCE_S)
    robot.wait(0.5)
    assert robot.drives
    assert "on_trouble failed" in caplog.text


# A robot that is gone, and a connection that was closed: nobody waits for ever


def test_a_listener_learns_that_the_robot_is_gone_for_good(machine, robot, caplog):
    robot.reconnect_s = 0.2
    heard = threading.Event()
    listener = robot.on_record(lambda record: heard.set())
    (thread,) = [one for one in threading.enumerate() if one.name == "kickctl listener"]
    assert heard.wait(PATIENCE_S)
    machine.close()
    thread.join(PATIENCE_S)
    assert not thread.is_alive()
    assert isinstance(listener.error, kickctl.NoLink)
    assert "on_record ends" in caplog.text
    for wait in (
        lambda: robot.wait(1),
        lambda: list(robot.records()),
        lambda: robot.on_record(print),
        lambda: robot.add_tap(kickctl.Log()),
        lambda: robot.pull(kickctl.Log()),
        robot.status,
    ):
        with pytest.raises(kickctl.NoLink):
            wait()


@pytest.mark.parametrize("followed", [True, False])
def test_after_close_everything_says_so_and_leaves_no_thread(machine, robot, followed):
    if followed:
        robot.wait(0.1)
    records = robot.records() if followed else None
    robot.close()
    threads = threading.active_count()
    for use in (
        lambda: robot.wait(1),
        lambda: robot.record(1),
        robot.records,
        lambda: robot.on_record(print),
        lambda: robot.add_tap(kickctl.Log()),
        lambda: robot.pull(kickctl.Log()),
        lambda: robot.pump(1),
        lambda: robot.kick("membrane"),
        robot.lease,
        robot.status,
        *([lambda: next(records)] if followed else []),
    ):
        with pytest.raises(kickctl.NoLink, match="closed"):
            use()
    assert threading.active_count() <= threads


def test_a_stop_after_close_stops_the_robot(machine, robot):
    robot.close()
    assert machine.loop.safety.state != STATES.index("stopped")
    assert robot.stop() > 0
    assert machine.loop.safety.state == STATES.index("stopped")


def test_a_stop_after_close_of_an_embedded_robot_stops_it():
    robot = kickctl.connect("sim://", seed=1)
    robot.close()
    assert robot.stop() > 0
    assert robot.link.loop.safety.state == STATES.index("stopped")


def test_a_stop_after_close_says_that_the_robot_is_gone(machine, robot):
    robot.close()
    machine.close()
    with pytest.raises(kickctl.NoLink):
        robot.stop()


# The queue between link and listener


def test_a_backlog_drops_the_oldest_and_counts_them():
    backlog = Backlog(length=3)
    backlog.take_records([record(tick) for tick in range(5)])
    assert (len(backlog), backlog.dropped) == (3, 2)
    assert [backlog.get().tick for _ in range(3)] == [2, 3, 4]
    assert backlog.get() is None


def test_a_closed_backlog_takes_nothing_more():
    """The link's thread may hand on records while another thread closes the listener."""
    backlog = Backlog()
    backlog.end()
    backlog.take_records([record(1)])
    assert backlog.wait() is None
    assert (len(backlog), backlog.dropped) == (0, 0)


def test_a_closed_backlog_lets_nobody_wait():
    backlog = Backlog()
    waiter = threading.Thread(target=backlog.wait)
    waiter.start()
    backlog.end()
    waiter.join(PATIENCE_S)
    assert not waiter.is_alive()
