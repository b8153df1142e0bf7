"""Nothing is imported, forked or compiled once the loop runs, and no tick waits for it.

The robot's real program, with requests of every kind, over plain files and a pseudo-terminal.
"""

import binascii
import os
import pty
import re
import select
import signal
import socket
import subprocess
import sys
import time
import tty

import pytest

from robot import commands, token, wire
from robot.button import BACK, EVENT, KEY, PRESSED
from tests.sysfs.plain import plain_battery, plain_lights, plain_motor

ROOT = wire.__file__.rpartition("robot")[0]
PATIENCE_S = 30.0
# The robot's program. From the moment on that its loop runs, it writes down what no loop may do.
PROGRAM = """
import os, re, subprocess, sys
from robot import __main__, button, loop

LATE = os.open(sys.argv.pop(1), os.O_WRONLY | os.O_CREAT | os.O_APPEND)
button.BackButton.__init__.__defaults__ = (sys.argv.pop(1),)

def forbid(owner, name):
    real = getattr(owner, name)
    def noted(*arguments, **named):
        os.write(LATE, "{} {!r:.80}\\n".format(name, arguments).encode())
        return real(*arguments, **named)
    setattr(owner, name, noted)

class Door:
    def find_spec(self, name, path=None, target=None):
        os.write(LATE, "import {}\\n".format(name).encode())

def run(self, serve, real=loop.Loop.run):
    sys.meta_path.insert(0, Door())
    for owner, name in (
        (os, "fork"), (os, "popen"), (os, "system"), (subprocess.Popen, "__init__"),
        (getattr(re, "_compiler", None) or re.sre_compile, "compile"),
    ):
        forbid(owner, name)
    real(self, serve)

loop.Loop.run = run
sys.exit(__main__.main())
"""


class Host:
    """A host's end of a link, which is a descriptor."""

    def __init__(self, fd, secret, name="anna"):
        self.fd, self.secret, self.name = fd, secret, name
        self.decoder = wire.Decoder()
        self.counter = 0
        self.number = 0
        self.key = b""

    def send(self, kind, payload):
        os.write(self.fd, wire.encode(kind, payload))

    def answer(self, kinds=(wire.HELLO, wire.AUTH, wire.REPLY)):
        """The next message of some kinds; {} when the robot hangs up."""
        until = time.monotonic() + PATIENCE_S
        while True:
            frame = self.decoder.next()
            if frame is not None:
                if frame[0] in kinds:
                    return wire.load(frame[1]) if frame[0] != wire.SAMPLES else frame
                continue
            assert select.select([self.fd], (), (), until - time.monotonic())[0], "no answer"
            data = os.read(self.fd, 4096)
            if not data:
                return {}
            self.decoder.feed(data)

    def say(self, kind, payload):
        self.send(kind, payload)
        return self.answer()

    def hello(self, **changes):
        nonce = binascii.hexlify(os.urandom(wire.NONCE_BYTES)).decode("ascii")
        message = {"protocol": wire.PROTOCOL, "name": self.name, "client": self.name}
        message.update(nonce=nonce, token=True)
        message.update(changes)
        return message, self.say(wire.HELLO, wire.dump(message))

    def greet(self):
        """Say hello, and prove the token."""
        message, answer = self.hello()
        nonces = [binascii.unhexlify(one["nonce"]) for one in (message, answer)]
        shake = wire.Handshake(self.secret, *nonces)
        proof = binascii.hexlify(shake.host_proof).decode("ascii")
        assert "proof" in self.say(wire.AUTH, wire.dump({"proof": proof}))
        self.counter, self.key = 0, shake.key
        return self

    def ask(self, do, sealed=False, **arguments):
        """The result of a request, or the code of its refusal."""
        self.number += 1
        body = wire.dump(dict(arguments, do=do, id=self.number))
        if sealed:
            self.counter += 1
            body = wire.seal(self.key, self.counter, body)
        answer = self.say(wire.COMMAND if sealed else wire.ASK, body)
        return answer["error"]["code"] if "error" in answer else answer["result"]

    def tell(self, do, **arguments):
        return self.ask(do, sealed=True, **arguments)

    def until(self, state):
        """Wait for a state of the robot, and beat meanwhile."""
        until = time.monotonic() + PATIENCE_S
        while True:
            self.tell("heartbeat")
            status = self.ask("status")
            if status["state"] == state:
                return status
            assert time.monotonic() < until, (status["state"], status["reason"])
            time.sleep(0.02)


