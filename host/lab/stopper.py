"""Who has stopped a robot, as its own reason says it: in the words of people."""

from __future__ import annotations

import re

from host.util.own_name import own_name
from robot.words import person

# In the place of a page's number: the lab itself.
LAB = 0
# What is said of a robot that was lost when it was to be stopped.
BACK = "it is back, and was stopped: STOP was pressed while it was lost"
_ENDING = " stopped it"
# Other names stay quoted, since a host may call itself anything.
_PLAIN_NAME = re.compile(rf"'([\w.-]+)@([\w.-]+)'{_ENDING}")


def of_this_lab(reason: str) -> bool:
    """Whether the host that has stopped a robot bears this lab's name."""
    return reason == f"{person(own_name())}{_ENDING}"


def plain(reason: str) -> str:
    """A robot's reason, in which user@machine has become a person at a computer."""
    return _PLAIN_NAME.sub(rf"\1{_ENDING} from the computer \2", reason)
