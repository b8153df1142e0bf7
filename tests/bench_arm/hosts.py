"""What runs on the emulated brick: a host that the robot serves between two ticks.

A line on standard output begins or ends each stretch that is to be counted.
"""

import binascii
import os
import socket
import sys

from robot import wire
from robot.loop import Loop
from robot.program import RECORDS_S
from robot.server import Server
from tests.bench_arm.tick import Clock
from tests.bench_arm.ways import our_motors

TOKEN = bytes(range(wire.TOKEN_BYTES))
NONCE = bytes(wire.NONCE_BYTES)
WARM_UP, REPEATS = 3, 20
RECORDED_TICKS = 100


class Brick:
    """A running robot, and a host at the other end of a socket pair."""

    def __init__(self, root):
        self.clock = Clock()
        self.loop = Loop(our_motors(root), None, self.clock, 1)
        self.loop.start()
        self.loop.set_params({"link_loss": "continue"})
        self.server = Server(self.loop, TOKEN, RECORDS_S)
        self.host = self.shake = None
        self.counter = 0

    def connect(self):
        """Open a new connection of the host; the one before is closed."""
        if self.host is not None:
            self.host.close()
            self.server.serve(0.0)
        self.host, link = socket.socketpair()
        self.host.setblocking(False)
        link.setblocking(False)
        self.server.adopt(link)

    def tick(self):
        """Let a control period pass."""
        self.clock.time = self.loop.deadline
        self.loop.tick()

    def talk(self, name, frame):
        """Have the robot answer a frame, as a stretch of this name. Returns the answer's frame."""
        self.tick()
        self.server.serve(0.0)
        self.read()
        self.host.send(frame)
        serve(name, self.server)
        answer = self.read()
        assert answer, name
        return answer[0]

    def read(self):
        """The frames that the robot has sent."""
        decoder, frames = wire.Decoder(), []
        try:
            decoder.feed(self.host.recv(65536))
        except BlockingIOError:
            return frames
        frame = decoder.next()
        while frame is not None:
            frames.append(frame)
            frame = decoder.next()
        return frames

    def hello(self):
        """Say who the host is."""
        facts = {
            "protocol": list(wire.PROTOCOL),
            "name": "anna",
            "client": "anna",
            "nonce": binascii.hexlify(NONCE).decode("ascii"),
            "token": True,
        }
        answer = wire.load(self.talk("hello", wire.encode_json(wire.HELLO, facts))[1])
        self.shake = wire.Handshake(TOKEN, NONCE, binascii.unhexlify(answer["nonce"]))

    def authenticate(self):
        """Prove the token."""
        proof = binascii.hexlify(self.shake.host_proof).decode("ascii")
        self.talk("auth", wire.encode_json(wire.AUTH, {"proof": proof}))

    def ask(self, name, do):
        """Ask for something that anyone may ask for."""
        self.talk(name, wire.encode_json(wire.ASK, {"id": 1, "do": do}))

    def sealed(self, name, kind, payload):
        """Send what only a host with the token may send."""
        self.counter += 1
        self.talk(name, wire.encode(kind, wire.seal(self.shake.key, self.counter, payload)))


def serve(name, server):
    """Serve once, as a stretch."""
    mark(name, "begin")
    server.serve(0.0)
    mark(name, "end")


def mark(name, edge):
    """Print the edge of a stretch."""
    os.write(1, (name + " " + edge + "\n").encode("ascii"))


def main(root):
    """Print 'NAME begin' and 'NAME end' around every stretch, and 'warm' when they count."""
    brick = Brick(root)
    for repeat in range(WARM_UP + REPEATS):
        if repeat == WARM_UP:
            os.write(1, b"warm\n")
        mark("nothing", "begin")
        mark("nothing", "end")
        brick.connect()
        brick.hello()
        brick.authenticate()
        brick.ask("status", "status")
        brick.counter = 0
        brick.sealed("lease", wire.COMMAND, b'{"id":1,"do":"lease"}')
        brick.sealed("beat", wire.BEAT, b"")
        brick.tick()
        serve("idle", brick.server)
        serve("again", brick.server)
    brick.ask("subscribe", "subscribe")
    for _ in range(RECORDED_TICKS):
        brick.tick()
        serve("records", brick.server)
        brick.read()


if __name__ == "__main__":
    main(sys.argv[1])
