"""Several connections of one program to one robot, as a notebook's cells make them."""

import gc
import threading
import time
import weakref

import pytest

from host.client.robot import Robot, connect
from host.errors import LeaseLost, NoLink
from host.link.addresses import make_link
from robot.record import STATES
from tests.link.machines import Cable, Machine, TcpRobot, open_files
from tests.rig import TOKEN

PATIENCE_S = 30.0
LATE_S = 2.0


@pytest.fixture
def machine():
    machine = TcpRobot(link_loss_s=0.2)
    yield machine
    machine.close()


@pytest.fixture
def patient():
    """A robot that takes a host for lost late, for a machine that is busy."""
    machine = TcpRobot(link_loss_s=LATE_S)
    yield machine
    machine.close()


def until(true):
    """Wait for what is to come at once."""
    end = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_a_cell_that_connects_and_drives_can_be_run_twice(patient):
    for _ in range(3):
        robot = Robot(patient.link(), TOKEN, "my notebook")
        robot.kick("membrane")
        robot.wait(0.1)
        assert robot.drives
    robot.close()


def test_a_robot_drives_on_under_the_connection_that_replaces_its_driver(patient):
    """A cell `robot = connect(...)` that is run again after the robot was started."""
    machine = patient
    robot = Robot(machine.link(), TOKEN, "nb")
    robot.lease()
    for _ in range(2):
        robot = Robot(machine.link(), TOKEN, "nb")
        robot.wait(1.25 * LATE_S)  # longer than the robot keeps the lease of a silent host
        assert robot.drives
        assert STATES[machine.loop.safety.state] == "running"
    robot.wait(0.1)
    assert robot.record(0.3).kicks() == []
    assert machine.loop.lease.name == "nb"
    assert [event["event"] for _, event in machine.loop.blackbox._journal].count("stop") == 0
    robot.close()


def test_the_newest_connection_that_may_drive_inherits_control(patient):
    machine = patient
    robots = [Robot(machine.link(), TOKEN, f"robot {number}") for number in range(3)]
    watcher = Robot(machine.link(), None, "watcher")
    robots[0].lease()
    robots[2].close()
    del robots[0]
    until(lambda: robots[0].drives)
    assert not watcher.drives
    assert not robots[1].drives
    robots[0].wait(1.25 * LATE_S)
    assert STATES[machine.loop.safety.state] == "running"
    robots[0].close()
    watcher.close()


def test_a_driver_without_an_heir_is_said_to_be_gone(machine, caplog):
    robot = Robot(machine.link(), TOKEN, "nb")
    robot.lease()
    robot = Robot(machine.link(), None, "nb")
    until(lambda: caplog.records)
    (said,) = caplog.messages
    assert "'nb'" in said
    assert machine.link().uri in said
    robot.wait(0.1)
    until(lambda: STATES[machine.loop.safety.state] == "stopped")
    robot.close()


def test_a_connection_that_was_closed_hands_nothing_on(machine, caplog):
    robot = Robot(machine.link(), TOKEN, "nb")
    robot.lease()
    other = Robot(machine.link(), TOKEN, "nb")
    robot.close()
    del robot
    gc.collect()
    assert not other.drives
    assert not caplog.records
    assert machine.loop.lease.holder is None
    assert STATES[machine.loop.safety.state] == "running"
    other.close()


def test_an_embedded_robot_is_handed_on_too(link):
    robot = Robot(link, link.token, "nb")
    robot.lease()
    robot = Robot(link.another(), link.token, "nb")
    assert robot.drives
    robot.wait(5)
    assert robot.status()["state"] == "running"
    assert robot.status()["controller"] == "nb"
    robot.close()


def test_two_embedded_robots_are_two(caplog):
    for _ in range(2):
        robot = connect("sim://", seed=1)
        assert not robot.drives
        robot.lease()
    robot.close()
    assert not caplog.records


def test_the_last_to_take_control_has_it_and_the_others_do_not_keep_it(patient):
    machine = patient
    with Robot(machine.link(), TOKEN, "second") as second:
        first = Robot(machine.link(), TOKEN, "first")
        first.lease()
        second.lease()
        assert (first.drives, second.drives) == (False, True)
        assert machine.loop.lease.name == "second"
        first.close()  # what it gives back is not its own any more
        time.sleep(1.25 * LATE_S)
        assert machine.loop.lease.name == "second"
        assert STATES[machine.loop.safety.state] == "running"


def test_another_program_is_still_kept_out(patient, monkeypatch):
    machine = patient
    with Robot(machine.link(), TOKEN, "here") as robot:
        robot.lease()
        monkeypatch.setattr("host.client.neighbours.client_id", lambda: "another program")
        with Robot(machine.link(), TOKEN, "there") as other, pytest.raises(LeaseLost, match="here"):
            other.kick("membrane")


def test_a_connection_dies_with_the_last_reference_to_it(machine):
    gc.collect()
    files, threads = open_files(), threading.active_count()
    robot = Robot(machine.link(), TOKEN)
    robot.kick("membrane")
    heard = []
    robot.on_record(heard.append)
    robot.wait(0.1)
    gone = weakref.ref(robot)
    del robot
    until(lambda: gone() is None)
    until(lambda: threading.active_count() == threads)
    until(lambda: not machine.server._peers)
    assert open_files() == files
    until(lambda: machine.loop.lease.holder is None)
    until(lambda: STATES[machine.loop.safety.state] == "stopped")
    assert heard


def test_a_new_connection_over_a_serial_line_takes_the_line(tmp_path):
    cable = Cable(tmp_path)
    machine = Machine(cable.paths["robot"])
    uri = f"serial://{cable.paths['host']}"
    try:
        first = Robot(make_link(uri), TOKEN)
        first.kick("membrane")
        with Robot(make_link(f"{uri}?baud=115200"), TOKEN) as second:
            assert second.drives
            second.wait(1.0)
            assert STATES[machine.loop.safety.state] == "running"
            second.kick("membrane")
            with pytest.raises(NoLink, match="taken over"):
                first.status()
    finally:
        machine.close()
        cable.close()
