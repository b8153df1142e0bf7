"""The brick's speaker beeps while the robot shows which one it is."""

import os

from robot.button import EVENT

DEVICE = "/dev/input/by-path/platform-snd-legoev3-event"
# The kernel's type of sound events, and the code for a tone; its value is the frequency, 0 for
# silence.
SOUND, TONE = 0x12, 2
TONE_HZ = 880


class Speaker(object):
    """The speaker, a panel of the program. It is silent if the kernel's file cannot be opened.

    The kernel takes a tone without waiting. A tone lasts until the next one, also when the program
    dies.

    Args:
        device: The kernel's file for tones.
    """

    def __init__(self, device=DEVICE):
        try:
            self._file = os.open(device, os.O_WRONLY | os.O_NONBLOCK)
        except OSError:
            self._file = -1
        self._hz = 0

    @property
    def ways(self):
        """How it shows the robot: not at all without a speaker."""
        return () if self._file < 0 else ("beep",)

    def serve(self, loop):
        """Beep if the robot shows itself; returns at once.

        Args:
            loop: The robot.loop.Loop.
        """
        self._play(TONE_HZ if loop.beacon.phase(loop.clock.now()) else 0)

    def silence(self):
        """End a tone that another process of the program may have begun."""
        self._write(0)

    def close(self):
        """Be silent, and close the kernel's file."""
        self._play(0)
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def _play(self, hz):
        if hz != self._hz:
            self._hz = hz
            self._write(hz)

    def _write(self, hz):
        if self._file < 0:
            return
        try:
            os.write(self._file, EVENT.pack(0, 0, SOUND, TONE, hz))
        except OSError:
            pass  # robots without a beep are found by their lights
