"""A stop waits for nothing, and never says that motors are off when nobody has seen it."""

import signal
import socket
import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from host.client.robot import Robot, connect
from host.client.stop import Stopped, confirmation, stop_frame, stop_robot
from host.errors import KickctlError, NoLink
from host.link.addresses import make_link
from host.link.transport import TcpLink
from host.util.own_name import own_name
from robot import wire
from robot.record import STATES
from robot.session import Session
from tests.link.machines import Cable, Machine, TcpRobot
from tests.rig import TOKEN, Rig

PATIENCE_S = 30.0  # nothing here takes so long; it only ends what would hang


@pytest.fixture
def machine():
    machine = TcpRobot(link_loss="continue")
    yield machine
    machine.close()


class Blocked:
    """A thread that holds a robot's lock while it waits for an answer that never comes."""

    def __init__(self, robot, monkeypatch):
        self.failure = None
        self._robot = robot
        self._reached = threading.Event()
        real = Session.receive

        def deaf(session, kind, payload):
            if kind == wire.ASK and b'"status"' in payload:
                self._reached.set()
                return b""
            return real(session, kind, payload)

        monkeypatch.setattr(Session, "receive", deaf)
        monkeypatch.setattr(Robot, "answer_s", PATIENCE_S)
        self.thread = threading.Thread(target=self._ask)
        self.thread.start()
        assert self._reached.wait(PATIENCE_S)

    def _ask(self):
        try:
            self._robot.status()
        except KickctlError as failure:
            self.failure = failure

    def end(self):
        """Let the thread give up."""
        self._robot._broken = NoLink("the test is over")
        self.thread.join(PATIENCE_S)


# It waits for nothing


def test_motors_are_off_before_the_next_tick_while_another_thread_has_the_lock(link):
    """In virtual time: nobody else lets it pass, so a stop that waited would wait for ever."""
    with Robot(link, link.token) as robot:
        taken, done = threading.Event(), threading.Event()

        def hold():
            with robot._lock:
                taken.set()
                done.wait(PATIENCE_S)

        holder = threading.Thread(target=hold)
        holder.start()
        taken.wait(PATIENCE_S)
        due = link.loop.blackbox.next_tick
        try:
            assert robot.stop() == due
        finally:
            done.set()
            holder.join()
    (stop,) = [event for event in link.events() if event["event"] == "stop"]
    assert (stop["tick"], stop["reason"]) == (due, f"'{own_name()}' stopped it")
    assert [motor.duty for motor in link.brick.motors] == [0, 0]


def test_a_thread_that_lets_virtual_time_pass_is_no_hindrance(link):
    with Robot(link, link.token) as robot:
        done = threading.Event()
        waiter = threading.Thread(target=robot.wait, args=(1e9, done.is_set))
        waiter.start()
        try:
            stopped = robot.stop_at_once()
            assert stopped.state == "stopped"
        finally:
            done.set()
            waiter.join()
    (stop,) = [event for event in link.events() if event["event"] == "stop"]
    assert stop["tick"] == stopped.tick


def test_a_stop_over_tcp_passes_a_request_that_is_never_answered(machine, monkeypatch):
    with Robot(machine.link(), TOKEN) as robot:
        blocked = Blocked(robot, monkeypatch)
        stopped = robot.stop_at_once()
        assert blocked.thread.is_alive()
        assert (stopped.state, STATES[machine.loop.safety.state]) == ("stopped", "stopped")
        assert machine.loop.blackbox.next_tick >= stopped.tick
        blocked.end()


def test_a_stop_over_a_serial_line_passes_a_request_that_is_never_answered(tmp_path, monkeypatch):
    """The line has one reader, the blocked thread: it hears the answer for the one that stops."""
    cable = Cable(tmp_path)
    machine = Machine(cable.paths["robot"])
    try:
        with Robot(make_link(f"serial://{cable.paths['host']}"), TOKEN, "serial") as robot:
            blocked = Blocked(robot, monkeypatch)
            stopped = robot.stop_at_once()
            assert blocked.thread.is_alive()
            assert stopped == Stopped(stopped.tick, "stopped", "'serial' stopped it")
            blocked.end()
    finally:
        machine.close()
        cable.close()


