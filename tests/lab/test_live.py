"""A station on a robot in real time: whatever hangs or dies, a robot that is to stop stops."""

import subprocess
import sys
import threading

import pytest

from host.client.robot import connect
from host.errors import KickctlError, NoLink
from host.lab.desk_robot import DeskRobot, child_options
from host.lab.live_station import LiveStation
from host.lab.server import Lab
from host.lab.station import CONTINUE, STOP
from host.lab.stopper import LAB
from host.link.robots_file import Known
from robot.record import STRUCT
from tests.lab.browser import browse, held_up
from tests.lab.live import Answers, Beating, Ears, controller, started, state, station_at
from tests.live import Relay, wait_until
from tests.sysfs.mount import ROOT


@pytest.fixture
def station(desk):
    with station_at(desk.uri, desk.token) as station:
        yield station


def test_it_drives_and_gives_the_robot_back(station, observer):
    with Beating(station):
        started(station)
        assert controller(observer) is not None
        answers = Answers()
        station.do("kick", {"mode": "membrane", "id": "one"}, answers)
        assert answers.next()["kick_id"]
        station.do("kick", {"mode": "fly", "id": "three"}, answers)
        assert isinstance(answers.next(), KickctlError)
        assert state(observer) == "running"
    station.abandon()
    wait_until(lambda: state(observer) == "stopped", "the robot stops")
    wait_until(lambda: controller(observer) is None, "the robot is given back")
    wait_until(lambda: station.state()["stopped_by"] == LAB, "the lab says that it did that")


def test_a_robot_that_may_go_on_goes_on(desk, observer):
    with station_at(desk.uri, desk.token, CONTINUE) as station:
        started(station)
        station.abandon()
        wait_until(lambda: controller(observer) is None, "the robot is given back")
        assert state(observer) == "running"


def test_a_robot_stops_by_itself_when_nobody_attends(station, observer):
    """As when the lab hangs: only its own threads live on."""
    with observer.recording() as log, Beating(station) as beating:
        started(station)
        observer.wait(1.5)
        assert state(observer) == "running"
        beating.cease()
        observer.wait(20.0, until=lambda: state(observer) == "stopped")
        observer.wait(0.1)
    assert "link_loss" in [event["event"] for event in log.events]


def test_a_stop_passes_a_drive_thread_that_hangs_and_cancels_what_waits(station, observer):
    with Beating(station):
        started(station)
        hangs, free = threading.Event(), threading.Event()
        carry_out = station._carry_out

        def hang(robot, command, arguments):
            hangs.set()
            free.wait()
            return carry_out(robot, command, arguments)

        station._carry_out = hang
        answers = Answers()
        station.do("set", {"set": {"k": 8.0}}, answers)
        station.do("start", {}, answers)
        assert hangs.wait(20.0)
        station.stop()
        wait_until(lambda: state(observer) == "stopped", "the robot stops")
        free.set()
        answers.next()
        assert "stopped meanwhile" in answers.next().message
        assert state(observer) == "stopped"


def test_a_command_that_was_under_way_when_the_stop_came_is_stopped_too(station, observer):
    with Beating(station):
        carry_out, late = station._carry_out, threading.Event()

        def stopped_first(robot, command, arguments):
            station.stop()
            wait_until(lambda: not station._stop_wanted.is_set(), "the stop goes out")
            result = carry_out(robot, command, arguments)
            late.set()
            return result

        station._carry_out = stopped_first
        station.do("start", {}, Answers())
        assert late.wait(20.0)
        wait_until(lambda: state(observer) == "stopped", "the robot stops")


def test_a_stop_passes_a_connection_that_waits_for_an_answer(station, observer):
    with Beating(station):
        started(station)
        with station._watcher._lock, station._driver._lock:
            station.stop()
            wait_until(lambda: state(observer) == "stopped", "the robot stops")


def test_a_primitive_is_reached_and_a_stop_ends_it_at_once(station, observer):
    with Beating(station):
        answers = Answers()
        station.do("primitive", {"name": "spin-left"}, answers)
        station.do("kick", {"mode": "membrane", "id": "two"}, answers)
        assert "into a primitive" in answers.next().message
        assert answers.next()["after"] == {"left": "backward", "right": "forward"}
        station.do("primitive", {"name": "forward"}, answers)
        observer.wait(0.2)
        station.stop()
        assert "stopped meanwhile" in answers.next().message
        started(station)  # after the stop, no matter how long that takes
        observer.wait(0.3)
        assert state(observer) == "running"


def test_a_robot_that_this_lab_has_not_driven_is_let_be(desk, station, observer):
    with connect(desk.uri, token=desk.token) as other:
        patience = station.state()["params"]["link_loss_s"]
        other.set(link_loss_s=10.0)  # a busy machine, too, keeps a host from speaking
        try:
            other.start()
            station.abandon()
            station.do("identify", {}, answers := Answers())
            assert answers.next()
            observer.wait(0.3)
            assert state(observer) == "running"
            assert other.drives
        finally:
            other.set(link_loss_s=patience)


