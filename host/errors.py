"""What can go wrong for a person at the host, each with the exit status that says so to a script."""


class KickctlError(Exception):
    """An error to be told in words: what happened and why, and what to do next.

    `status` is the exit status.
    """

    status = 1

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint


class NotDone(KickctlError):
    """It was tried, and the robot did not do it."""

    status = 1


class WrongUse(KickctlError):
    """The request makes no sense, whatever robot there is."""

    status = 2


class NoLink(KickctlError):
    """The robot cannot be reached, or no longer."""

    status = 3


class RefusedByRobot(KickctlError):
    """The robot is there and says no: version, token, lease."""

    status = 4


class LeaseLost(RefusedByRobot):
    """The robot is not, or no longer, controlled by this host."""


class RobotFault(KickctlError):
    """The robot is in fault."""

    status = 5


_STATUS_BY_CODE = {
    "usage": WrongUse,
    "range": WrongUse,
    "unknown": WrongUse,
    "state": NotDone,
    "busy": NotDone,
    "fault": RobotFault,
    "lease": LeaseLost,
}


def from_robot(error: dict[str, object]) -> KickctlError:
    """The exception for a refusal as the robot sends it: {code, message, hint}."""
    kind = _STATUS_BY_CODE.get(str(error.get("code")), RefusedByRobot)
    return kind(
        "the robot refuses: " + printable(str(error.get("message"))),
        printable(str(error.get("hint", ""))),
    )


def printable(text: str) -> str:
    """Text of a peer, cut to a decent length and without anything a terminal would obey."""
    return "".join(letter for letter in text[:300] if letter.isprintable())
