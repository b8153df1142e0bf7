"""The same conversation over serial lines.

Pseudo-terminals with a cable between them that makes noise and comes off.
"""

import os
import socket
import threading
from contextlib import suppress
from pathlib import Path
from random import Random

import pytest

from host.client.robot import Robot
from host.errors import NoLink
from host.link.addresses import make_link
from host.logs.log import Log
from robot import wire
from robot.record import STATES, unpack
from robot.serial_line import SerialLine
from robot.server import LINE_SILENCE_S, Server
from robot.session import Session
from tests.link.machines import STOP, Cable, Machine, noisy
from tests.rig import TOKEN, Rig


@pytest.fixture
def joined(tmp_path):
    """A cable, a machine at its end, and the address of the other end."""
    cable = Cable(tmp_path, noisy(1))
    machine = Machine(cable.paths["robot"])
    yield cable, machine, f"serial://{cable.paths['host']}?baud=115200"
    machine.close()
    cable.close()


def test_a_whole_conversation_over_a_noisy_line(joined):
    _, machine, uri = joined
    with Robot(make_link(uri), TOKEN, "serial") as robot:
        log = Log(robot.info())
        robot.add_tap(log)
        assert robot.describe("channels")[0]["name"] == "tick"
        robot.set(k=6.0)
        applied = robot.kick("position", ticks=3)
        while len(log) < 50:
            robot.wait(0.1)
        robot.stop()
        robot.wait(0.05)
        robot.remove_tap(log)
        assert robot.status()["state"] == "stopped"
    ticks = [record.tick for record in log.records]
    assert ticks == list(range(ticks[0], ticks[0] + len(ticks)))
    assert [record.tick for record in log.records if record.kick] == [
        applied,
        applied + 1,
        applied + 2,
    ]
    assert [event["event"] for event in log.events] == ["snapshot", "params", "kick", "stop"]
    box = machine.loop.blackbox
    assert log.records[:30] == unpack(b"".join(box.read(tick, 1) for tick in ticks[:30]))


def test_a_start_whose_answer_the_line_loses_is_not_sent_again(robot, link, monkeypatch):
    """Somebody may have stopped the robot meanwhile. A question is asked again.

    In virtual time, so that no line is taken for broken because the machine is busy.
    """
    monkeypatch.setattr(type(link), "is_line", True)
    robot.stop()
    robot.lease()
    heard = []
    receive = Session.receive

    def mute(session, kind, payload):
        answer = receive(session, kind, payload)
        what = next((word for word in (b'"start"', b'"describe"') if word in payload), None)
        if what is None:
            return answer
        heard.append(what)
        return answer if what in heard[:-1] else b""

    monkeypatch.setattr(Session, "receive", mute)
    assert robot.describe("channels")
    with pytest.raises(NoLink, match="does not answer to 'start'") as caught:
        robot.start()
    assert "Then start it again, if you still want to" in caught.value.hint
    assert heard == [b'"describe"', b'"describe"', b'"start"']


def test_a_line_that_comes_off_is_taken_up_again_without_a_gap(joined, monkeypatch):
    # A reply that the line loses is asked for again after a silence, well before the host gives up.
    monkeypatch.setattr(Robot, "silence_s", 1.0)
    monkeypatch.setattr(Robot, "answer_s", 5.0)
    cable, machine, uri = joined
    machine.loop.set_params({"link_loss": "continue"})
    with Robot(make_link(uri), TOKEN, "serial") as robot:
        log = Log()
        robot.add_tap(log)
        robot.wait(0.1)
        cable.unplug()
        threading.Timer(0.2, cable.plug).start()
        robot.wait(0.5)
        robot.kick("membrane")
        robot.wait(0.05)
        assert robot.link.uri == uri
    assert log.missing() == []
    assert len(log.kicks()) == 1
    assert not [event for event in log.events if event["event"] == "lost"]


def test_the_robot_ends_its_side_with_its_program(joined):
    _, machine, uri = joined
    with Robot(make_link(uri), None) as robot:
        robot.wait(0.05)
    machine.close()
    assert machine.server._peers == []
    assert STATES[machine.loop.safety.state] == "running"


# The robot's side alone, in virtual time


@pytest.fixture
def line():
    """A rig, its server, and the file descriptor of its serial line's far end."""
    rig = Rig()
    rig.loop.start()
    server = Server(rig.loop, TOKEN)
    # A pair of sockets hands on at once what is written, a pseudo-terminal when the kernel likes.
    near, robots_end = socket.socketpair()
    master = near.detach()
    far = os.fdopen(robots_end.detach(), "r+b", buffering=0)
    os.set_blocking(far.fileno(), False)
    server.attach(lambda: far)
    yield rig, server, master
    server.close()
    far.close()
    os.close(master)


