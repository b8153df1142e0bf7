"""A robot that listens on loopback in virtual time, and hosts that act only when a test says so."""

import socket
import time
from pathlib import Path

from host.client.conversation import Conversation
from robot import wire
from robot.server import SEND_BUFFER_BYTES, Server
from tests.rig import TOKEN, Rig

STOP = wire.encode(wire.STOP, b"")
FRAME = wire.MAX_PAYLOAD + wire.OVERHEAD


class Desk(Rig):
    """A robot that listens on loopback, which ticks only in `run`."""

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
    """A host's end of a connection, which sends and reads only when a test says so.

    A `paired` one is no TCP connection: what its end has read makes room at once, while TCP has
    timers of its own, which virtual time overtakes.
    """

    def __init__(self, desk, token=TOKEN, name="peer", receive_buffer=None, paired=False):
        self.desk = desk
        self.talk = Conversation(token, name, name)
        self.stream = []
        if paired:
            self.socket, robot_end = socket.socketpair()
            robot_end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SEND_BUFFER_BYTES)
            robot_end.setblocking(False)
            desk.server.adopt(robot_end)
        else:
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


def open_files():
    """How many files this process has open."""
    return len(list(Path("/proc/self/fd").iterdir()))
