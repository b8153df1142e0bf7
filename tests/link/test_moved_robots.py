"""A robot whose address has changed is found again by its hardware id, and keeps its name."""

import json

import pytest

from host.cli import main
from host.link import discovery, robots_file
from host.link.discovery import Found
from tests.link.machines import TcpRobot
from tests.rig import TOKEN


@pytest.fixture
def machine(monkeypatch):
    monkeypatch.setattr("robot.session._HARDWARE_ID", "a" * 32)
    machine = TcpRobot()
    yield machine
    machine.close()


@pytest.fixture
def discover(machine, monkeypatch, capsys):
    """A function that has `kickctl discover --save` find the machine; it returns the answer."""
    found = Found(
        "ev3dev", "robot", f"tcp://127.0.0.1:{machine.port}", "ev3dev.local", ("127.0.0.1",)
    )
    monkeypatch.setattr(discovery, "look_around", lambda seconds: [found])

    def run():
        assert main(["discover", "--save", "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    return run


def write_token(path, token=TOKEN):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(token.hex())
    path.chmod(0o600)


def test_a_robot_keeps_its_name_under_another_address(machine, discover, capsys):
    write_token(robots_file.token_path("anna"))
    old, new = (f"ssh://robot@{host}?port={machine.port}" for host in ("10.9.8.7", "127.0.0.1"))
    robots_file.add("anna", old, None, "a" * 32)
    answer = discover()
    assert (answer["saved"], answer["moved"]) == ({}, {"anna": {"from": old, "to": new}})
    assert answer["robots"][0]["hardware_id"] == "a" * 32
    (anna,) = robots_file.read().values()
    assert (anna.address, anna.hardware_id) == (new, "a" * 32)
    assert main(["discover", "--save"]) == 0
    assert "all of them have names already" in capsys.readouterr().out


def test_who_only_says_the_same_id_gets_no_known_name(machine, discover):
    """Else a pupil's program would get what is meant for the teacher's robot, such as its stop."""
    write_token(robots_file.token_path("anna"), bytes(32))
    old = f"tcp://10.9.8.7:{machine.port}"
    robots_file.add("anna", old, None, "a" * 32)
    answer = discover()
    assert answer["moved"] == {}
    assert list(answer["saved"]) == ["ev3dev"]
    assert robots_file.read()["anna"].address == old


def test_a_robot_that_was_added_by_hand_gets_its_id_when_it_is_found(machine, discover):
    robots_file.add("anna", f"tcp://ev3dev.local:{machine.port}")
    answer = discover()
    assert (answer["saved"], answer["moved"]) == ({}, {})
    assert robots_file.read()["anna"].hardware_id == "a" * 32


@pytest.mark.parametrize("said", ["", 'a"\n[evil]', {"a": 1}, 5, "A" * 32])
def test_what_is_no_id_is_not_kept(discover, capsys, monkeypatch, said):
    monkeypatch.setattr("robot.session._HARDWARE_ID", said)
    assert list(discover()["saved"]) == ["ev3dev"]
    assert robots_file.read()["ev3dev"].hardware_id is None
    if isinstance(said, str):
        assert main(["robots", "add", "bert", "tcp://h", f"--hardware-id={said}"]) == 2
        assert "is no hardware id" in capsys.readouterr().err


def test_a_new_robot_is_saved_with_its_id(discover):
    assert list(discover()["saved"]) == ["ev3dev"]
    assert robots_file.read()["ev3dev"].hardware_id == "a" * 32


def test_deploying_to_a_known_robot_elsewhere_keeps_its_name_and_takes_its_new_token(capsys):
    """What deploy.sh types in the end."""
    old, new = robots_file.token_path("anna"), robots_file.token_path("10-0-0-9")
    write_token(old)
    write_token(new)

    def add(name, address, token):
        status = main(
            ["robots", "add", name, address, "--token", str(token), "--hardware-id", "b" * 32]
        )
        captured = capsys.readouterr()
        assert status == 0, captured.err
        return captured

    add("anna", "ssh://robot@10.0.0.5", old)
    said = add("10-0-0-9", "ssh://robot@10.0.0.9", new)
    assert said.out.startswith("anna is ssh://robot@10.0.0.9 ")
    assert "its hardware id is that of anna, which was at ssh://robot@10.0.0.5" in said.err
    (anna,) = robots_file.read().values()
    assert (anna.address, anna.token) == ("ssh://robot@10.0.0.9", str(old))
    write_token(new, bytes(32))  # its card is another one
    add("10-0-0-9", "ssh://robot@10.0.0.7", new)
    (anna,) = robots_file.read().values()
    assert (anna.address, anna.token) == ("ssh://robot@10.0.0.7", str(new))
    # Another robot's program on the same machine is another robot.
    add("second", "ssh://robot@10.0.0.7?port=5426", old)
    assert list(robots_file.read()) == ["anna", "second"]
