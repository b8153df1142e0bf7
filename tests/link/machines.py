"""Robots for tests of links: on a rig in virtual time, and in real time behind TCP and a cable."""

import os
import select
import socket
import threading
import time
import tty
from contextlib import suppress
from pathlib import Path
from random import Random
from types import SimpleNamespace

from host.errors import NoLink
from host.link.sim import SimLink
from host.link.transport import TcpLink
from robot import wire
from robot.loop import Loop
from robot.motors import MonotonicClock
from robot.record import unpack
from robot.serial_line import SerialLine
from robot.server import Server
from tests.rig import TOKEN, Clock, Motor

STOP = wire.encode(wire.STOP, b"")
TICK_S = 0.01


class RigLink(SimLink):
    """An embedded robot on the rig. Its link can be cut anywhere; it can go away and restart."""

    def __init__(self, capacity=20000):
        clock = Clock()
        super().__init__(
            "sim://rig",
            SimpleNamespace(
                motors=(Motor(turn=0.1), Motor(turn=0.2)), battery=None, clock=clock, seed=1
            ),
        )
        self.capacity = capacity
        self.loop.blackbox.__init__(self.loop.params.values(), capacity)
        self.loop.safety.__init__()
        self.loop.start()
        self.left = None
        self.forgotten = False
        self.opened = 0
        self.away_until = 0.0

    def open(self):
        if self.now() < self.away_until:
            self.run_tick()
            raise NoLink("the robot is away")
        super().open()
        self.forgotten = False
        self.opened += 1

    def send(self, data):
        if not self.forgotten:
            super().send(data)

    def receive(self, timeout_s):
        if self.forgotten:
            until = self.now() + timeout_s
            while self.now() < until:
                self.run_tick()
            return b""
        data = super().receive(timeout_s)
        if self.left is not None:
            data, self.left = data[: self.left], self.left - len(data)
            if self.left <= 0:
                self.cut()
        return data

    def cut(self, away_s=0.0):
        """Lose the link, and everything on its way."""
        self.left = None
        self.close()
        self.away_until = self.now() + away_s

    def forget(self):
        """Carry nothing any more, and say nothing of it; a new connection works."""
        self.forgotten = True

    def restart(self):
        """Another boot of the same robot."""
        self.close()
        self.loop = Loop(self.brick.motors, None, self.brick.clock, 2)
        self.server = Server(self.loop, self.token)
        self.loop.start()

    def records(self):
        box = self.loop.blackbox
        return unpack(b"".join(box.read(tick, 1) for tick in range(box.oldest_tick, box.next_tick)))

    def events(self):
        return [event for _, event in self.loop.blackbox._journal]


class TcpRobot:
    """A robot's program in a thread, in real time."""

    def __init__(self, host="127.0.0.1", **params):
        self.loop = Loop((Motor(turn=0.1), Motor(turn=0.1)), None, MonotonicClock(), 1)
        self.loop.set_params({"tick_s": 0.01, **params})
        self.server = Server(self.loop, TOKEN)
        self.port = self.server.listen(host, 0)
        self.loop.start()
        self._thread = threading.Thread(target=self.loop.run, args=(self.server.serve,))
        self._thread.start()

    def link(self):
        return TcpLink(f"tcp://127.0.0.1:{self.port}", "127.0.0.1", self.port)

    def close(self):
        self.loop.done = True
        self._thread.join()
        if self.server is not None:
            self.server.close()
            self.server = None


class Middlebox:
    """A port that carries connections on to another one, and may forget those that there are.

    It ends none of them, as a router that has forgotten them does; new ones work.
    """

    def __init__(self, port):
        self._target = ("127.0.0.1", port)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self.accepted = 0
        self._pairs = {}
        self._kept = []
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._carry)
        self._thread.start()

    def forget(self):
        with self._lock:
            self._kept += self._pairs
            self._pairs.clear()

    def close(self):
        self._ended.set()
        self._thread.join()
        for end in (self._listener, *self._pairs, *self._kept):
            end.close()

    def _carry(self):
        while not self._ended.is_set():
            with self._lock:
                pairs = dict(self._pairs)
            for end in select.select((self._listener, *pairs), (), (), 0.005)[0]:
                if end is self._listener:
                    near, far = end.accept()[0], socket.create_connection(self._target)
                    self.accepted += 1
                    with self._lock:
                        self._pairs.update({near: far, far: near})
                    continue
                with self._lock:
                    other = self._pairs.get(end)
                if other is not None:
                    try:
                        data = end.recv(65536)
                        other.sendall(data)
                    except OSError:
                        data = b""
                    if not data:
                        with self._lock:
                            self._kept += [end, other]
                            self._pairs.pop(end, None)
                            self._pairs.pop(other, None)
                        for one in (end, other):
                            with suppress(OSError):
                                one.shutdown(socket.SHUT_RDWR)


class Cable:
    """Two serial ports, `robot` and `host`, and what joins them.

    Between frames it adds what `noise` returns.
    """

    def __init__(self, folder, noise=lambda: b""):
        self.paths = {name: folder / name for name in ("robot", "host")}
        self.noise = noise
        self._masters = {}
        self._decoders = {}
        self._ended = threading.Event()
        self.plug()
        self._thread = threading.Thread(target=self._carry)
        self._thread.start()

    def plug(self):
        """Make the ports appear."""
        masters = {}
        for name, path in self.paths.items():
            masters[name], slave = os.openpty()
            tty.setraw(slave)
            os.set_blocking(masters[name], False)
            path.symlink_to(os.ttyname(slave))
            os.close(slave)
            self._decoders[name] = wire.Decoder()
        self._masters = masters

    def unplug(self):
        """Take the ports away, also from programs that have them open."""
        masters, self._masters = self._masters, {}
        time.sleep(0.02)
        for path in self.paths.values():
            path.unlink(missing_ok=True)
        for master in masters.values():
            os.close(master)

    def close(self):
        self._ended.set()
        self._thread.join()
        self.unplug()

    def _carry(self):
        while not self._ended.is_set():
            masters = self._masters
            try:
                for name in masters:
                    other = masters["host" if name == "robot" else "robot"]
                    if select.select((masters[name],), (), (), 0.001)[0]:
                        self._decoders[name].feed(os.read(masters[name], 4096))
                    while (frame := self._decoders[name].next()) is not None:
                        os.write(other, self.noise() + wire.encode(*frame))
            except OSError:
                # Nobody has the other port open, or it came off.
                time.sleep(0.002)


class Machine:
    """A robot's program in a thread, in real time, at the end of a cable."""

    def __init__(self, path, token=TOKEN):
        self.loop = Loop((Motor(turn=0.1), Motor(turn=0.1)), None, MonotonicClock(), 1)
        self.loop.set_params({"tick_s": TICK_S})
        self.server = Server(self.loop, token)
        self.server.attach(SerialLine(str(path), lambda text: None).open)
        self.loop.start()
        self._thread = threading.Thread(target=self.loop.run, args=(self.server.serve,))
        self._thread.start()
        while not self.server._peers:
            time.sleep(0.001)

    def close(self):
        self.loop.done = True
        self._thread.join()
        self.server.close()


def noisy(seed):
    random = Random(seed)
    return lambda: (
        random.randbytes(random.randrange(12))
        if random.random() < 0.5
        else random.choice((b"", b"\xa5", wire.SYNC, STOP[:6]))
    )


def open_files():
    """How many files this process has open."""
    return len(list(Path("/proc/self/fd").iterdir()))
