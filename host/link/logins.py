"""Where to log in by ssh: [ssh://][USER@]HOST[:PORT], in one grammar for kickctl and deploy.sh.

HOST may be a name of the user's ~/.ssh/config, so capitals stay as they are. An IPv6 address before
a port stands in brackets. deploy.sh has the same rules in shell.
"""

from __future__ import annotations

import os
import re
import shlex
from dataclasses import dataclass

from host.errors import WrongUse, quotable

_NAME = "[A-Za-z0-9._+][A-Za-z0-9._+-]*"
_ZONE = "(?:%[A-Za-z0-9._-]+)?"
_BOXED = rf"\[(?P<boxed>[0-9A-Fa-f.]*:[0-9A-Fa-f:.]*{_ZONE})\]"
_BARE = rf"(?P<bare>[0-9A-Fa-f.]*:[0-9A-Fa-f.]*:[0-9A-Fa-f:.]*{_ZONE})"
_PORT = "(?::(?P<{}>[1-9][0-9]{{0,4}}))?"
_LOGIN = re.compile(
    rf"(?:(?P<user>{_NAME})@)?"
    rf"(?:{_BOXED}{_PORT.format('p1')}|{_BARE}|(?P<name>{_NAME}){_PORT.format('p2')})"
)
_FORM = "write USER@HOST or ssh://USER@HOST:PORT, for example robot@ev3dev.local"


@dataclass(frozen=True)
class Login:
    """A machine to log in to.

    Attributes:
        user: The user; empty if ssh's own settings name one.
        host: A name or an address, without brackets.
        port: The port of ssh; None if ssh's own settings name one.
    """

    user: str
    host: str
    port: int | None

    def words(self) -> list[str]:
        """The words by which ssh and its relatives know it: -p PORT, USER@HOST."""
        port = [] if self.port is None else ["-p", str(self.port)]
        return [*port, f"{self.user}@{self.host}" if self.user else self.host]

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        port = "" if self.port is None else f":{self.port}"
        return f"{self.user}@{host}{port}" if self.user else f"{host}{port}"


def parse_login(text: str) -> Login:
    """The machine that a text names.

    Args:
        text: [ssh://][USER@]HOST[:PORT].

    Raises:
        WrongUse: The text names none.
    """
    rest = text.removeprefix("ssh://")
    if rest != text:
        rest = rest.removesuffix("/")
    parts = _LOGIN.fullmatch(rest)
    port = parts and (parts["p1"] or parts["p2"])
    if parts is None or (port and int(port) > 65535):
        raise WrongUse(f"'{quotable(text)}' is no address of a brick", _FORM)
    # In a URI '%' is written '%25'.
    host = re.sub("%25(?=.)", "%", parts["boxed"] or parts["bare"] or parts["name"], count=1)
    return Login(parts["user"] or "", host, int(port) if port else None)


def ssh_options() -> list[str]:
    """The options for ssh in $KICK_SSH_OPTIONS, quoted there as for a shell.

    Raises:
        WrongUse: A quote is not closed.
    """
    try:
        return shlex.split(os.environ.get("KICK_SSH_OPTIONS", ""))
    except ValueError as error:
        raise WrongUse(f"KICK_SSH_OPTIONS cannot be understood: {error}", "close its quotes") from (
            error
        )
