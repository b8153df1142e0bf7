"""`kickctl watch` on several robots: a row and a stop for each, and none waits for another one."""

import json
import socket
import sys

import pytest

from host.client.robot import connect
from host.commands._watch_table import SeveralRobots
from tests.cli.test_desk import desk_robot
from tests.cli.test_watch_terminal import terminal
from tests.link.test_robots_by_name import Laptop

FOOT = b"each key is for all of them"


@pytest.fixture(scope="module")
def laptop(tmp_path_factory):
    """A laptop that knows two robots, and a third one that never answers."""
    folder = tmp_path_factory.mktemp("several")
    laptop = Laptop(folder / "laptop")
    for name in ("anna", "bert"):
        (folder / name).mkdir()
    with (
        desk_robot(folder / "anna") as (anna, _),
        desk_robot(folder / "bert") as (bert, _),
        socket.create_server(("127.0.0.1", 0)) as silent,
    ):
        laptop.addresses = {"anna": anna, "bert": bert}
        for name, address in laptop.addresses.items():
            laptop.knows(name, address, folder / name / "token")
        laptop.knows("mute", f"tcp://127.0.0.1:{silent.getsockname()[1]}")
        yield laptop


def states(laptop):
    found = {}
    for name, address in laptop.addresses.items():
        with connect(address, observe=True) as robot:
            found[name] = robot.status()["state"]
    return found


def test_keys_kick_and_stop_all_of_them_while_one_does_not_answer(laptop):
    command = [sys.executable, "-m", "host", "--brick", "anna,bert,mute", "watch"]
    with terminal(laptop.folder, command, **laptop.environment()) as screen:
        screen.wait_for(FOOT)
        screen.wait_for("│ anna  │ running".encode())
        screen.wait_for("│ bert  │ running".encode())
        screen.wait_for("│ mute  │ no record".encode())
        screen.type(b"1")
        screen.wait_for(b"anna: tick ")
        for name in (b"anna", b"bert"):
            screen.wait_for(b"kick membrane, 1 tick", screen.wait_for(name + b": tick "))
        screen.type(b" ")
        for name in (b"anna", b"bert"):
            screen.wait_for(name + b": stop: motors stopped before tick")
        screen.type(b"q")
        # That nobody has confirmed the stop of the third one is said, and waited for.
        screen.wait_for(b"mute: stop: the stop was sent to tcp://")
        assert screen.wait() == 3
        screen.wait_for(b"kickctl: mute: ")
        assert b"Traceback" not in screen.seen
    assert states(laptop) == {"anna": "stopped", "bert": "stopped"}


def test_json_lines_name_their_robot_and_an_error_ends_only_its_own(laptop):
    laptop.knows("gone", "tcp://127.0.0.1:1")
    status, out, err = laptop.run(
        "--brick", "anna,gone,bert", "watch", "--seconds", "0.5", "--json"
    )
    lines = [json.loads(line) for line in out.splitlines()]
    assert status == 3
    assert {line["robot"] for line in lines} == {"anna", "bert", "gone"}
    (error,) = [line["error"] for line in lines if line["robot"] == "gone"]
    assert error["status"] == 3
    for name in ("anna", "bert"):
        ticks = [line["tick"] for line in lines if line["robot"] == name]
        assert ticks == sorted(ticks)
        assert len(ticks) >= 3
    assert "kickctl: gone: no robot's program runs at" in err


def test_what_each_of_several_robots_says_of_a_stop_is_seen():
    """All of it may come between two drawings."""
    names = ["anna", "bert", "carl"]
    screen = SeveralRobots(names, ["keys"])
    words = [f"{name}: {said}" for said in ("sent", "answered", "stopped") for name in names]
    for line in words:
        screen.add(line)
    shown = [str(part) for part in screen.render().renderables]
    assert [line for line in words if line not in shown] == []
