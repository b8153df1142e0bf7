"""ssh://[user@]host[:ssh port][?host=][&port=]: a robot through the system's ssh.

ssh knows the user's keys, settings and known hosts.
"""

from __future__ import annotations

import os
import re
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Self
from urllib.parse import parse_qsl

import robot
from host.errors import NoLink, WrongUse, printable, quotable
from host.link.logins import Login, parse_login, ssh_options
from host.link.ssh_failures import remedy
from host.link.transport import CONNECT_TIMEOUT_S, READ_BYTES, LinkLost, TcpLink
from robot.wire import PORT

_FORM = (
    "give it as ssh://robot@ev3dev.local, with ?port= if the robot's program listens at another"
    " port than the usual, and ?host= if it listens at one address of the brick only"
)
_HOST = re.compile("[A-Za-z0-9.:%_-]+")
_PORT = re.compile("[1-9][0-9]{0,4}")
_END_S = 2.0
# A second link of a program that is connected asks for no password, so nobody has to be waited for.
_BATCH = ["-o", "BatchMode=yes"]
_BATCH_ANSWER_S = 15.0
# ssh may say much; what it gives up for comes last.
_LAST_WORDS = 280
_LOGGED_IN = b"Authenticated to "
# What ssh says besides, though nothing is wrong.
_CHATTER = ("Authenticated to ", "Transferred: ", "Bytes per second: ")
# How long the brick may take to switch its motors off.
_HALT_S = 15.0
# ^C reaches ssh too, and must not end it: kickctl still has to stop the motors over this link.
_RUN = ("sh", "-c", 'trap "" INT; exec ssh "$@"', "sh")
# What a person's settings add to a login by hand is switched off, and ssh has to say why it fails.
_SETTINGS = (
    "ConnectTimeout=20",
    "ServerAliveInterval=5",
    "RemoteCommand=none",
    "PermitLocalCommand=no",
    "LogLevel=VERBOSE",  # it says when it has logged in, and why it has not
)


