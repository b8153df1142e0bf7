"""ssh://[user@]host[:ssh port][?port=]: a robot through the system's ssh.

ssh knows the user's keys, settings and known hosts.
"""

from __future__ import annotations

import os
import shlex
import socket
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import IO, Self
from urllib.parse import parse_qsl, urlsplit

from host.errors import NoLink, WrongUse, printable
from host.link.transport import CONNECT_TIMEOUT_S, LinkLost, TcpLink
from host.util.installation import deploy_command
from robot.program import PORT

_FORM = (
    "give it as ssh://robot@ev3dev.local, with ?port= if the robot's program listens elsewhere than"
    " at its usual port"
)
_END_S = 2.0
# A second link of a program that is connected asks for no password, so nobody has to be waited for.
_BATCH = ["-o", "BatchMode=yes"]
_BATCH_ANSWER_S = 15.0
# ssh may say much; what it gives up for comes last.
_LAST_WORDS = 280
# ^C reaches ssh too, and must not end it: kickctl still has to stop the motors over this link.
_RUN = ("sh", "-c", 'trap "" INT; exec ssh "$@"', "sh")
# What ssh says, and what to do about it; the first that fits.
_REMEDIES = {
    "IDENTIFICATION HAS CHANGED": (
        "a brick with a newly written card has a new key, and this machine remembers the old one: "
        "`ssh-keygen -R {host}`, then try again"
    ),
    "Host key verification failed": (
        "this machine does not know the brick yet: `ssh robot@{host}` once, and say yes to its key"
    ),
    "Permission denied": (
        "an ev3dev brick's user is robot, with the password maker unless it was changed:"
        " ssh://robot@{host}; `ssh-copy-id robot@{host}` once spares typing it"
    ),
    "Could not resolve hostname": (
        "the network knows no {host}: `kickctl discover` looks around, or take the address on the"
        " brick's screen"
    ),
    "ssh: not found": "install ssh (Debian, Ubuntu: apt-get install openssh-client)",
    "open failed": (
        "ssh works, but the robot's program does not listen there: `{deploy} --status` looks,"
        " `{deploy}` starts it"
    ),
}
_REMEDY = (
    "is it switched on, and this its name? Try the address on its screen; `kickctl discover` looks"
    " around"
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
        parts = urlsplit(uri)
        super().__init__(uri, parts.hostname or "", PORT)
        options = dict(parse_qsl(parts.query, keep_blank_values=True))
        port = options.pop("port", str(PORT))
        if not port.isdigit() or options or parts.path.strip("/"):
            raise WrongUse(f"'{uri}' is no address of a robot", _FORM)
        if parts.password is not None:
            raise WrongUse(
                "passwords do not belong into addresses, where others see them",
                "leave it out: ssh asks for it",
            )
        self._options = [
            "-T",
            "-W",
            f"127.0.0.1:{port}",
            "-o",
            "ConnectTimeout=20",
            "-o",
            "ServerAliveInterval=5",
        ]
        self._options += ["-p", str(parts.port)] * (parts.port is not None) + shlex.split(
            os.environ.get("KICK_SSH_OPTIONS", "")
        )
        self._login = (
            f"{parts.username}@{parts.hostname}" if parts.username else str(parts.hostname)
        )
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
            command = [*_RUN, *self._options, "--", self._login]
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

    def close(self) -> None:
        """Close the connection and end ssh."""
        super().close()
        if self._ssh is not None:
            try:
                self._ssh.wait(_END_S)  # it ends by itself when its input does
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
            words = " ".join(self._words.read().decode(errors="replace").split())
            remedy = next((remedy for sign, remedy in _REMEDIES.items() if sign in words), _REMEDY)
            shown = printable(
                words
                if len(words) <= _LAST_WORDS
                else "... " + words[-_LAST_WORDS:].partition(" ")[2]
            )
            raise NoLink(
                f"no robot answers at {self.uri}: {shown or error}",
                remedy.format(host=self._address[0], deploy=deploy_command()),
            ) from error
