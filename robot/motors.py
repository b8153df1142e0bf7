"""The seams to hardware: a motor, a battery, a clock. The brick and the simulator implement them.

The loop knows no more.
"""

import select
import time


class MotorFault(Exception):
    """A motor does not obey or answer; the message says which, why and what to do."""


class Motor:
    """One wheel's motor, on its own axis.

    Positive is the motor's own positive turn, whatever its mounting.
    """

    def angle_rad(self):
        """The tacho angle in rad since the motor was found; in whole degrees on the EV3.

        Raises MotorFault.
        """
        raise NotImplementedError

    def write_duty(self, duty_pct):
        """Run at duty_pct, an int in -100 .. 100, percent of full PWM; 0 brakes.

        Raises MotorFault.
        """
        raise NotImplementedError

    def stop(self):
        """Stop and hold by the electrical brake. May be called at any time, any number of times.

        Raises MotorFault if it failed.
        """
        raise NotImplementedError

    def find(self):
        """Find a motor that failed again, braked, its angle going on from where it was.

        Nothing if it is well. Raises MotorFault.

        What cannot be lost need not have this method of its own.
        """


class Battery:
    """Where the motors' power comes from.

    Below warn_v (V) it should be charged, below stop_v it no longer can drive the robot.
    """

    warn_v = stop_v = 0.0

    def voltage_v(self):
        """The battery's voltage in V at this moment, or None if it cannot be told."""
        raise NotImplementedError


class MonotonicClock:
    """Real time. A virtual clock has the same two methods and advances when it is waited for."""

    def now(self):
        """Seconds on a clock that never jumps."""
        return time.monotonic()

    def wait(self, deadline, serve):
        """Return at `deadline` (s, of this clock), having called serve(timeout_s) in the time that was left, and once if none was."""
        while True:
            left = deadline - self.now()
            serve(max(0.0, left))
            if self.now() >= deadline:
                return


def sleep(timeout_s):
    """A `serve` for a robot without any link: sleeps, to the resolution of select."""
    select.select((), (), (), timeout_s)