def test_a_robot_that_would_drive_on_without_a_lab_is_told_of(desk, station, observer):
    with connect(desk.uri, token=desk.token) as other:
        other.set(link_loss="continue")
        other.release()
        try:
            wait_until(
                lambda: station.state()["params"]["link_loss"] == "continue", "the lab knows"
            )
            with Beating(station):
                started(station)
            assert any(
                "link_loss is continue" in one.get("message", "") for one in station.pages.heard
            )
        finally:
            other.set(link_loss="stop")


def test_it_identifies_and_records_without_driving(station, observer, tmp_path):
    answers = Answers()
    station.do("identify", {}, answers)
    assert "seconds" in answers.next()
    station.do("record", {"on": True}, answers)
    name = answers.next()["log"]
    assert station.state()["recording"] == name
    recording, said = station.logs[name], []
    end = recording.close
    recording.close = lambda: (said.append(station.state()["recording"]), end())
    station.do("record", {"on": False}, answers)
    assert answers.next() == {"log": None}
    assert said == [name]  # it says that the log is ended only once it is whole
    assert station.logs[name].whole
    assert controller(observer) is None


def test_a_lost_robot_is_found_again_with_all_its_records(desk):
    relay = Relay(int(desk.uri.rpartition(":")[2]))
    try:
        with station_at(relay.uri, desk.token) as station:
            wait_until(lambda: station.state()["link"] == "up", "records come")
            relay.silent = True
            wait_until(lambda: station.state()["link"] == "lost", "the robot is lost")
            assert station.state()["state"]  # what is known of it stays
            relay.silent = False
            wait_until(lambda: station.state()["link"] == "up", "the robot is found again")
            end = station.ring.end
            wait_until(lambda: station.ring.end > end, "records come")
            portion = station.ring.read(0, station.ring.end)
            size = len(portion.data) // portion.records
            ticks = [
                STRUCT.unpack_from(portion.data, at)[0] for at in range(0, len(portion.data), size)
            ]
            assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    finally:
        relay.close()


def test_a_connection_that_died_for_good_is_replaced(station, observer):
    before = station._watcher
    before.close()
    wait_until(lambda: station._watcher is not before, "there is a new connection")
    wait_until(lambda: station.state()["link"] == "up", "records come")
    with Beating(station):
        started(station)
        station._driver.link.close()
        station._driver.close()
        station.stop()
        wait_until(lambda: state(observer) == "stopped", "the robot stops")
        started(station)


def test_a_robot_that_is_not_there_is_lost_and_a_stop_says_so():
    station = LiveStation(Known("anna", "tcp://127.0.0.1:1"), STOP, "real")
    station.pages = Ears()
    station.start()
    try:
        wait_until(lambda: station.trouble, "the station says what is wrong")
        assert station.state()["link"] == "lost"
        assert "no robot" in station.state()["hint"]
        station.stop()
        wait_until(lambda: station.pages.heard, "the stop says that it has not arrived")
        note = station.pages.heard[0]
        assert (note["type"], note["robot"]) == ("note", "anna")
        assert "no robot" in note["message"]
    finally:
        station.end()


def test_a_server_that_hangs_lets_no_robot_drive_on(desk, observer, tmp_path):
    """The event loop is blocked: nobody knows whether the driver's page is still awake."""
    (tmp_path / "index.html").write_text("", encoding="utf-8")
    with (
        station_at(desk.uri, desk.token) as station,
        Lab([station], port=0, folder=tmp_path) as lab,
    ):

        async def scenario(browser):
            tab = await browser.open(lab.drive_url)
            await tab.ask("do", robot="anna", command="start", arguments={})
            with held_up(lab):
                wait_until(lambda: state(observer) == "stopped", "the robot stops")

        browse(scenario)
    assert "silent" in observer.status()["reason"]


def test_a_driver_that_falls_silent_stops_the_robot(desk, observer, tmp_path):
    """A hidden tab, a shut lid or a crashed browser: the page is open, and says nothing."""
    with (
        station_at(desk.uri, desk.token) as station,
        Lab([station], port=0, folder=tmp_path) as lab,
    ):

        async def scenario(browser):
            tab = await browser.open(lab.drive_url)
            await tab.ask("do", robot="anna", command="start", arguments={})
            await tab.until(
                lambda tab: any(
                    one["type"] == "baton" and one["driver"] is None and one["why"]
                    for one in tab.got
                )
            )
            wait_until(lambda: state(observer) == "stopped", "the robot stops")
            await tab.ask("do", robot="anna", command="start", arguments={})
            assert state(observer) == "running"

        browse(scenario)


def test_a_desk_robot_that_dies_says_why(tmp_path):
    desk = DeskRobot(child_options("sim://", 1))
    said = []
    try:
        desk.on_end = said.append
        desk._process.kill()
        wait_until(lambda: said, "its end is said")
        assert "has ended with status -9" in said[0]
        desk.pull("left", 1.0)
    finally:
        desk.close()


def test_a_desk_robot_ends_with_its_lab_however_that_ends():
    code = (
        "import os, signal\n"
        "from host.lab.desk_robot import DeskRobot\n"
        "print(DeskRobot(['--seed', '1']).uri, flush=True)\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=False
    )
    uri = done.stdout.strip()
    assert done.returncode == -9
    assert uri.startswith("tcp://")

    def gone():
        try:
            connect(uri, observe=True).close()
        except NoLink:
            return True
        return False

    wait_until(gone, "the desk robot ends")
