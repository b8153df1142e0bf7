"""What a host says first."""

from __future__ import annotations

from robot import wire


def hello_frame(name: str, client: str, nonce: bytes, *, token: bool) -> bytes:
    """The frame that begins a conversation.

    Args:
        name: Who this is, for people (at most 40 characters).
        client: What stays the same when this host comes back.
        nonce: Random bytes, NONCE_BYTES of them.
        token: Whether a proof of the token will follow.
    """
    message = {
        "protocol": wire.PROTOCOL,
        "name": name[:40],
        "client": client,
        "nonce": nonce.hex(),
        "token": token,
    }
    return bytes(wire.encode_json(wire.HELLO, message))
