"""What this computer and its robots say, in words for people at a page."""

from __future__ import annotations

import re

from host.lab.stopper import plain
from host.util.own_name import own_name
from robot.words import person

_ERRNO = re.compile(r"\[Errno -?\d+\] ")
# The path of a file. An address and a device stay as they are.
_PATH = re.compile(r"(?<![\w:/.])/(?!dev/)(?:[\w.~+-]+/)+([\w.+-]+)")


def for_page(words: str) -> str:
    """Words for people who see neither this computer's disk nor its system's numbers."""
    return _PATH.sub(r"\1", _ERRNO.sub("", words))


def reason(words: str) -> str:
    """A robot's reason. It knows this lab by the name of a person at a computer."""
    who, silent, seconds = words.partition(" was silent for ")
    if silent and who == person(own_name()):
        return f"this lab was silent for {seconds}, so the robot stopped by itself"
    return plain(words)
