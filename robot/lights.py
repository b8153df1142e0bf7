"""The brick's two lights show the robot's state, and blink to show which robot it is."""

import os

from robot.record import STATES

# Brightness of the red and of the green half.
DARK, RED, GREEN, ORANGE = (0, 0), (255, 0), (0, 255), (255, 255)
LEFT_AND_RIGHT = {
    "idle": (ORANGE, ORANGE),
    "running": (GREEN, GREEN),
    "held": (GREEN, ORANGE),
    "stopped": (RED, ORANGE),
    "fault": (RED, RED),
}


class Lights(object):
    """Both lights, a panel of the program. Lights that cannot be written stay as they are.

    Their files are opened once: opening takes longer than writing.

    Args:
        root: Where the kernel's classes of devices are.
    """

    def __init__(self, root):
        self._files = [
            [self._open(root, side, colour) for colour in ("red", "green")] for side in (0, 1)
        ]
        self._look = None

    @property
    def ways(self):
        """How they show which robot this is: not at all if there are none."""
        return ("lights",) if max(max(files) for files in self._files) >= 0 else ()

    def serve(self, loop):
        """Show the loop's state, blinking if somebody asks which robot this is.

        They are written only when that changes anything, in the pause after a tick.

        Args:
            loop: The robot.loop.Loop.
        """
        look = LEFT_AND_RIGHT[STATES[loop.safety.state]]
        if loop.beacon.phase(loop.clock.now()) is False:
            look = (DARK, DARK)
        if look != self._look:
            self._show(look)

    def alarm(self):
        """Show red: the program is dead or hangs, and the watchdog has stopped the motors.

        The watchdog calls this in its own process.
        """
        self._show((RED, RED))

    def forget(self):
        """Show the state anew with the next `serve`: the watchdog may have shown red meanwhile."""
        self._look = None

    def close(self):
        """Switch both off, and close their files: no program runs."""
        self._show((DARK, DARK))
        for files in self._files:
            for colour, file in enumerate(files):
                if file >= 0:
                    os.close(file)
                    files[colour] = -1

    @staticmethod
    def _open(root, side, colour):
        """A descriptor of a light's brightness; -1 if it cannot be opened."""
        name = "led{}:{}:brick-status".format(side, colour)
        try:
            return os.open(os.path.join(root, "leds", name, "brightness"), os.O_WRONLY)
        except OSError:
            return -1

    def _show(self, look):
        self._look = look
        for files, light in zip(self._files, look):
            for file, brightness in zip(files, light):
                if file >= 0:
                    try:
                        # Always three digits: a file that is no device keeps what is beyond.
                        os.pwrite(file, "{:03d}".format(brightness).encode("ascii"), 0)
                    except OSError:
                        pass
