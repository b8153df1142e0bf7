"""The robot's links over real sockets, in virtual time.

Whatever peers do, ticks go on, memory is bounded, and a stop is heard.
"""

import os
import socket
import struct
import time
from pathlib import Path

import pytest

from host.client.conversation import Conversation
from robot import server as server_module
from robot import wire
from robot.record import STATES
from robot.server import FULL_BYTES, GREETING_S, MAX_PEERS, STREAM_BYTES, Server
from tests.rig import TOKEN, Clock, Rig

STOP = wire.encode(wire.STOP, b"")
FRAME = wire.MAX_PAYLOAD + wire.OVERHEAD


class Desk(Rig):
    """A robot that listens on loopback, ticking only when told."""

    def __init__(self, clock=None, **parts):
        super().__init__(**parts)
        if clock is not None:
            self.clock = self.loop.clock = clock
        self.server = Server(self.loop, TOKEN)
        self.address = ("127.0.0.1", self.server.listen("127.0.0.1", 0))
        self.peers = []

    def run(self, ticks=1):
        for _ in range(ticks):
            self.clock.wait(self.loop.deadline, self.server.serve)
            self.loop.tick()

    def connect(self, **options):
        peer = Peer(self, **options)
        self.peers.append(peer)
        return peer

    def close(self):
        for peer in self.peers:
            peer.socket.close()
        self.server.close()


class Peer:
    """A host's end of a connection, which sends and reads only when told."""

    def __init__(self, desk, token=TOKEN, name="peer", receive_buffer=None):
        self.desk = desk
        self.talk = Conversation(token, name, name)
        self.stream = []
        self.socket = socket.socket()
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.connect(desk.address)
        self.socket.setblocking(False)

    def greet(self):
        """Say hello, prove the token; the robot ticks meanwhile."""
        self.talk.begin()
        self.send(self.talk.hello_frame())
        self._await(lambda: self.talk.hello)
        if self.talk.token:
            self.send(self.talk.auth_frame())
            self._await(lambda: self.talk.trusted)
        return self

    def send(self, data):
        """Send what the connection takes now; returns how much that was."""
        try:
            return self.socket.send(data)
        except BlockingIOError:
            return 0

    def ask(self, do, sealed=False, **arguments):
        """The result of a request; the robot ticks until it has come."""
        number, frame = self.talk.request(do, arguments, sealed)
        self.send(frame)
        answers = []

        def answered():
            answer = self.talk.answer(number)
            if answer is not None:
                answers.append(answer)
            return answers

        self._await(answered)
        return answers[0]

    def read(self):
        """Take in what has arrived. False if the robot has hung up."""
        try:
            while data := self.socket.recv(1 << 16):
                for item in self.talk.feed(data):
                    self.stream += [item] if isinstance(item, dict) else item.records
        except BlockingIOError:
            return True
        except ConnectionResetError:
            pass
        return False

    @property
    def hung_up(self):
        """Whether the robot has closed the connection, a moment for the loopback included."""
        for _ in range(200):
            if not self.read():
                return True
            self.desk.server.serve(0.0)
            time.sleep(0.0005)
        return False

    def _await(self, arrived):
        for _ in range(500):
            self.desk.run()
            self.read()
            if arrived():
                return
        raise AssertionError("no answer")


@pytest.fixture
def desk():
    desk = Desk(capacity=200)
    desk.loop.start()
    yield desk
    desk.close()


def open_files():
    return len(list(Path("/proc/self/fd").iterdir()))


def refusal(peer):
    """The reply that ended a connection."""
    data = b""
    peer.socket.settimeout(2.0)
    while piece := peer.socket.recv(4096):
        data += piece
    decoder = wire.Decoder()
    decoder.feed(data)
    kind, payload = decoder.next()
    assert (kind, decoder.next()) == (wire.REPLY, None)
    return wire.load(payload)


def test_ten_thousand_connections_in_a_row(desk):
    """Some hang up politely, some not, some send half a frame, some rubbish, some stay."""
    controller = desk.connect().greet()
    controller.ask("lease", sealed=True)
    files = open_files()
    ends = (b"", STOP[:5], b"GET / HTTP/1.1\r\n\r\n", wire.encode(wire.ASK, b"{}"))
    staying = []
    for number in range(10000):
        link = socket.create_connection(desk.address)
        if number % 5:
            link.send(ends[number % 4])
        if number % 3 == 0:
            link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if number % 97:
            link.close()
        else:
            staying.append(link)
        desk.server.serve(0.0)
        assert len(desk.server._peers) <= MAX_PEERS
        if number % 10 == 0:
            desk.run()
            controller.send(controller.talk.request("heartbeat", {}, sealed=True)[1])
            controller.read()
    for link in staying:
        link.close()
    desk.run(3)
    assert controller.ask("status")["controller"] == "peer"
    assert open_files() <= files
    assert desk.last.state == STATES.index("running")
    assert desk.loop.missed == 0


