"""A stand-in for the brick: a real sshd on loopback, and a checkout to deploy from.

Who logs in finds a folder of the test as home.
"""

import contextlib
import functools
import getpass
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import ev3dev2
import pytest

from tests.small_figures import without_figures

ROOT = Path(__file__).resolve().parents[2]
SSHD = shutil.which("sshd", path="/usr/sbin:/usr/local/sbin:" + os.environ["PATH"])
PRIVILEGE_SEPARATION = Path("/run/sshd")

needs_sshd = pytest.mark.skipif(
    SSHD is None, reason="there is no sshd: apt-get install openssh-server"
)

SSHD_CONFIG = """\
ListenAddress 127.0.0.1
Port {port}
HostKey {folder}/host_key
AuthorizedKeysFile {folder}/user_key.pub
PidFile none
StrictModes no
UsePAM no
PasswordAuthentication no
KbdInteractiveAuthentication no
PermitRootLogin prohibit-password
ForceCommand {folder}/login
# Or the login's shell would read what the user of this machine has it do at each start.
SetEnv HOME={folder}/brick/home
# The exchange that ssh prefers since quantum computers are feared costs eight times the computing.
KexAlgorithms curve25519-sha256
"""

# What a login on the brick finds: its own home, devices, settings and programs.
LOGIN = """\
#!/bin/sh
unset XDG_CONFIG_HOME KICK_TOKEN
export KICK_SYSFS={brick}/class KICK_ETC={brick}/etc KICK_RUN={brick}/run PATH={brick}/bin:$PATH
export KICK_PACKAGES={brick}/packages
cd
exec sh -c "$SSH_ORIGINAL_COMMAND"
"""

SSH_CONFIG = """\
Host brick
    HostName 127.0.0.1
    Port {port}
    User {user}
    IdentityFile {folder}/user_key
    IdentitiesOnly yes
    UserKnownHostsFile {folder}/known_hosts
    GlobalKnownHostsFile /dev/null
    StrictHostKeyChecking yes
"""


def free_port():
    """A port of loopback that nobody listens on just now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def write(path, text, mode=0o644):
    """Write a file, and the folders that it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    path.chmod(mode)