class SshLink(TcpLink):
    """A connection from the robot's machine to its own port, carried by an ssh process.

    $KICK_SSH_OPTIONS holds further options for ssh. Passwords are ssh's business: it asks for them
    at the terminal. Raises WrongUse for an address that cannot be one.
    """

    opens_fast = False
    # ssh may have to wait for a person who types a password; if it gives up instead, its end is
    # noticed at once.
    answer_s = 60.0

    def __init__(self, uri: str) -> None:
        self._login, host, self._port = _parse(uri)
        port = self._port
        super().__init__(uri, self._login.host, port)
        self._user_options = ssh_options()
        self._options = ["-T", "-W", f"[{host}]:{port}" if ":" in host else f"{host}:{port}"]
        for setting in _SETTINGS:
            self._options += ["-o", setting]
        *own_port, self._target = self._login.words()
        self._options += own_port + self._user_options
        self._ssh: subprocess.Popen[bytes] | None = None
        self._words: IO[bytes] | None = None
        self._heard = False

    def another(self) -> Self:
        """A second ssh process to the same robot, not started yet, which asks for no password."""
        other = object.__new__(type(self))
        vars(other).update(vars(self), _socket=None, _ssh=None, _words=None, _heard=False)
        if self._heard:
            vars(other).update(_options=self._options + _BATCH, answer_s=_BATCH_ANSWER_S)
        return other

    def open(self) -> None:
        """Start ssh. It has got through when the robot answers."""
        self.close()
        if self._heard and "BatchMode=yes" not in self._options:
            # Nobody waits at the terminal to type a password a second time.
            self._options += _BATCH
        self._heard = False
        self._words = tempfile.TemporaryFile()  # noqa: SIM115
        self._socket, theirs = socket.socketpair()
        self._socket.settimeout(CONNECT_TIMEOUT_S)
        with theirs:
            command = [*_RUN, *self._options, "--", self._target]
            self._ssh = subprocess.Popen(
                command, stdin=theirs.fileno(), stdout=theirs.fileno(), stderr=self._words
            )

    def send(self, data: bytes) -> None:
        """Send all of it. Raises LinkLost, or NoLink if ssh never got through."""
        with self._explained():
            super().send(data)

    def receive(self, timeout_s: float) -> bytes:
        """What has arrived within timeout_s.

        Raises LinkLost, or NoLink if ssh never got through.
        """
        with self._explained():
            data = super().receive(timeout_s)
        self._heard = self._heard or bool(data)
        return data

    def logged_in(self) -> bool:
        """Whether ssh has got through to the machine, so that only the robot has to answer."""
        if self._heard:
            return True
        if self._words is None:
            return False
        # Not by `seek`: ssh writes where this process has left off.
        return _LOGGED_IN in os.pread(self._words.fileno(), READ_BYTES, 0)

    def halt(self) -> str:
        """Have the brick's kernel switch the motors off, without the robot's program.

        Returns:
            What the brick says of its motors, in words; empty if it could not be asked.
        """
        service = Path(robot.__file__).parent / "service"
        script = b"".join((service / name).read_bytes() for name in ("change.sh", "brick.sh"))
        options = self._options[3:]  # without the way to the robot's port
        command = ["ssh", "-T", *options, *_BATCH, "--", self._target, "sh -s halt"]
        try:
            done = subprocess.run(
                command, input=script, capture_output=True, timeout=_HALT_S, check=False
            )
        except (OSError, subprocess.TimeoutExpired):
            return ""
        said = re.search("kickctl-motors=([^=]*)=", done.stdout.decode(errors="replace"))
        return printable(said[1]) if said else ""

    def close(self) -> None:
        """Close the connection and end ssh."""
        super().close()
        if self._ssh is not None:
            try:
                # It ends by itself when its input does, if the robot's program hangs up, too.
                self._ssh.wait(_END_S if self._heard else 0.1)
            except subprocess.TimeoutExpired:
                self._ssh.kill()
                self._ssh.wait()
            self._ssh = None
        if self._words is not None:
            self._words.close()
            self._words = None

    @contextmanager
    def _explained(self) -> Iterator[None]:
        try:
            yield
        except LinkLost as error:
            if self._heard or self._ssh is None or self._words is None:
                raise
            with suppress(subprocess.TimeoutExpired):
                self._ssh.wait(_END_S)
            self._words.seek(0)
            lines = self._words.read().decode(errors="replace").splitlines(keepends=True)
            said = "".join(line for line in lines if not line.startswith(_CHATTER))
            words = " ".join(said.split())
            shown = printable(
                words
                if len(words) <= _LAST_WORDS
                else "... " + words[-_LAST_WORDS:].partition(" ")[2]
            )
            raise NoLink(
                f"no robot answers at {self.uri}: {shown or error}",
                remedy(said, self._login, self._user_options, self._port),
            ) from error


def _parse(uri: str) -> tuple[Login, str, int]:
    """The login in ssh://[USER@]HOST[:PORT][?host=][&port=], and where the robot listens there.

    Raises WrongUse.
    """
    address, _, query = uri.partition("?")
    if ":" in address.removeprefix("ssh://").rpartition("@")[0]:
        raise WrongUse(
            "a password does not belong in an address, where others see it",
            "leave it out: ssh asks for it",
        )
    login = parse_login(address)
    options = dict(parse_qsl(query, keep_blank_values=True))
    host, port = options.pop("host", "127.0.0.1"), options.pop("port", str(PORT))
    why = ""
    if options:
        why = f"it has no option '{next(iter(options))}'"
    elif not _HOST.fullmatch(host):
        why = f"'{host}' is no machine's name"
    elif not _PORT.fullmatch(port) or int(port) > 65535:
        why = f"port cannot be '{port}'"
    if why:
        raise WrongUse(f"'{quotable(uri)}' is no address of a robot: {quotable(why)}", _FORM)
    return login, host, int(port)
