"""Which of the robots is this? For a few seconds it blinks and beeps."""

LASTS_S = 3.0
# Half a period is light and loud, the other half dark and silent.
PERIOD_S = 0.5


class Beacon(object):
    """The request to show which robot this is. The panels of the program show it.

    Attributes:
        ways: How this robot shows itself: 'lights', 'beep', 'words'.
        by: Who has asked last.
        number: How often somebody has asked.
    """

    def __init__(self):
        self.ways = []
        self.by = ""
        self.number = 0
        self._since = -LASTS_S

    def begin(self, by, now):
        """Show the robot for LASTS_S. A robot that does so already goes on, and for no longer.

        Args:
            by: Who asks.
            now: The robot's clock, s.

        Returns:
            For how long the robot will still show itself, s.
        """
        if not now - self._since < LASTS_S:
            self.by = by
            self.number += 1
            self._since = now
        return self._since + LASTS_S - now

    def phase(self, now):
        """What panels show now.

        Args:
            now: The robot's clock, s.

        Returns:
            True to be light and loud, False to be dark and silent; None while nobody asks.
        """
        passed = now - self._since
        return passed % PERIOD_S < PERIOD_S / 2 if passed < LASTS_S else None


class Announcer(object):
    """A panel of the program for robots without lights: it says in words that this is the robot.

    Args:
        say: Called with the words.
    """

    ways = ("words",)

    def __init__(self, say):
        self._say = say
        self._number = 0

    def serve(self, loop):
        """Say it once for each request.

        Args:
            loop: The robot.loop.Loop.
        """
        if loop.beacon.number != self._number:
            self._number = loop.beacon.number
            self._say("kickctl identify: {} is looking for this robot".format(loop.beacon.by))

    def close(self):
        """Nothing is open."""
