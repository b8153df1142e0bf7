"""The brick's back button stops the robot."""

import os
import struct

DEVICE = "/dev/input/by-path/platform-gpio_keys-event"
# The kernel's struct input_event in the sizes of the machine that this runs on: seconds,
# microseconds, type, code, value.
EVENT = struct.Struct("llHHi")
KEY, BACK, PRESSED = 1, 14, 1
EVENTS_PER_READ = 16


class BackButton(object):
    """The button, read without waiting. A brick whose buttons cannot be opened does without."""

    def __init__(self, device=DEVICE):
        try:
            self._file = os.open(device, os.O_RDONLY | os.O_NONBLOCK)
        except OSError:
            self._file = -1

    def serve(self, loop):
        """Stop the loop's motors if the button was pressed."""
        if self._file >= 0 and self._pressed():
            loop.stop("stopped by the brick's back button")

    def close(self):
        """Give the button back."""
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
