"""The secret that robot and host share: 32 random bytes.

It is hexadecimal text in a file that only its owner can read.
"""

import binascii
import os
import stat

from robot.user_folders import config_folder
from robot.wire import TOKEN_BYTES

# What to do about a file that holds none: a host has a copy, and only the robot makes a new one.
COPY = "copy the robot's token file again, or on the robot delete it"
DELETE = "delete it, and a new one is made"


class TokenError(Exception):
    """The token file cannot be used. The message says why, and what to do if that is known.

    Args:
        why: Why, in words; also an attribute.
        remedy: What to do, in words; also an attribute. Empty if only a person can know it.
    """

    def __init__(self, why, remedy=""):
        super().__init__("; ".join(filter(None, (why, remedy))))
        self.why = why
        self.remedy = remedy


def default_path():
    """Where the token is kept.

    Returns:
        The path in $KICK_TOKEN, or that of a file in the user's configuration folder; empty if
        there is neither.
    """
    named = os.environ.get("KICK_TOKEN")
    if named:
        return named
    folder = config_folder()
    return os.path.join(folder, "token") if folder else ""


def load(path, remedy=COPY):
    """Read a token.

    Args:
        path: The token file.
        remedy: What to do if it holds no token, in words.

    Returns:
        The token, 32 bytes.

    Raises:
        TokenError: The file is missing, others may read it, or it holds no token.
    """
    _require_place(path)
    try:
        if os.path.exists(path) and not (
            os.path.isfile(path) or stat.S_ISFIFO(os.stat(path).st_mode)
        ):
            raise TokenError("{} is no file that could hold a token".format(path))
        with open(path, "r", encoding="ascii", errors="replace") as file:
            mode = os.fstat(file.fileno()).st_mode
            text = file.read(4 * TOKEN_BYTES)
    except (OSError, ValueError) as error:
        raise TokenError("the token file {} cannot be read: {}".format(path, error)) from error
    if mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise TokenError(
            "others may read the token file {}".format(path), "close it: chmod 600 {}".format(path)
        )
    try:
        token = binascii.unhexlify(text.strip())
    except ValueError:
        token = b""
    if len(token) != TOKEN_BYTES:
        raise TokenError(
            "{} holds no token of {} hexadecimal digits".format(path, 2 * TOKEN_BYTES), remedy
        )
    return token


def load_or_make(path):
    """Read a token, and make one first if there is no file.

    Args:
        path: The token file.

    Returns:
        (token, whether it is new).

    Raises:
        TokenError: The file cannot be made or used.
    """
    _require_place(path)
    try:
        os.makedirs(os.path.dirname(path) or ".", mode=0o700, exist_ok=True)
        handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        return load(path, DELETE), False
    except (OSError, ValueError) as error:
        raise TokenError("the token file {} cannot be made: {}".format(path, error)) from error
    try:
        with os.fdopen(handle, "w") as file:
            file.write(binascii.hexlify(os.urandom(TOKEN_BYTES)).decode("ascii") + "\n")
    except OSError as error:
        # Or an empty file would be taken for a spoiled token from now on.
        os.unlink(path)
        raise TokenError("the token file {} cannot be written: {}".format(path, error)) from error
    return load(path), True


def _require_place(path):
    if not path:
        raise TokenError(
            "no file for the token is named, or this user has no home folder for it",
            "name its file by KICK_TOKEN or --token",
        )
