"""What lets a host in: the token, and the hello and the proof that begin every conversation."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

from host.client.conversation import Conversation
from host.errors import NoLink, RefusedByRobot, TokenRefused
from host.link import robots_file
from host.link.patience import Patience
from host.link.transport import Link, LinkLost
from host.util.arguments import need_path
from robot.token import TokenError, default_path, load

LOOK_S = 0.1


def find_token(link: Link, path: str | Path | None = None, own: str | None = None) -> bytes | None:
    """The token for a link: its own if it has one, else a file's.

    A file that nobody named on purpose may be unfit: that keeps nobody from looking on.

    Args:
        link: The way to the robot.
        path: The token file that somebody named for this connection.
        own: Else the robot's own token file; by default the one in the usual place.

    Returns:
        The token; None if there is no usable file, and nobody named one.

    Raises:
        WrongUse: The path is none.
        RefusedByRobot: The file that was named holds no token, or others can read it.
    """
    if path is not None:
        path = need_path("token", path)
    carried: bytes | None = getattr(link, "token", None)
    if carried is not None:
        return carried
    place = path or own or default_path()
    if path is None and own is None and not (place and Path(place).exists()):
        return None
    try:
        secret: bytes = load(place)
    except TokenError as error:
        if path is None:
            logging.getLogger("kickctl").warning(
                "%s. Without it you may look, and stop the robot, but not move it", error
            )
            return None
        raise RefusedByRobot(
            str(error), "name another token file by --token, or leave it to the default place"
        ) from error
    return secret


def greet(link: Link, talk: Conversation, send: Callable[[bytes], None], patience_s: float) -> None:
    """Say hello over an open link, and prove the token if there is one.

    Who has another robot's token may do what one without any may do: look, and stop the robot. A
    refused proof ends the conversation, so another one begins, without the token.

    Args:
        link: The open link.
        talk: The conversation, which begins here.
        send: Sends a frame over the link.
        patience_s: How long the robot may take for each answer (s).

    Raises:
        KickctlError: Nobody answers, or the robot refuses.
        LinkLost: The robot hung up.
    """
    try:
        _introduce(link, talk, send, patience_s)
    except TokenRefused as refusal:
        talk.token = None
        talk.token_refused = True
        try:
            try:
                _introduce(link, talk, send, patience_s)
            except LinkLost:  # an older robot hangs up
                link.open()
                _introduce(link, talk, send, patience_s)
        except NoLink:  # such as an ssh that would have to ask for the password again
            raise refusal from None
        logging.getLogger("kickctl").warning(
            "the token on this computer is not that of the robot at %s: you may look, and stop the"
            " robot, but not move it",
            link.uri,
        )


def _introduce(
    link: Link, talk: Conversation, send: Callable[[bytes], None], patience_s: float
) -> None:
    talk.begin()
    send(talk.hello_frame())
    hear(link, talk, lambda: bool(talk.hello), patience_s)
    if link.meant is not None and link.meant.is_other(talk.hello):
        name = link.meant.name
        raise NoLink(
            f"{link.uri} does not lead to {name}: another robot has this address now",
            f"is {name} switched on? Then `kickctl discover --save` finds it again. But if this is"
            f" {name}, with another brick, delete {name}'s line hardware_id in"
            f" {robots_file.file_path()}",
        )
    if talk.token is not None:
        send(talk.auth_frame())
        hear(link, talk, lambda: talk.trusted, patience_s)


def hear(link: Link, talk: Conversation, arrived: Callable[[], bool], patience_s: float) -> None:
    """Read from a link until what is awaited has arrived.

    Raises:
        KickctlError: Nothing has come in time, or the robot refuses.
        LinkLost: The robot hung up.
    """
    patience = Patience(link, patience_s)
    while not arrived():
        if patience.is_over():
            raise NoLink(
                f"no robot answers at {link.uri}, though something is there",
                "is it the robot's port, or its line and baud rate? Or its program hangs: look"
                " whether the motors turn, and stop them by `kickctl stop`",
            )
        talk.feed(link.receive(LOOK_S))
        if link.is_line and not talk.hello:  # what was on its way when the robot began anew
            talk.overlook_broken()
        talk.raise_refusal()