def test_a_hundred_connect_at_once_and_the_last_is_served(desk):
    peers = []
    for _ in range(100):
        link = socket.socket()
        link.setblocking(False)
        link.connect_ex(desk.address)
        peers.append(link)
    late = None
    for _ in range(400):
        desk.run()
        assert len(desk.server._peers) <= MAX_PEERS
        if late is None and desk.loop.blackbox.next_tick > 200:
            late = desk.connect().greet()
    assert late.ask("status")["missed"] == 0
    for link in peers:
        link.close()


def test_who_says_no_hello_is_hung_up_on(desk):
    silent, half, slow, greeted = (desk.connect() for _ in range(4))
    greeted.greet()
    half.send(STOP[:4])
    hello = slow.talk.hello_frame()
    for number in range(int((GREETING_S + 1.0) / 0.03)):
        slow.send(hello[number : number + 1] if number < len(hello) - 1 else b"")
        desk.run()
    assert silent.hung_up
    assert half.hung_up
    assert slow.hung_up
    assert greeted.ask("status")["state"] == "running"
    assert len(desk.server._peers) == 1


@pytest.mark.parametrize(
    "garbage",
    [
        b"GET / HTTP/1.1\r\nHost: robot\r\n\r\n",
        b"\x16\x03\x01\x02\x00" + bytes(100),
        b"\x00",
        STOP[:-1] + b"\xff" + STOP,
        b"x" + STOP,
        wire.encode(wire.ASK, b"[1]"),
        wire.encode(wire.SAMPLES, b""),
        wire.encode(wire.HELLO, b"\xff\xfe"),
        wire.encode(wire.COMMAND, bytes(24)),
    ],
)
def test_garbage_gets_a_refusal_and_is_hung_up_on(desk, garbage):
    before = desk.fingerprint()
    peer = desk.connect()
    peer.send(garbage)
    for _ in range(20):
        desk.server.serve(0.0)
        time.sleep(0.0005)
    message = refusal(peer)
    assert message["id"] is None
    assert message["error"]["code"] in ("broken", "version")
    assert desk.fingerprint() == before
    assert desk.server._peers == []


def test_a_stream_of_garbage_is_cut_off(desk):
    peer = desk.connect()
    sent = 0
    for _ in range(200):
        try:
            sent += peer.send(os.urandom(50000))
        except ConnectionError:
            break
        desk.run()
        assert all(len(link.decoder._buffer) <= 2 * FRAME for link in desk.server._peers)
    else:
        pytest.fail("never cut off")
    assert desk.server._peers == []


def test_a_peer_that_never_reads_delays_nobody_and_costs_bounded_memory(desk):
    deaf = desk.connect(receive_buffer=65536).greet()
    deaf.send(deaf.talk.request("subscribe", {"from": 0}, sealed=False)[1])
    reader = desk.connect(name="reader").greet()
    reader.ask("subscribe", **{"from": 0})
    largest = 0
    for _ in range(20000):
        desk.run()
        reader.read()
        largest = max(largest, *(len(link.out) for link in desk.server._peers))
    assert largest <= STREAM_BYTES + FRAME
    ticks = [item.tick for item in reader.stream if not isinstance(item, dict)]
    assert ticks == list(range(len(ticks)))
    assert len(ticks) >= 20000
    assert desk.loop.missed == 0
    # When it reads at last, it hears what it still can, and what is lost.
    while not deaf.stream or getattr(deaf.stream[-1], "tick", 0) < 20000:
        desk.run()
        assert deaf.read()
        time.sleep(0.0002)
    missing, due = 0, 0
    for item in deaf.stream:
        if isinstance(item, dict):
            if item["event"] == "lost":
                assert item["from"] == due
                missing += item["tick"] - item["from"]
                due = item["tick"]
        else:
            assert item.tick == due
            due += 1
    assert missing > 10000


