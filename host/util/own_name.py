"""What this program calls itself, for the robot and for other people."""

from __future__ import annotations

import getpass
import socket

from host.errors import WrongUse
from host.util.arguments import need_text, wrong

# The robot shows so much of a name.
NAME_LETTERS = 40

_chosen: list[str] = []


def choose(name: str | None) -> None:
    """Choose the name of this program from now on.

    Args:
        name: The name; None for the usual one.

    Raises:
        WrongUse: It cannot be shown to people.
    """
    _chosen[:] = [] if name is None else [need_name(name)]


def own_name() -> str:
    """The name that was chosen; by default user@machine, as in `anna@lab-3`."""
    if _chosen:
        return _chosen[0]
    try:
        user = getpass.getuser()
    except (ImportError, KeyError, OSError):  # the system does not know this user
        user = "somebody"
    name = f"{user}@{socket.gethostname().partition('.')[0]}"
    return "".join(filter(str.isprintable, name))[:NAME_LETTERS]


def need_name(name: object) -> str:
    """The name, if people can be shown it.

    Raises:
        WrongUse: It is empty, too long, or holds what cannot be printed.
    """
    wanted = f"text of at most {NAME_LETTERS} letters, as in anna@lab-3"
    text = need_text("name", name, wanted)
    if len(text) > NAME_LETTERS or not text.strip():
        raise wrong("name", text, wanted)
    if not text.isprintable():
        raise WrongUse("a name holds a letter that cannot be printed", f"give {wanted}")
    return text
