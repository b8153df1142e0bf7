"""A serial line to a host: its argument in words, and the open line.

pyserial is imported and the line opened before the loop runs. If the line breaks later, that is no
fault of the robot: the server opens it again when it is back.
"""

import errno
import fcntl
import os
import termios

from robot.errors import Refused
from robot.wire import BAUD

FASTEST_BAUD = 4000000

_HINTS = {
    errno.ENOENT: "is its cable in? `ls /dev/tty*` lists the lines of this machine",
    errno.EACCES: "add this user to the group dialout, then log in again",
    errno.EBUSY: "end the program that has it; `sudo fuser -v {}` names it",
    errno.ENOTTY: "name a serial line, such as /dev/ttyUSB0",
}
# What the kernel says of a line that another program has locked, and of what is no serial line.
_ALIASES = {errno.EAGAIN: errno.EBUSY, errno.EINVAL: errno.ENOTTY, errno.EISDIR: errno.ENOTTY}
_WORDS = {
    errno.EBUSY: "another program has it open",
    errno.ENOTTY: "it is not a serial line, or does not know this baud rate",
}


def parse(argument):
    """The device and the baud rate in DEVICE or DEVICE@BAUD.

    Args:
        argument: The text.

    Returns:
        (device, baud rate).

    Raises:
        Refused: There is no device, or the baud rate is none.
    """
    device, at, baud = argument.rpartition("@")
    if not at:
        device, baud = argument, str(BAUD)
    digits = 0 < len(baud) < 9 and not baud.strip("0123456789")
    if not device or not digits or not 0 < int(baud) <= FASTEST_BAUD:
        raise Refused(
            "usage",
            "--serial {} names no serial line".format(argument),
            "write DEVICE or DEVICE@BAUD, for example /dev/ttyUSB0@{}; baud rates go up to"
            " {}".format(BAUD, FASTEST_BAUD),
        )
    return device, int(baud)


class SerialLine(object):
    """A serial line that is open now and can be opened again.

    Args:
        argument: DEVICE or DEVICE@BAUD.
        say: Takes a line of text for the person who reads the log.

    Raises:
        Refused: The argument is wrong, there is no pyserial, or the line cannot be opened.
    """

    def __init__(self, argument, say):
        self._device, self._baud = parse(argument)
        self._say = say
        self._broken = False
        try:
            import serial
        except ImportError as error:
            raise Refused(
                "usage",
                "--serial needs pyserial: {}".format(error),
                "install it (Debian, ev3dev: apt-get install python3-serial), or leave --serial"
                " out",
            ) from None
        self._library = serial
        try:
            self._first = self._open()
        except OSError as error:
            raise Refused(
                "usage",
                "the serial line {} cannot be opened: {}".format(self._device, error.strerror),
                _HINTS.get(error.args[0], "check its cable and adapter").format(self._device),
            ) from error

    def open(self):
        """The open line: the first time the one that the constructor has opened, later a new one.

        Returns:
            A link as robot.server.Server.adopt wants it.

        Raises:
            OSError: It cannot be opened now. `say` has heard so, once.
        """
        if self._first is not None:
            line, self._first = self._first, None
            return line
        try:
            line = self._open()
        except OSError as error:
            if not self._broken:
                self._broken = True
                self._say(
                    "the serial line {} broke: {}; the robot goes on without it, and tries every"
                    " second to open it again".format(self._device, error.strerror)
                )
            raise
        self._broken = False
        self._say("the serial line {} was opened again".format(self._device))
        return line

    def _open(self):
        """The line, opened for this program alone. Raises OSError with a number and words."""
        try:
            line = self._library.Serial(self._device, self._baud, timeout=0, write_timeout=0)
        # pyserial may say ValueError or termios.error of a baud rate or of what is no serial line.
        except (OSError, ValueError, OverflowError, termios.error) as error:
            raise _explained(error) from error
        try:
            fcntl.flock(line.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)
            fcntl.ioctl(line.fileno(), termios.TIOCEXCL)
        except OSError as error:
            line.close()
            raise _explained(error) from error
        return line


def _explained(error):
    """The OSError for what opening a serial line has raised."""
    number = error.args[0] if error.args and isinstance(error.args[0], int) else errno.ENOTTY
    number = _ALIASES.get(number, number)
    return OSError(number, _WORDS.get(number) or os.strerror(number))
