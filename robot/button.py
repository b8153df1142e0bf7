"""The brick's back button stops the robot."""

import os
import struct

DEVICE = "/dev/input/by-path/platform-gpio_keys-event"
# The kernel's struct input_event with this machine's sizes: seconds, microseconds, type, code,
# value.
EVENT = struct.Struct("llHHi")
KEY, BACK, PRESSED = 1, 14, 1
EVENTS_PER_READ = 16


class BackButton(object):
    """The button, a panel of the program. It does nothing if the brick's buttons cannot be opened.

    Args:
        device: The kernel's file for the buttons.
    """

    def __init__(self, device=DEVICE):
        try:
            self._file = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        except OSError:
            self._file = -1

    def serve(self, loop):
        """Stop the motors if the button was pressed; returns at once.

        Args:
            loop: The robot.loop.Loop.
        """
        if self._file >= 0 and self._pressed():
            loop.stop("the brick's back button stopped it")

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
        except OSError:
            self.close()
            return False
        events = EVENT.iter_unpack(data[: len(data) // EVENT.size * EVENT.size])
        return any(
            (kind, code, value) == (KEY, BACK, PRESSED) for _, _, kind, code, value in events
        )
