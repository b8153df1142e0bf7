"""The brick's back button stops the robot."""

import errno
import fcntl
import os
import struct

from robot.safety import HELD, RUNNING

DEVICE = "/dev/input/by-path/platform-gpio_keys-event"
# The kernel's struct input_event with this machine's sizes: seconds, microseconds, type, code,
# value.
EVENT = struct.Struct("llHHi")
KEY, BACK, PRESSED = 1, 14, 1
EVENTS_PER_READ = 16
# The kernel's EVIOCGRAB: with 1 its events go to this program alone, with 0 to all again.
GRAB = 0x40044590


class BackButton(object):
    """The button, a panel of the program.

    While the robot runs, the brick's menu does not get the buttons, or Back would open a dialog
    there. At rest they belong to the menu.

    Args:
        say: Takes a line of text for the person who reads the log.
        device: The kernel's file for the buttons.
    """

    def __init__(self, say, device=DEVICE):
        self._say = say
        self._grabbed = False
        try:
            self._file = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        except OSError as error:
            self._file = -1
            self._give_up(error)

    def serve(self, loop):
        """Stop the motors if the button was pressed; returns at once.

        Args:
            loop: The robot.loop.Loop.
        """
        if self._file < 0:
            return
        if self._pressed():
            loop.stop("the brick's back button stopped it")
        moves = loop.safety.state in (RUNNING, HELD)
        if self._file >= 0 and moves != self._grabbed:
            self._grab(moves)

    def close(self):
        """Close the kernel's file."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _pressed(self):
        try:
            data = os.read(self._file, EVENTS_PER_READ * EVENT.size)
        except BlockingIOError:
            return False
        except OSError as error:
            self.close()
            self._give_up(error)
            return False
        events = EVENT.iter_unpack(data[: len(data) // EVENT.size * EVENT.size])
        return any(
            (kind, code, value) == (KEY, BACK, PRESSED) for _, _, kind, code, value in events
        )

    def _grab(self, grab):
        self._grabbed = grab
        try:
            fcntl.ioctl(self._file, GRAB, int(grab))
        except OSError as error:
            if error.errno == errno.EBUSY:  # another program gets its events, and this one none
                self._give_up(error)

    def _give_up(self, error):
        self._say(
            "the brick's back button does not stop the motors: it cannot be read ({}). Is this user"
            " in the group input? `kickctl stop` stops the motors".format(error.strerror)
        )
