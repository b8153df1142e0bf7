"""The battery: its voltage, a warning, when it is empty, and how duty cycles make up for it."""

from robot.motors import is_number

# At this voltage duty cycles need no correction: brickd's 'full' of the lithium pack.
NOMINAL_V = 7.5
# Share of a new reading in the mean: under load the voltage sags by some tenths of a volt for a
# moment.
SMOOTHING = 0.5
# How far above the warning the voltage must rise before the next warning can come.
RECOVERED_V = 0.3


class Power(object):
    """The voltage of a battery, read when `read` is called.

    Args:
        battery: A robot.motors.Battery, or None if the robot has none that can be measured.

    Attributes:
        latest_v: The last reading in V; None if there is none.
        mean_v: The smoothed voltage in V; None if there was no reading yet.
    """

    def __init__(self, battery):
        self._battery = battery
        self._warned = False
        self.latest_v = self.mean_v = None
        self.read()

    def read(self):
        """Take a reading."""
        volts = None if self._battery is None else self._battery.voltage_v()
        # No host takes what is no number, and the mean would never be one again.
        if not is_number(volts):
            volts = None
        self.latest_v = volts
        if volts is not None:
            self.mean_v = (
                volts if self.mean_v is None else self.mean_v + SMOOTHING * (volts - self.mean_v)
            )

    def warning(self):
        """A warning that the battery is low; it comes once, until the battery has been charged.

        Returns:
            The warning in words, or an empty string.
        """
        if self.mean_v is None:
            return ""
        due = self.mean_v < self._battery.warn_v and not self._warned
        if due or self.mean_v > self._battery.warn_v + RECOVERED_V:
            self._warned = due
        return "the battery is low ({:.1f} V): charge it".format(self.mean_v) if due else ""

    def exhaustion(self):
        """The reason why the battery can no longer drive the robot.

        Returns:
            The reason in words, or an empty string while the battery can drive it.
        """
        if self.mean_v is None or self.mean_v >= self._battery.stop_v:
            return ""
        return "the battery is empty ({:.1f} V): charge it".format(self.mean_v)

    def duty_scale(self):
        """The factor by which duty cycles make up for a voltage that differs from NOMINAL_V.

        Returns:
            0.5 to 2, rounded to whole percents.
        """
        if self.mean_v is None:
            return 1.0
        return round(NOMINAL_V / max(0.5 * NOMINAL_V, min(2.0 * NOMINAL_V, self.mean_v)), 2)