class Brick:
    """The robot's program, its files, and both ends of its serial line."""

    def __init__(self, folder):
        self.folder = folder
        self.root = folder / "class"
        self.motors = [
            plain_motor(self.root, number, port) for number, port in enumerate(("outB", "outC"))
        ]
        plain_battery(self.root)
        plain_lights(self.root)
        self.line = str(folder / "line")
        self.far = self.plug_line()
        self.buttons = str(folder / "buttons")
        os.mkfifo(self.buttons)
        self.secret = token.load_or_make(str(folder / "secret"))[0]
        self.log = str(folder / "late")
        arguments = ["--sysfs", str(self.root), "--host", "127.0.0.1", "--port", "0"]
        arguments += ["--token", str(folder / "secret"), "--tick", "0.01", "--serial", self.line]
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, self.log, self.buttons, *arguments],
            bufsize=0,
            cwd=ROOT,
            env=dict(os.environ, LC_ALL="C", PYTHONCOERCECLOCALE="0", PYTHONUTF8="0"),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        ready = self.process.stdout.readline().decode()
        assert ready.startswith("READY"), self.process.communicate()[1]
        self.port = int(ready.rpartition(":")[2])

    def plug_line(self):
        """A new serial line under the same name. Returns the other end's descriptor."""
        far, near = pty.openpty()
        tty.setraw(far)
        tty.setraw(near)
        os.symlink(os.ttyname(near), self.line + "-new")  # noqa: PTH211
        os.rename(self.line + "-new", self.line)  # noqa: PTH104
        os.close(near)
        return far

    def host(self, name="anna"):
        link = socket.create_connection(("127.0.0.1", self.port))
        return Host(link.detach(), self.secret, name)

    def until(self, command):
        """Wait for the motors to get a command."""
        until = time.monotonic() + PATIENCE_S
        while not all((motor / "command").read_text().startswith(command) for motor in self.motors):
            assert time.monotonic() < until
            time.sleep(0.01)

    def said(self, words):
        """Wait for a line on the program's standard error."""
        line = ""
        while not re.search(words, line):
            assert select.select([self.process.stderr], (), (), PATIENCE_S)[0]
            line = self.process.stderr.readline().decode()

    def end(self):
        """What the program did that no loop may do, line by line."""
        self.process.send_signal(signal.SIGTERM)
        self.process.communicate(timeout=PATIENCE_S)
        assert self.process.returncode == 0
        with open(self.log) as file:  # noqa: PTH123
            return file.read().splitlines()


@pytest.fixture
def brick(tmp_path):
    brick = Brick(tmp_path)
    yield brick
    if brick.process.poll() is None:
        brick.process.kill()
        brick.process.communicate()
    os.close(brick.far)


KICKS = [
    {"mode": "membrane"},
    {"mode": "position", "ticks": 2, "shape": "smooth"},
    {"mode": "phase", "ticks": 2},
    {"mode": "pulse", "param": "k", "value": 2.0, "ticks": 2, "wheel": "left"},
    {"mode": "jump", "variable": "x1", "delta": 1.0},
]
WRONG = [
    ("kick", {"kick": 1}),
    ("kick", {"kick": {"id": "w", "mode": "\u00e9"}}),
    ("kick", {"kick": {"id": "w", "mode": "phase", "ticks": 1.5}}),
    ("set", {"set": {"k": "2,5"}}),
    ("set", {"set": {"tau_s": 0.001}}),
    ("set", {"set": {}}),
    ("lease", {"take_over": "\ud800"}),
    ("identify", {"\u4e00": 1}),
    ("describe", {"table": "\U0001f9be"}),
    ("subscribe", {"from": 10**12}),
    ("dance", {}),
]
BROKEN = [
    (wire.HELLO, b"\xff"),
    (wire.HELLO, b"[" * 4000),
    (wire.HELLO, b'{"protocol": NaN}'),
    (wire.HELLO, b'{"protocol": [9, 9]}'),
    (wire.ASK, b"{}"),
    (wire.SAMPLES, b""),
    (wire.COMMAND, b"unsealed"),
]