def test_a_stop_takes_the_open_link_when_no_second_one_can_be_opened(machine, monkeypatch):
    """As over a bridge from TCP to a serial line, which takes one connection."""

    def refuse(link):
        raise NoLink("taken")

    with Robot(machine.link(), TOKEN) as robot:
        monkeypatch.setattr(TcpLink, "open", refuse)
        assert robot.stop_at_once().state == "stopped"


def test_a_connection_that_was_closed_can_still_stop(machine):
    robot = Robot(machine.link(), TOKEN)
    robot.close()
    assert robot.stop() > 0
    assert STATES[machine.loop.safety.state] == "stopped"


def test_a_stop_and_a_start_follow_each_other(machine):
    """No second STOP of the first stop is still on its way."""
    with Robot(machine.link(), TOKEN) as robot:
        for _ in range(20):
            robot.stop()
            robot.start()
        robot.wait(0.2)
        assert robot.status()["state"] == "running"


def test_an_impatient_second_interrupt_does_not_end_the_stop(machine, monkeypatch):
    real = TcpLink.open

    def interrupted(link):
        signal.raise_signal(signal.SIGINT)
        real(link)

    with Robot(machine.link(), TOKEN) as robot:
        monkeypatch.setattr(TcpLink, "open", interrupted)
        with pytest.raises(KeyboardInterrupt):
            robot.stop()
        assert STATES[machine.loop.safety.state] == "stopped"


# It needs nothing of the robot but to understand STOP


def _other_version(session, message):
    return session.refuse("version", "protocol [1, 1] is not 9.0", "run the same release on both")


def _no_hello(session, message):
    return b""


@pytest.mark.parametrize("hello", [_other_version, _no_hello])
def test_a_robot_with_which_nobody_can_talk_is_stopped(machine, monkeypatch, hello):
    monkeypatch.setattr(Session, "_hello", hello)
    monkeypatch.setattr(Robot, "answer_s", 0.3)
    with pytest.raises(KickctlError):
        Robot(machine.link(), TOKEN)
    assert STATES[machine.loop.safety.state] == "running"
    assert stop_robot(machine.link()).state == "stopped"
    assert STATES[machine.loop.safety.state] == "stopped"


def test_the_stop_is_all_that_is_sent(machine, monkeypatch):
    kinds = []
    real = Session.receive

    def listen(session, kind, payload):
        kinds.append(kind)
        return real(session, kind, payload)

    monkeypatch.setattr(Session, "receive", listen)
    stop_robot(machine.link())
    assert set(kinds) == {wire.STOP}


def test_a_robot_of_protocol_1_0_answers_less(machine, monkeypatch):
    def old(session, payload):
        tick = session._loop.stop("stop frame")
        return wire.encode_json(wire.REPLY, {"id": None, "result": {"tick": tick}})

    monkeypatch.setattr(Session, "_stop", old)
    stopped = stop_robot(machine.link())
    assert (stopped.state, stopped.reason) == ("unknown", "")
    assert STATES[machine.loop.safety.state] == "stopped"


@pytest.mark.parametrize("name", ["a\x1b[2J\n", "x" * 100, "\U0001f9be" * 50, ""])
def test_the_name_of_who_stops_cannot_garble_a_screen(name):
    rig = Rig()
    rig.loop.start()
    decoder = wire.Decoder()
    decoder.feed(stop_frame(name))
    Session(rig.loop, TOKEN, "boot").receive(*decoder.next())
    shown = rig.loop.safety.reason.removesuffix(" stopped it")
    assert len(shown) <= 42
    assert shown.isprintable()


# It claims nothing that nobody has seen


class Listener:
    """A TCP port at which everybody is let in, and which then does what `serve` says."""

    def __init__(self, serve):
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self._serve = serve
        self._thread = threading.Thread(target=self._accept)
        self._thread.start()

    def link(self):
        return TcpLink(f"tcp://127.0.0.1:{self.port}", "127.0.0.1", self.port)

    def _accept(self):
        with self._socket, self._socket.accept()[0] as peer:
            self._serve(peer)

    def close(self):
        self._thread.join()


def _say_nothing(peer):
    while peer.recv(4096):
        pass


def _hang_up(peer):
    peer.recv(4096)


