"""What the loop makes of its battery.

Readings, a warning, the end, and by how much duty cycles make up for a low voltage.
"""

# The voltage at which max_duty_pct means what it says: brickd's 'full' of the lithium pack.
NOMINAL_V = 7.5
# Under load the voltage sags by some tenths of a volt for a moment; this much of each reading
# counts.
SMOOTHING = 0.5
# A battery is as good as new again when it has risen so far above the warning.
RECOVERED_V = 0.3


class Power(object):
    """A robot.motors.Battery or None, read when asked to.

    `latest_v` is the last reading, `mean_v` what it has lately been; or None.
    """

    def __init__(self, battery):
        self._battery = battery
        self._warned = False
        self.latest_v = self.mean_v = None
        self.read()

    def read(self):
        """Take a reading."""
        volts = None if self._battery is None else self._battery.voltage_v()
        self.latest_v = volts
        if volts is not None:
            self.mean_v = (
                volts if self.mean_v is None else self.mean_v + SMOOTHING * (volts - self.mean_v)
            )

    def warning(self):
        """What is to be said of a battery that is low: once, until it has been charged.

        Empty if nothing.
        """
        if self.mean_v is None:
            return ""
        due = self.mean_v < self._battery.warn_v and not self._warned
        if due or self.mean_v > self._battery.warn_v + RECOVERED_V:
            self._warned = due
        return "the battery is low ({:.1f} V): charge it".format(self.mean_v) if due else ""

    def exhaustion(self):
        """Why the battery no longer can drive the robot; empty if it can."""
        if self.mean_v is None or self.mean_v >= self._battery.stop_v:
            return ""
        return "the battery is empty ({:.1f} V): charge it".format(self.mean_v)

    def duty_scale(self):
        """The factor, in whole percents, that makes a duty cycle do what it would do at NOMINAL_V."""
        return 1.0 if self.mean_v is None else round(max(0.5, min(2.0, NOMINAL_V / self.mean_v)), 2)