def _drive(brick, host):
    """Every command, and every way to be refused."""
    strange = {"params": "params", "channels": "channels", "commands": "commands"}
    for table in strange:
        assert host.ask("describe", table=table)["table"]
    assert host.ask("subscribe", **{"from": 0})["tick"] == 0
    host.answer(kinds=(wire.EVENT,))
    host.answer(kinds=(wire.SAMPLES,))
    assert host.ask("unsubscribe") == {}
    assert "lights" in host.ask("identify")["ways"]
    assert host.tell("lease") == {}
    host.until("running")
    for number, kick in enumerate(KICKS):
        while host.tell("kick", kick=dict(kick, id=str(number))) == "busy":
            time.sleep(0.01)
    for do, arguments in WRONG:
        assert isinstance(host.tell(do, **arguments), str)
    assert "tick" in host.tell("set", set={"k": 6.0, "battery_compensation": "on"})
    assert "tick" in host.tell("stop")
    assert host.tell("clear") == "state"
    assert "tick" in host.tell("start")


def _lose(brick, host):
    """Links, hosts and motors that go away."""
    second = brick.host("bert").greet()
    assert second.tell("lease") == "lease"
    assert second.tell("lease", take_over=True) == {}
    second.until("running")
    os.close(second.fd)
    while host.ask("status")["state"] == "running":
        time.sleep(0.02)  # until bert counts as lost
    assert host.tell("lease") == {}
    assert "tick" in host.tell("start")
    (brick.motors[0] / "position").write_text("", encoding="ascii")
    host.until("fault")
    (brick.motors[0] / "position").write_text("7", encoding="ascii")
    assert "tick" in host.tell("clear")
    assert "tick" in host.tell("set", set={"link_loss": "continue"})
    assert "tick" in host.tell("start")
    brick.until("run-direct")
    brick.process.send_signal(signal.SIGSTOP)
    brick.until("stop")  # by the watchdog
    brick.process.send_signal(signal.SIGCONT)
    assert host.tell("lease") == {}
    host.until("fault")
    assert "tick" in host.tell("clear")


def test_nothing_is_imported_or_started_once_the_loop_runs(brick):
    for kind, payload in BROKEN:
        stranger = brick.host("stranger")
        assert "error" in stranger.say(kind, payload)
        os.close(stranger.fd)
    noisy = brick.host("noisy")
    os.write(noisy.fd, b"GET / HTTP/1.1\r\n\r\n")
    assert "error" in noisy.answer()
    os.close(noisy.fd)
    stopper = brick.host("stopper")
    assert "result" in stopper.say(wire.STOP, wire.dump({"name": "\u00e9\U0001f9be"}))
    assert "error" in stopper.say(wire.AUTH, wire.dump({"proof": "00"}))
    os.close(stopper.fd)

    host = brick.host().greet()
    assert {row.name for row in commands.TABLE.values() if not row.sealed} == {
        "status",
        "describe",
        "subscribe",
        "unsubscribe",
        "identify",
    }
    assert host.tell("lease") == {}
    assert "tick" in host.tell("start")
    _drive(brick, host)
    with open(brick.buttons, "wb") as button:  # noqa: PTH123
        button.write(EVENT.pack(1, 2, KEY, BACK, PRESSED))
    assert "back button" in host.until("stopped")["reason"]
    assert "tick" in host.tell("start")
    _lose(brick, host)

    line = Host(brick.far, brick.secret, "carla").greet()
    assert line.ask("status")["state"] == "stopped"
    os.close(brick.far)
    brick.said("the serial line .* broke")
    brick.far = brick.plug_line()
    brick.said("the serial line .* was opened again")
    Host(brick.far, brick.secret, "carla").greet()

    assert host.tell("lease") == {}
    assert "tick" in host.tell("start")
    plain_battery(brick.root, 5.9)
    assert "battery" in host.until("stopped")["reason"]
    assert brick.end() == []