@functools.cache
def key(name):
    """A key of ssh, the same for the same name: its private part and its public one."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "key"
        subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", path], check=True)
        return tuple(each.read_text(encoding="utf-8") for each in (path, path.with_suffix(".pub")))


class Brick:
    """The machine behind sshd.

    `home` is its user's folder, `sysfs` its devices, `etc` its settings, `bin` its own programs.
    `name` tells it from other bricks of the same test: each has keys of its own.
    """

    def __init__(self, folder, name="brick"):
        self.folder = folder
        self.home, self.sysfs, self.etc, self.bin = (
            folder / "brick" / name for name in ("home", "class", "etc", "bin")
        )
        for path in (self.home, self.etc, self.bin):
            path.mkdir(parents=True)
        # Kept for sshd, and from everybody else who asks for any port that is free.
        self._port = socket.socket()
        self._port.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self._port.bind(("127.0.0.1", 0))
        self.port = self._port.getsockname()[1]
        self.replace("python3", f'exec {sys.executable} "$@"')
        (folder / "brick" / "packages").symlink_to(Path(ev3dev2.__file__).parents[1])
        self.ssh_config = folder / "ssh_config"
        for of in ("host_key", "user_key"):
            private, public = key(f"{of} of {name}")
            write(folder / of, private, 0o600)
            write(folder / f"{of}.pub", public)
        write(
            folder / "known_hosts",
            f"[127.0.0.1]:{self.port} {(folder / 'host_key.pub').read_text(encoding='utf-8')}",
        )
        write(folder / "login", LOGIN.format(brick=folder / "brick"), 0o755)
        self.reach_through(self.port)
        self._sshd = None

    def replace(self, program, script):
        """Have the brick run this shell script instead of one of its programs."""
        write(self.bin / program, f"#!/bin/sh\n{script}\n", 0o755)

    def configure(self, *lines):
        """Add lines to sshd's settings, before all others, and have it read them."""
        path = self.folder / "sshd_config"
        text = path.read_text(encoding="utf-8")
        before = self._starts()
        write(path, "\n".join((*lines, text)))
        self._sshd.send_signal(signal.SIGHUP)
        wait_until(lambda: self._starts() > before)

    def greet(self, words):
        """Have each login begin with these words, as the user's .bashrc on the brick might."""
        login = LOGIN.format(brick=self.folder / "brick")
        write(
            self.folder / "login", login.replace("\ncd\n", f"\nprintf '%s' '{words}'\ncd\n"), 0o755
        )

    def reach_through(self, port):
        """Have ssh reach the brick through another port of this machine."""
        settings = SSH_CONFIG.format(port=port, user=getpass.getuser(), folder=self.folder)
        write(
            self.ssh_config,
            settings.replace(
                "    StrictHostKeyChecking",
                f"    HostKeyAlias [127.0.0.1]:{self.port}\n    StrictHostKeyChecking",
            ),
        )

    def boot(self):
        """Start sshd, and wait until it listens."""
        # A sshd of root insists on this empty folder, which its service makes. It stays, for other
        # tests may run beside this one.
        if os.getuid() == 0:
            PRIVILEGE_SEPARATION.mkdir(mode=0o755, exist_ok=True)
        write(self.folder / "sshd_config", SSHD_CONFIG.format(port=self.port, folder=self.folder))
        with (self.folder / "sshd.log").open("w") as log:
            self._sshd = subprocess.Popen(
                [SSHD, "-D", "-e", "-f", self.folder / "sshd_config"], stderr=log
            )
        wait_until(self._starts)

    def take_card(self, other):
        """Have the brick hold what another one holds, as a copy of its card would."""
        left_out = shutil.ignore_patterns(
            "robot.pid", "robot.log*", "manager.pid", "notified", "systemctl.log"
        )
        for mine, theirs in ((self.home, other.home), (self.etc, other.etc)):
            shutil.copytree(theirs, mine, symlinks=True, ignore=left_out, dirs_exist_ok=True)
        # What names a place of the other brick.
        for path in (
            self.kickctl / "arguments",
            self.etc / "systemd" / "system" / "kickctl.service",
        ):
            if path.exists():
                text = path.read_text(encoding="utf-8")
                path.write_text(text.replace(str(other.folder), str(self.folder)), encoding="utf-8")

    def take_releases(self, other):
        """Have the brick hold the releases of another one, which it never ran."""
        shutil.copytree(other.kickctl / "releases", self.kickctl / "releases")

    def do(self, command):
        """Run a command of the shell, as a login would."""
        environment = {"HOME": str(self.home), "PATH": os.environ["PATH"]}
        environment["SSH_ORIGINAL_COMMAND"] = command
        subprocess.run([self.folder / "login"], env=environment, check=True)

    def start_program(self):
        """Start the robot's program as deploy.sh does, and wait until it is ready."""
        program = "sh kickctl/current/robot/service/brick.sh run"
        self.do(f"setsid {program} </dev/null >/dev/null 2>&1 &")
        wait_until(lambda: "READY" in self.log())

    def _starts(self):
        """How often sshd has begun to listen."""
        log = (self.folder / "sshd.log").read_text(encoding="utf-8")
        assert self._sshd.poll() is None, log
        return log.count("Server listening")

    def shut_down(self):
        """End sshd and every process that was left at work on the brick."""
        for pid in self.processes():
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._sshd.terminate()
        self._sshd.wait(10)
        self._port.close()

    def processes(self):
        """Numbers of all processes that live in the brick's home."""
        pids = (int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit())
        return [pid for pid in pids if self._is_home_of(pid)]

    def _is_home_of(self, pid):
        with contextlib.suppress(OSError):
            return str(Path(f"/proc/{pid}/cwd").readlink()).startswith(str(self.home))
        return False

    # What deploy.sh has made of it

    @property
    def kickctl(self):
        return self.home / "kickctl"

    def release(self, link="current"):
        """The name of the current or previous release, None if there is none."""
        path = self.kickctl / link
        return path.resolve(strict=True).name if path.is_symlink() else None

    def releases(self):
        """The names of whatever stands among the releases."""
        return (
            sorted(path.name for path in (self.kickctl / "releases").iterdir())
            if (self.kickctl / "releases").exists()
            else []
        )

    def pid(self):
        """The number of the robot's program, None if it does not run."""
        pid = int("0" + self._text("robot.pid").strip())
        return pid if self._is_home_of(pid) else None

    def runs(self):
        """The name of the release whose program runs, None if none does."""
        with contextlib.suppress(OSError):
            return Path(f"/proc/{self.pid()}/cwd").readlink().name
        return None

    def stop_program(self):
        """Have the robot's program end, as somebody on the brick might."""
        os.kill(self.pid(), signal.SIGTERM)
        wait_until(lambda: self.pid() is None)

    def log(self):
        """What the robot's program has written."""
        return self._text("robot.log")

    def _text(self, name):
        """The text of a file below ~/kickctl.

        Empty if there is no file: between two releases deploy removes it.
        """
        with contextlib.suppress(FileNotFoundError):
            return (self.kickctl / name).read_text(encoding="utf-8")
        return ""

    def uri(self):
        """The robot's address through the tunnel."""
        return "ssh://brick?port=" + re.findall(r"READY tcp://\S*:(\d+)", self.log())[-1]


