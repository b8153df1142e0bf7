"""What can go wrong for a person at the host, each kind with its exit status for scripts."""

from typing import Any


class KickctlError(Exception):
    """An error in words. As text it is the message alone; the hint says what to do.

    >>> try:
    ...     connect("sim://?k=-1")
    ... except KickctlError as error:
    ...     print(error.message, error.hint, error.status, sep="; ")
    'sim://?k=-1' cannot be simulated: k cannot be -1; it is a number from 0 to 100; 2

    Attributes:
        message: What happened, and why.
        hint: What to do next; may be empty.
        status: The exit status of a command that ends with it.
        kept: The path of the log, or of the folder, that holds what was done until then; or empty.
    """

    status = 1
    kept = ""

    def __init__(self, message: str, hint: str = "") -> None:
        message, hint = escaped(message), escaped(hint)
        super().__init__(message)
        self.message = message
        self.hint = hint
        if hint:
            self.add_note(hint)  # so that a notebook, which shows a traceback, shows it too

    @property
    def in_a_line(self) -> str:
        """The message and the hint in one line."""
        return f"{self.message}; {self.hint}" if self.hint else self.message


def mark_kept(error: BaseException, path: object) -> None:
    """Note in an error, or an interrupt, where what was done until then is kept."""
    vars(error)["kept"] = escaped(str(path))


class FigureInterrupted(KeyboardInterrupt):
    """^C while the figure of a run was drawn, whose results are known and written.

    Attributes:
        summary: The run's summary.
    """

    def __init__(self, summary: dict[str, Any]) -> None:
        super().__init__()
        self.summary = summary


class NotDone(KickctlError):
    """It was tried, and the robot did not do it.

    >>> with connect("sim://?idle=1") as robot:
    ...     try:
    ...         robot.kick_and_watch("phase")
    ...     except NotDone as error:
    ...         print(error)
    the robot does not run: it is idle (not started yet)
    """

    status = 1


class WrongUse(KickctlError):
    """The request makes no sense, no matter which robot gets it.

    >>> try:
    ...     connect("sim://?mass=1")
    ... except WrongUse as error:
    ...     print(error)
    sim:// has no option 'mass'
    """

    status = 2


class NoLink(KickctlError):
    """The robot cannot be reached, or its link broke.

    >>> try:
    ...     connect("serial:///dev/nothing-here")
    ... except NoLink as error:
    ...     print(error)
    the serial line serial:///dev/nothing-here cannot be opened: ...
    """

    status = 3


class RefusedByRobot(KickctlError):
    """The robot is there and says no: version, token, lease.

    >>> with connect("sim://", observe=True) as robot:
    ...     try:
    ...         robot.kick("phase")
    ...     except RefusedByRobot as error:
    ...         print(error)
    this computer does not have the robot's token, so it may only look, and stop the robot
    """

    status = 4


class LeaseLost(RefusedByRobot):
    """The robot is not, or no longer, controlled by this host.

    It is one kind of refusal: `except RefusedByRobot` catches it too.

    >>> issubclass(LeaseLost, RefusedByRobot), LeaseLost.status
    (True, 4)
    """


class TokenRefused(RefusedByRobot):
    """The robot has another token than this host."""


class RobotFault(KickctlError):
    """The robot is in fault: it has stopped, and runs again only after `clear` and `start`.

    >>> def kick_or_say_why(robot):
    ...     try:
    ...         print(robot.kick_and_watch("phase"))
    ...     except RobotFault as fault:
    ...         print(fault.message, fault.hint, sep="; ")
    >>> with connect("sim://", seed=1) as robot:
    ...     kick_or_say_why(robot)
    The kick reversed the robot: a phase kick of 4 ticks at tick ...
    """

    status = 5


class Interrupted(KickctlError):
    """A person, or the system, has ended the command: ^C, SIGTERM, or a terminal that closed."""

    status = 130


_STATUS_BY_CODE = {
    "usage": WrongUse,
    "range": WrongUse,
    "unknown": WrongUse,
    "state": NotDone,
    "busy": NotDone,
    "fault": RobotFault,
    "lease": LeaseLost,
    "token": TokenRefused,
}


def from_robot(error: dict[str, object]) -> KickctlError:
    """The exception for a refusal as the robot sends it: {code, message, hint}."""
    kind = _STATUS_BY_CODE.get(str(error.get("code")), RefusedByRobot)
    return kind(
        "the robot refuses: " + printable(str(error.get("message"))),
        printable(str(error.get("hint", ""))),
    )


def escaped(text: str) -> str:
    """The text with codes for the letters that cannot be printed, but for line ends."""
    return "".join(
        letter
        if letter.isprintable() or letter == "\n"
        else letter.encode("unicode_escape").decode("ascii")
        for letter in text
    )


def quotable(text: str) -> str:
    """What a person gave, on one line of a message: at most 300 letters, codes for odd ones."""
    return escaped(text[:300]).replace("\n", "\\n")


def printable(text: str) -> str:
    """Text of a peer, cut to 300 characters and without anything that a terminal would obey."""
    return "".join(letter for letter in text[:300] if letter.isprintable())