def served(rig, server, seconds=0.03):
    """Serve until the line has been heard, and let time pass."""
    for _ in range(20):
        server.serve(0.0)
    rig.clock.time += seconds


def test_a_line_that_takes_more_again_stays_open(tmp_path):
    """As after a pause, when many records wait. A real terminal: a pair of sockets does not err."""
    rig = Rig()
    rig.loop.start()
    master, slave = os.openpty()
    os.set_blocking(master, False)
    server = Server(rig.loop, TOKEN)
    server.attach(SerialLine(os.ttyname(slave), print).open)
    server.serve(0.0)
    (peer,) = server._peers
    sent = 400_000
    peer.out += b"." * sent
    server._turns.call(peer)
    while sent:
        server.serve(0.0)
        with suppress(BlockingIOError):
            sent -= len(os.read(master, 4096))
        assert server._peers == [peer]
    server.close()
    os.close(master)
    os.close(slave)


def test_a_silent_line_stays_open(line):
    rig, server, _ = line
    for _ in range(300):
        served(rig, server, 1.0) if rig.clock.time < 3 else server.serve(0.0)
    assert len(server._peers) == 1


@pytest.mark.parametrize(
    "noise",
    [
        b"",
        b"\xff",
        b"\xa5",
        Random(1).randbytes(100).replace(wire.SYNC, b""),
        wire.SYNC + b"\x63",
        STOP[:3] + STOP,
    ],
)
def test_a_stop_behind_noise_is_heard(line, noise):
    rig, server, master = line
    os.write(master, noise + STOP)
    served(rig, server)
    served(rig, server)
    assert STATES[rig.loop.safety.state] == "stopped"


@pytest.mark.parametrize(
    "header", [wire.SYNC + b"\x08\x0f\xff", wire.SYNC + b"\x03\x10\x00" + STOP[:2]]
)
def test_a_stop_behind_what_looks_like_a_long_frame_is_heard_once_the_line_falls_silent(
    line, header
):
    """A flipped bit in a length would otherwise swallow everything for kilobytes."""
    rig, server, master = line
    os.write(master, header + STOP)
    served(rig, server)
    assert STATES[rig.loop.safety.state] == "running"
    rig.clock.time += LINE_SILENCE_S
    served(rig, server)
    assert STATES[rig.loop.safety.state] == "stopped"


def test_a_frame_that_arrives_in_pieces_is_not_torn_apart(line):
    rig, server, master = line
    for byte in STOP[:-1]:
        os.write(master, bytes([byte]))
        served(rig, server, 0.9 * LINE_SILENCE_S)
    assert STATES[rig.loop.safety.state] == "running"
    os.write(master, STOP[-1:])
    served(rig, server)
    assert STATES[rig.loop.safety.state] == "stopped"


def test_a_refused_conversation_on_a_line_can_begin_anew_but_not_go_on(line):
    rig, server, master = line
    os.write(master, wire.encode(wire.ASK, b"{}"))
    served(rig, server)
    (peer,) = server._peers
    assert not peer.session.closing
    assert wire.load(_one_frame(master)[1])["error"]["code"] == "broken"
    os.write(
        master,
        wire.encode_json(
            wire.HELLO, {"protocol": [1, 0], "name": "n", "client": "c", "nonce": "00" * 16}
        ),
    )
    served(rig, server)
    assert _one_frame(master)[0] == wire.HELLO
    os.write(master, wire.encode(wire.COMMAND, bytes(30)))
    served(rig, server)
    assert wire.load(_one_frame(master)[1])["error"]["code"] == "token"
    os.write(master, wire.encode_json(wire.ASK, {"id": 1, "do": "status"}))
    served(rig, server)
    assert wire.load(_one_frame(master)[1])["error"]["code"] == "broken"


def _one_frame(master):
    decoder = wire.Decoder()
    decoder.feed(os.read(master, 4096))
    frame = decoder.next()
    assert decoder.next() is None
    return frame


def test_a_line_that_cannot_be_opened_is_tried_again_now_and_then():
    rig = Rig()
    server = Server(rig.loop, TOKEN)
    tries = []

    def opens():
        tries.append(rig.clock.time)
        raise OSError("no such line")

    server.attach(opens)
    for _ in range(100):
        rig.clock.wait(rig.loop.deadline, server.serve)
        rig.loop.tick()
    assert len(tries) == 3


def test_a_missing_port_is_told_in_words(tmp_path):
    with pytest.raises(NoLink) as error:
        Robot(make_link(f"serial://{tmp_path / 'nothing'}"), None)
    assert "cannot be opened" in error.value.message
    assert Path(tmp_path).exists()