def _refuse(peer):
    refusal = {"id": None, "error": {"code": "broken", "message": "what?", "hint": ""}}
    peer.sendall(wire.encode_json(wire.REPLY, refusal))
    _say_nothing(peer)


def _talk_rubbish(peer):
    peer.sendall(bytes(range(256)) * 10)
    _say_nothing(peer)


@pytest.mark.parametrize("serve", [_say_nothing, _hang_up, _refuse, _talk_rubbish])
def test_a_stop_that_nobody_confirms_is_no_success(serve):
    listener = Listener(serve)
    try:
        with pytest.raises(NoLink, match="motors may still be running") as error:
            stop_robot(listener.link(), patience_s=0.3)
        assert "the robot's port?" in error.value.hint
    finally:
        listener.close()


def test_a_stop_is_repeated_until_it_is_heard():
    """A line may lose a frame."""
    heard = []

    def serve(peer):
        decoder = wire.Decoder()
        while len(heard) < 3:
            decoder.feed(peer.recv(4096))
            heard.extend(iter(decoder.next, None))
        peer.sendall(wire.encode_json(wire.REPLY, {"id": None, "result": {"tick": 7}}))
        _say_nothing(peer)

    listener = Listener(serve)
    try:
        assert stop_robot(listener.link(), patience_s=PATIENCE_S).tick == 7
    finally:
        listener.close()


def _samples(rig):
    return wire.encode_samples(0, rig.loop.blackbox.read(0, rig.loop.blackbox.next_tick))


def _frame(data):
    decoder = wire.Decoder()
    decoder.feed(data)
    return decoder.next()


def test_a_record_with_the_motors_off_confirms_a_stop_and_one_with_them_on_does_not():
    """On a line that another program reads, the answer to STOP may go there."""
    rig = Rig()
    rig.loop.start()
    rig.run(3)
    assert confirmation(*_frame(_samples(rig))) is None
    rig.loop.stop("enough")
    rig.run(1)
    assert confirmation(*_frame(_samples(rig))) == Stopped(3, "stopped", "")


@given(st.sampled_from(wire.TYPES), st.binary(max_size=300))
def test_no_frame_of_another_protocol_makes_it_fail(kind, payload):
    assert confirmation(kind, payload) is None or kind in (wire.REPLY, wire.SAMPLES)


@pytest.mark.parametrize(
    "message",
    [
        {"id": None, "result": None},
        {"id": None, "result": {}},
        {"id": None, "result": {"tick": None}},
        {"id": None, "result": {"tick": 3, "state": "running"}},
        {"id": None, "result": {"tick": 3, "state": "held", "reason": "x"}},
        {"id": None, "result": {"tick": 3, "state": None}},
        {"id": None, "result": [1]},
        {"id": 1, "result": {"tick": 3}},
        {"result": {"tick": 3}},
    ],
)
def test_an_answer_that_is_none_to_a_stop_confirms_none(message):
    assert confirmation(wire.REPLY, wire.dump(message)) is None


@pytest.mark.parametrize(
    ("state", "claims"), [("stopped", True), ("fault", False), ("unknown", False)]
)
def test_only_a_robot_that_says_so_is_said_to_have_its_motors_stopped(state, claims):
    """A fault may be a motor that does not obey: people have to look."""
    sentence = Stopped(7, state, "left motor: it does not stop").sentence()
    assert ("motors stopped" in sentence) == claims
    assert ("look whether the wheels stand still" in sentence) == (state == "fault")


def test_the_embedded_robot_is_stopped_by_its_own_program_alone():
    with connect("sim://", seed=1) as robot, connect("sim://", seed=1) as other:
        robot.stop()
        assert other.status()["state"] == "running"


def test_a_stop_over_a_line_that_another_program_reads(tmp_path):
    """Each reader takes bytes from the other: the answer, or a record, comes through in the end."""
    cable = Cable(tmp_path)
    machine = Machine(cable.paths["robot"])
    uri = f"serial://{cable.paths['host']}"
    try:
        with Robot(make_link(uri), None, "reader") as reader, reader.recording() as log:
            reader.wait(0.1)
            assert stop_robot(make_link(uri), patience_s=PATIENCE_S).state == "stopped"
            assert STATES[machine.loop.safety.state] == "stopped"
            reader.wait(0.3)
        assert log.missing() == []
    finally:
        machine.close()
        cable.close()