class Checkout:
    """A copy of what deploy.sh needs, to change at will.

    And the machine that it stands on, with a token of its own.
    """

    def __init__(self, folder, brick):
        self.folder = folder / "checkout"
        self.bin = folder / "host-bin"
        self.token = folder / "token"
        self._brick = brick
        (self.folder / "robot").mkdir(parents=True)
        shutil.copy(ROOT / "deploy.sh", self.folder)
        for path in (ROOT / "robot").glob("*.py"):
            shutil.copy(path, self.folder / "robot")
        for name in ("robot/service", "host/deploy"):
            shutil.copytree(ROOT / name, self.folder / name)

    def environment(self, **more):
        """The environment of a program on this machine."""
        return {
            **os.environ,
            "PATH": f"{self.bin}:{os.environ['PATH']}",
            "KICK_TOKEN": str(self.token),
            "KICK_SSH_OPTIONS": f"-F {self._brick.ssh_config}",
            **more,
        }

    def deploy(self, *arguments, to="brick", **environment):
        """Run deploy.sh: (exit status, all it has printed)."""
        with self.deploying(*arguments, to=to, **environment) as process:
            output = process.communicate(timeout=100)[0]
            return process.returncode, output

    def deploying(self, *arguments, to="brick", **environment):
        """A running deploy.sh."""
        environment.setdefault(
            "KICK_ROBOT_ARGS", f"--sysfs {self._brick.sysfs} --host 127.0.0.1 --port 0 --seed 5"
        )
        return subprocess.Popen(
            [self.folder / "deploy.sh", *arguments, to],
            env=self.environment(**environment),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def change(self, module="__init__", text="\n# changed\n"):
        """Add lines to a module, so that this is another release."""
        with (self.folder / "robot" / f"{module}.py").open("a", encoding="utf-8") as file:
            file.write(text)

    def kickctl(self, *arguments):
        """Run kickctl, which draws nothing: (exit status, standard output, standard error)."""
        done = subprocess.run(
            [sys.executable, "-m", "host", *arguments],
            env=self.environment(PYTHONPATH=without_figures(self.folder.parent)),
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        return done.returncode, done.stdout, done.stderr


def charged(folder):
    """A brick without motors, whose battery is full."""
    brick = Brick(folder)
    battery = brick.sysfs / "power_supply" / "lego-ev3-battery"
    write(battery / "voltage_now", "7900000\n")
    write(battery / "technology", "Li-ion\n")
    return brick


@contextlib.contextmanager
def deployed_once(brick, *arguments):
    """A first deploy to a brick, which is on until the end of the block: the checkout."""
    checkout = Checkout(brick.folder, brick)
    brick.boot()
    # Where a kickctl is on the path, deploy.sh has it keep the robot's name.
    config = str(brick.folder / "config")
    try:
        status, output = checkout.deploy(*arguments, XDG_CONFIG_HOME=config)
        assert status == 0, output
        yield checkout
    finally:
        brick.shut_down()


def wait_until(condition, seconds=30.0):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)
