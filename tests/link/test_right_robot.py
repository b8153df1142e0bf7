"""A name means one machine: another robot that has got its address is not taken for it."""

import socket
import threading

import pytest

from host.cli import main
from host.client.robot import Robot, connect
from host.client.stop import stop_robot
from host.errors import NoLink
from host.lab.live_station import LiveStation
from host.lab.station import STOP as STOPS
from host.link import robots_file
from host.link.names import link_to
from host.link.robots_file import Known
from host.link.transport import Meant
from robot import wire
from robot.record import STATES
from tests.lab.live import Ears
from tests.link.machines import RigLink, TcpRobot

ANNA, BERT = "a" * 32, "b" * 32


@pytest.fixture
def bert(monkeypatch):
    """A robot that runs at the address at which anna was."""
    monkeypatch.setattr("robot.session._HARDWARE_ID", BERT)
    machine = TcpRobot(link_loss="continue")
    robots_file.add("anna", f"tcp://127.0.0.1:{machine.port}", None, ANNA)
    yield machine
    machine.close()


def state(machine):
    return STATES[machine.loop.safety.state]


def test_a_name_does_not_connect_to_another_robot(bert):
    for observe in (True, False):
        with pytest.raises(NoLink, match="does not lead to anna") as raised:
            connect("anna", observe=observe)
        assert "kickctl discover --save" in raised.value.hint
        assert str(robots_file.file_path()) in raised.value.hint


def test_an_address_means_whichever_robot_is_there(bert):
    with connect(f"tcp://127.0.0.1:{bert.port}") as robot:
        assert robot.hello["hardware_id"] == BERT


@pytest.mark.parametrize("said", [ANNA, ""])
def test_it_connects_to_its_own_robot_and_to_one_that_does_not_say_which_it_is(
    bert, monkeypatch, said
):
    monkeypatch.setattr("robot.session._HARDWARE_ID", said)
    with connect("anna") as robot:
        assert robot.status()["state"] == "running"
    assert main(["--brick", "anna", "stop"]) == 0
    assert state(bert) == "stopped"


@pytest.mark.parametrize("named", ["anna", "all"])
def test_a_stop_that_another_robot_has_obeyed_is_none(bert, capsys, named):
    assert main(["--brick", named, "stop"]) == 3
    assert state(bert) == "stopped"
    said = capsys.readouterr()
    assert "another robot has obeyed the stop" in said.err + said.out
    assert "anna any more, whose motors may still be running" in said.err + said.out


@pytest.mark.parametrize("names", ["all,{}", "{},all"])
def test_a_stop_of_all_and_one_more_stops_them_all(capsys, names):
    machines = [TcpRobot(link_loss="continue") for _ in range(2)]
    try:
        named, other = (f"tcp://127.0.0.1:{machine.port}" for machine in machines)
        robots_file.add("anna", named)
        assert main(["--brick", names.format(other), "stop"]) == 0
        assert [state(machine) for machine in machines] == ["stopped"] * 2
    finally:
        for machine in machines:
            machine.close()


@pytest.mark.parametrize("line", ["status", "kick --mode phase", "experiment wall", "record 1"])
def test_every_verb_refuses_another_robot(bert, capsys, line):
    assert main(["--brick", "anna", *line.split()]) == 3
    assert "does not lead to anna" in capsys.readouterr().err
    assert state(bert) == "running"


def test_a_link_that_comes_back_to_another_robot_ends(monkeypatch):
    monkeypatch.setattr("robot.session._HARDWARE_ID", ANNA)
    link = RigLink()
    link.meant = Meant("anna", ANNA)
    with Robot(link, link.token) as robot:
        link.cut()
        robot.status()
        monkeypatch.setattr("robot.session._HARDWARE_ID", BERT)
        link.cut()
        with pytest.raises(NoLink, match="does not lead to anna"):
            robot.status()


def test_the_lab_says_so_and_its_stop_does_not_claim_to_have_stopped_it(bert):
    (anna,) = robots_file.read().values()
    station = LiveStation(anna, STOPS, "real")
    station.pages = Ears()
    with pytest.raises(NoLink, match="does not lead to anna"):
        station._connect(observe=True)
    with pytest.raises(NoLink, match="another robot has obeyed the stop"):
        station.stop_now()
    assert state(bert) == "stopped"


def test_a_robot_without_a_place_for_who_stops_it_has_stopped(bert, monkeypatch):
    monkeypatch.setattr("robot.server.PLACES", 0)
    monkeypatch.setattr("host.client.stop.WHO_S", 1e9)
    assert main(["--brick", "anna", "stop"]) == 0
    assert state(bert) == "stopped"


def test_an_older_program_that_hangs_up_on_a_hello_has_stopped():
    with socket.create_server(("127.0.0.1", 0)) as server:

        def answer_one_stop():
            with server.accept()[0] as peer:
                peer.recv(1000)
                result = {"tick": 7, "state": "stopped", "reason": ""}
                peer.sendall(wire.encode_json(wire.REPLY, {"id": None, "result": result}))
                peer.recv(1000)

        older = threading.Thread(target=answer_one_stop)
        older.start()
        uri = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        assert stop_robot(link_to(Known("anna", uri, None, ANNA))).tick == 7
        older.join()
