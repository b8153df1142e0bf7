"""The brick's two lights show the robot's state."""

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

    Args:
        root: Where the kernel's classes of devices are.
    """

    def __init__(self, root):
        self._folder = os.path.join(root, "leds")
        self._state = None

    def serve(self, loop):
        """Show the loop's state if it has changed.

        Args:
            loop: The robot.loop.Loop.
        """
        state = loop.safety.state
        if state != self._state:
            self._state = state
            self._show(LEFT_AND_RIGHT[STATES[state]])

    def alarm(self):
        """Show red: the program is dead or hangs, and the watchdog has stopped the motors."""
        self._show((RED, RED))

    def close(self):
        """Switch both off: no program runs."""
        self._show((DARK, DARK))

    def _show(self, lights):
        for side, light in enumerate(lights):
            for colour, brightness in zip(("red", "green"), light):
                name = "led{}:{}:brick-status".format(side, colour)
                try:
                    with open(os.path.join(self._folder, name, "brightness"), "w") as file:
                        file.write(str(brightness))
                except OSError:
                    pass
