"""What ssh says when it gives up, and what to do about it."""

from __future__ import annotations

import re
import shlex
import subprocess

from host.link.logins import Login
from host.util.installation import deploy_command
from robot.wire import PORT

_ANSWER_S = 10.0
# What ssh says and the remedy; the first that fits. The words in braces are in `_words_for`.
_REMEDIES = {
    "IDENTIFICATION HAS CHANGED": (
        "a brick with a newly written card has a new key, and this machine remembers the old one:"
        " type {forget}, then try again"
    ),
    "Host key verification failed": (
        "this machine does not know the brick yet: type {meet}, and say yes to its key"
    ),
    "Too many authentication failures": (
        "ssh offers more keys than the brick tries. Offer the right one only (export"
        " KICK_SSH_OPTIONS='-o IdentitiesOnly=yes -i KEY'), or none and type the password (export"
        " KICK_SSH_OPTIONS='-o PubkeyAuthentication=no')"
    ),
    "Permission denied": (
        "an ev3dev brick's user is robot, with the password maker unless it was changed:"
        " ssh://robot@{bracketed}; after {copy_key} nobody needs to type it"
    ),
    "Could not resolve hostname": (
        "the network knows no {host}: `kickctl discover` looks around, or take the address on the"
        " brick's screen"
    ),
    "ssh: not found": "install ssh (Debian, Ubuntu: apt-get install openssh-client)",
    "administratively prohibited": (
        "the brick's sshd forbids forwarding. Reach the robot by tcp://{real}, or set"
        " 'AllowTcpForwarding yes' in the brick's /etc/ssh/sshd_config and restart its ssh"
    ),
    "open failed": (
        "ssh works, but the robot's program does not listen there: `{deploy} --status {login}`"
        " looks, `{deploy} {login}` starts it"
    ),
}
_REMEDY = (
    "is it switched on, and this its name? Try the address on its screen; `kickctl discover` looks"
    " around"
)


def remedy(said: str, login: Login, options: list[str], port: int) -> str:
    """What to do about a failure of ssh.

    Args:
        said: What ssh has written to standard error.
        login: Where it should have logged in.
        options: The user's further options for ssh.
        port: Where the robot listens on that machine.
    """
    template = next((remedy for sign, remedy in _REMEDIES.items() if sign in said), _REMEDY)
    return template.format_map(_Words(said, login, options, port))


class _Words(dict[str, str]):
    """The words of a remedy, each found when a template asks for it."""

    def __init__(self, said: str, login: Login, options: list[str], port: int) -> None:
        super().__init__(host=login.host, login=shlex.quote(str(login)), deploy=deploy_command())
        self._said = said
        self._login = login
        self._options = options
        self._port = None if port == PORT else port

    def __missing__(self, name: str) -> str:
        login = self._login
        if name == "bracketed":
            return str(Login("", login.host, login.port))
        settings = self._settings()
        if name == "real":
            return str(Login("", settings.get("hostname", login.host), self._port))
        if name == "forget":
            return _forget(self._said, settings)
        if name == "meet":
            return self._by_hand(login, "ssh", "-o", "StrictHostKeyChecking=ask")
        if not login.user:
            login = Login("robot", login.host, login.port)
        return self._by_hand(login, "ssh-copy-id")

    def _by_hand(self, login: Login, *program: str) -> str:
        return shlex.join([*program, *self._options, *login.words()])

    def _settings(self) -> dict[str, str]:
        """Ssh's own settings for the login."""
        command = ["ssh", "-G", *self._options, *self._login.words()]
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=_ANSWER_S, check=False
            )
        except (OSError, subprocess.TimeoutExpired):
            return {}
        lines = (line.partition(" ") for line in done.stdout.splitlines())
        return {name: value for name, _, value in lines}


def _forget(said: str, settings: dict[str, str]) -> str:
    """The command that has ssh forget a machine's old key."""
    name = settings.get("hostkeyalias", "")
    if not name:
        name = settings.get("hostname", "")
        port = settings.get("port", "22")
        name = name if port == "22" else f"[{name}]:{port}"
    known = re.search(r"^Offending .*key.* in (.*):\d+\r?$", said, re.MULTILINE)
    file = ["-f", known[1]] if known else []
    return shlex.join(["ssh-keygen", *file, "-R", name])
