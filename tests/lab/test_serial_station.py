"""A station on a serial line, which has room for one connection that watches, drives and stops."""

import pytest

from host.lab.live_station import LiveStation
from host.lab.station import STOP
from host.link.robots_file import Known
from tests.lab.live import Answers, Beating, Ears, started
from tests.link.machines import Cable, Machine
from tests.live import wait_until
from tests.rig import TOKEN


@pytest.fixture
def machine(tmp_path):
    cable = Cable(tmp_path)
    machine = Machine(cable.paths["robot"])
    machine.uri = f"serial://{cable.paths['host']}?baud=115200"
    yield machine
    machine.close()
    cable.close()


@pytest.fixture
def station(machine, tmp_path):
    token = tmp_path / "anna.token"
    token.write_text(TOKEN.hex(), encoding="ascii")
    token.chmod(0o600)
    station = LiveStation(Known("anna", machine.uri, str(token)), STOP, "real")
    station.pages = Ears()
    station.start()
    assert station.met.wait(20.0)
    yield station
    station.end()


def test_it_watches_drives_stops_and_gives_back_over_one_connection(station):
    wait_until(lambda: station.state()["link"] == "up", "records come")
    with Beating(station):
        station.stop()
        wait_until(lambda: station.state().get("state") == "stopped", "the robot stops")
        started(station)
        answers = Answers()
        station.do("set", {"set": {"k": 6.0}}, answers)
        assert "tick" in answers.next()
        station.do("identify", {}, answers)
        assert "seconds" in answers.next()
        with station._watcher._lock:  # a request waits for its answer
            station.stop()
        wait_until(lambda: station.state()["state"] == "stopped", "the robot stops")
        started(station)
    station.abandon()
    wait_until(lambda: station.state()["state"] == "stopped", "the robot stops")
    wait_until(lambda: station.state()["controller"] is None, "the robot is given back")
