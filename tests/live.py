"""The robot's program on the live file tree, a host behind a relay, and an observer."""

import errno
import os
import selectors
import signal
import socket
import threading
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from unittest import mock

from host.client.robot import connect
from host.errors import KickctlError
from host.logs.log import Log
from tests.sysfs.mount import ended, inject, motor_folder, started

PORTS = ("outB", "outC")
# Nothing here takes so long; it is only so that what never happens ends.
PATIENCE_S = 20.0
LOOK_S = 0.001
# A host that soon gives up a robot that is away, or twenty tries of each fault would take hours.
IMPATIENT = {"answer_s": 1.0, "reconnect_s": 0.3}
_GONE = (errno.ENODEV, errno.ENOENT)


def impatient():
    """A context in which hosts wait for less long than people would have them wait."""
    return mock.patch.multiple("host.client.connection.Connection", **IMPATIENT)


def wait_until(condition, what, found=lambda: ""):
    """Wait for a condition that does not take long to come true.

    what: the condition in words; found: what is there instead, for the message.
    """
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, f"{what}: not within {PATIENCE_S:g} s; {found()}"
        time.sleep(LOOK_S)


def open_files(pid):
    """How many files a process has open."""
    return len(list(Path(f"/proc/{pid}/fd").iterdir()))


class Watch:
    """The motors that are at some ports now, as the kernel's files show them."""

    def __init__(self, folder, ports=PORTS):
        self._states = [
            os.open(motor_folder(folder, port) / "state", os.O_RDONLY) for port in ports
        ]

    def running(self):
        """How many of them the kernel drives; one that is gone it does not."""
        return sum(bool(_read(state)) for state in self._states)

    def stopped_after(self, since):
        """Wait until all have stopped.

        Returns how long that took, in s since a moment of time.monotonic.
        """
        wait_until(lambda: not self.running(), "the motors stop")
        return time.monotonic() - since

    def close(self):
        for state in self._states:
            os.close(state)


def _read(descriptor):
    try:
        return os.pread(descriptor, 32, 0).strip()
    except OSError as error:
        if error.errno in _GONE:
            return b""
        raise


class Relay:
    """Carries one TCP connection after another to a robot.

    `silent` carries nothing, in either direction, as a cable that is out.
    """

    def __init__(self, port):
        self.silent = False
        self.closed = False
        self.refuses_until = 0.0
        self._target = ("127.0.0.1", port)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._others = {}
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._listener, selectors.EVENT_READ)
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._carry, daemon=True)
        self._thread.start()
        self.uri = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"

    def cut(self, seconds=0.0):
        """Break all connections, and refuse new ones for a while."""
        with self._lock:
            self.refuses_until = time.monotonic() + seconds
            for end in list(self._others):
                self._drop(end)

    def close(self):
        self.closed = True
        self._thread.join()
        self.cut()
        self._listener.close()
        self._selector.close()

    def _carry(self):
        while not self.closed:
            if self.silent:
                time.sleep(0.01)
                continue
            ready = self._selector.select(0.05)
            with self._lock:
                for key, _ in ready:
                    self._accept() if key.fileobj is self._listener else self._pass_on(key.fileobj)

    def _accept(self):
        near = self._listener.accept()[0]
        try:
            if time.monotonic() < self.refuses_until:
                raise OSError
            far = socket.create_connection(self._target, timeout=1.0)
        except OSError:
            near.close()
            return
        for one, other in ((near, far), (far, near)):
            one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._others[one] = other
            self._selector.register(one, selectors.EVENT_READ)

    def _pass_on(self, end):
        if end not in self._others or self.silent:
            return
        try:
            data = end.recv(65536)
            self._others[end].sendall(data)
        except OSError:
            data = b""
        if not data:
            self._drop(end)

    def _drop(self, end):
        for one in (end, self._others.get(end)):
            if one in self._others:
                del self._others[one]
                self._selector.unregister(one)
                one.close()


class Live:
    """A robot's program, the host `robot` connected to it, and the `log` of what that host got.

    folder: the mount; program: the module; environment: what its process gets besides; relayed:
    whether the link can be cut.
    """

    def __init__(self, folder, *options, program="robot", environment=None, relayed=False):
        self.folder = folder
        self.environment = environment or {}
        with mock.patch.dict(os.environ, self.environment):
            arguments = ("--sysfs", str(folder), "--host", "127.0.0.1", "--port", "0")
            self.process, self.address = started(program, *arguments, *options)
        self.said = None
        self.relay = Relay(int(self.address.rpartition(":")[2])) if relayed else None
        try:
            self.robot = connect(self.relay.uri if relayed else self.address)
            self.log = Log()
            self.robot.add_tap(self.log)
        except KickctlError:
            self.end()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        """Hang up and end the program."""
        with suppress(ProcessLookupError):
            self.process.send_signal(signal.SIGCONT)
        self.robot.close()
        self.end()

    def end(self):
        """End the program, whatever state it is in.

        `said` is what it wrote to its standard error.
        """
        if self.relay is not None:
            self.relay.close()
        self.said = ended(self.process)[1]
        self.process.stdout.close()
        self.process.stderr.close()

    @property
    def watchdog(self):
        """The number of the watchdog's process."""
        pid = self.process.pid
        return int(Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii").split()[0])

    def state(self):
        return self.robot.status()["state"]

    def reason(self):
        return self.robot.status()["reason"]

    def refusal(self, attempt):
        """The words with which a request of the host's fails; empty if it does not."""
        try:
            attempt()
        except KickctlError as error:
            return error.message
        return ""

    def run(self, chance):
        """Have it run, mended if it is in fault, and wait for a random moment of the run."""
        if self.state() == "fault":
            wait_until(lambda: not self.refusal(self.robot.clear), "the fault can be cleared")
        if self.state() != "running":
            self.robot.start()
        with self.watch() as watch:
            wait_until(
                lambda: watch.running() == len(PORTS) or self.state() == "fault",
                "the motors run",
                lambda: f"{watch.running()} do, {self.robot.status()}, {self.log.events[-10:]}",
            )
        assert self.state() == "running", f"it does not run: {self.reason()}"
        time.sleep(chance.uniform(0.1, 0.4))

    @contextmanager
    def watch(self, ports=PORTS):
        """A Watch on the motors at some ports."""
        watch = Watch(self.folder, ports)
        try:
            yield watch
        finally:
            watch.close()

    def inject(self, fault):
        inject(self.folder, fault)

    def reason_of(self, event, since=0):
        """The reason of the first event of a kind since event number `since`, once it is there."""

        def found():
            with suppress(KickctlError):  # what came before the link broke is in the log
                self.robot.pump(0.0)
            return [item["reason"] for item in self.log.events[since:] if item["event"] == event]

        wait_until(found, f"the host gets the event '{event}'", lambda: self.log.events[since:])
        return found()[0]