def test_a_peer_that_asks_and_never_reads_is_not_read_either(desk):
    deaf = desk.connect(receive_buffer=4096).greet()
    question = wire.encode_json(wire.ASK, {"id": 1, "do": "describe", "table": "channels"})
    sent, largest, idle = 0, 0, 0
    while idle < 50:
        taken = deaf.send(question * 50)
        sent += taken
        idle = 0 if taken else idle + 1
        desk.run()
        largest = max(
            largest, *(len(link.out) + len(link.decoder._buffer) for link in desk.server._peers)
        )
    assert FULL_BYTES < largest <= FULL_BYTES + 3 * FRAME
    assert desk.loop.missed == 0


def test_a_stop_is_heard_before_the_next_tick_while_everybody_floods(desk):
    flooders = [desk.connect(name=f"flooder {number}").greet() for number in range(MAX_PEERS - 1)]
    frame = wire.encode_json(wire.ASK, {"id": 1, "do": "status"})
    for flooder in flooders:
        flooder.send(frame * 2000)
    desk.run(2)
    stranger = desk.connect()
    stranger.send(STOP)
    for flooder in flooders:
        flooder.send(frame * 500)
    tick = desk.loop.blackbox.next_tick
    desk.run()
    assert STATES[desk.records_from(tick)[0].state] == "stopped"
    assert desk.duties == (0, 0)


def test_a_stop_among_simultaneous_strangers_is_heard(desk):
    """All other places are taken by hosts with the token, so strangers push each other out."""
    for number in range(MAX_PEERS - 1):
        desk.connect(name=f"trusted {number}").greet()
    strangers = [desk.connect() for _ in range(4)]
    strangers[0].send(STOP)
    desk.run(1)
    assert STATES[desk.last.state] == "stopped"


class BusyClock(Clock):
    """Time passes with the work that is done, and by itself where there is none."""

    def wait(self, deadline, serve):
        while self.time < deadline:
            before = self.time
            serve(deadline - before)
            if self.time == before:
                self.time = deadline
        serve(0.0)


def test_the_work_that_a_tick_can_be_late_by_is_one_frame_of_each_peer(monkeypatch):
    """Every frame costs 1 ms here, and there is always another.

    A tick is at most one round of all peers late.
    """
    clock = BusyClock()
    desk = Desk(clock, capacity=2000)
    try:
        flooders = [desk.connect(name=f"flooder {number}").greet() for number in range(MAX_PEERS)]
        real = server_module.Session.receive

        def costly(session, kind, payload):
            clock.time += 0.001
            return real(session, kind, payload)

        monkeypatch.setattr(server_module.Session, "receive", costly)
        frame = wire.encode_json(wire.ASK, {"id": 1, "do": "unsubscribe"})
        first = desk.loop.blackbox.next_tick
        for _ in range(60):
            for flooder in flooders:
                flooder.send(frame * 100)
                flooder.read()
            desk.run()
        late = [record.late_s for record in desk.records_from(first)]
        assert desk.loop.missed == 0
        assert max(late) <= 0.001 * 2 * MAX_PEERS + 1e-6
        assert sum(value > 0.0005 for value in late) > 30, "nobody was busy"
    finally:
        desk.close()


def test_who_gives_way_when_all_places_are_taken(desk):
    """Strangers first, the longest there before others; then those with the token.

    The one that controls last.
    """
    holder = desk.connect(name="holder").greet()
    holder.ask("lease", sealed=True)
    trusted = [desk.connect(name=f"trusted {number}").greet() for number in range(3)]
    strangers = [
        desk.connect(token=None, name=f"stranger {number}").greet()
        for number in range(MAX_PEERS - 4)
    ]
    everybody = [*strangers, *trusted, holder]
    assert len(desk.server._peers) == MAX_PEERS
    gone = []
    for number in range(6):
        desk.connect(name=f"new {number}").greet()
        holder.send(holder.talk.request("heartbeat", {}, sealed=True)[1])
        gone += [peer for peer in everybody if peer not in gone and not peer.read()]
    assert [peer.talk._name for peer in gone] == [
        peer.talk._name for peer in [*strangers, *trusted][:6]
    ]
    assert holder.ask("status")["controller"] == "holder"


def test_closing_hangs_up_on_everybody(desk):
    peers = [desk.connect().greet() for _ in range(3)]
    files = open_files()
    desk.server.close()
    assert open_files() == files - 4
    assert all(not peer.read() for peer in peers)
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(desk.address)
