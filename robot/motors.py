"""What the loop knows of hardware: a motor, a battery, a clock.

The brick (robot/ev3.py) and the simulator (sim_motor/brick.py) implement them.
"""

import sys
import time

# A program that wakes so late was held up, such as by a swapping machine.
HELD_UP_S = 0.1


def is_number(value):
    """Whether what an engineer's own motor or battery has returned is a finite number."""
    return (
        isinstance(value, (int, float))
        and not isinstance(value, bool)
        and abs(value) <= sys.float_info.max
    )


class MotorFault(Exception):
    """A motor does not obey or answer; the message says which, why and what to do.

    Args:
        message: In words.
        absent: Whether there is no motor that this program could drive, or has driven; also an
            attribute.
    """

    def __init__(self, message, absent=False):
        super().__init__(message)
        self.absent = absent


class Motor:
    """One wheel's motor, on its own axis.

    Positive is the motor's own positive turn, also if it is mounted mirrored.

    Attributes:
        model: Which motor it is, as a name that hosts look up in their motors files; empty if it
            has none.
        emergency_stop: A motor that another process can stop has a method of this name, without
            arguments. The watchdog, a fork of the program, calls it when the program hangs or has
            died. It must return at once, and may be called as often as one likes. The method may
            use files, and descriptors that were open before the fork, but no threads. None: the
            watchdog cannot stop this motor.
    """

    model = ""
    emergency_stop = None

    def angle_rad(self):
        """The tacho's angle.

        Returns:
            The angle since the motor was found, rad; in whole degrees on the EV3.

        Raises:
            MotorFault: The motor does not answer.
        """
        raise NotImplementedError

    def write_duty(self, duty_pct):
        """Run at a duty cycle.

        Args:
            duty_pct: A whole number from -100 to 100, percent of full PWM; 0 brakes.

        Raises:
            MotorFault: The motor does not obey.
        """
        raise NotImplementedError

    def stop(self):
        """Stop and hold by the electrical brake. May be called at any time, as often as one likes.

        Raises:
            MotorFault: The motor does not obey.
        """
        raise NotImplementedError

    def find(self):
        """Find a motor that failed, and brake it; its angle goes on from where it was.

        Nothing happens if the motor is well. A motor that cannot be lost need not have this method
        of its own.

        Raises:
            MotorFault: The motor is not there.
        """


class Battery:
    """Where the motors' power comes from.

    Attributes:
        warn_v: Below this voltage the battery should be charged, V.
        stop_v: Below this voltage it can no longer drive the robot, V.
    """

    warn_v = stop_v = 0.0

    def voltage_v(self):
        """The battery's voltage at this moment.

        Returns:
            The voltage, V, or None if it cannot be read.
        """
        raise NotImplementedError


class MonotonicClock:
    """Real time. A virtual clock has the same two methods and advances when it is waited for."""

    # The time on a clock that never jumps, s. Not a method: a tick asks twice, and a call costs the
    # brick 40 us.
    now = staticmethod(time.monotonic)

    def wait(self, deadline, serve):
        """Return at a time, and serve links until then.

        Args:
            deadline: The time on this clock, s.
            serve: Called with the time that is left, s, at least once.
        """
        while True:
            left = deadline - self.now()
            serve(max(0.0, left))
            late_s = self.now() - deadline
            if late_s >= HELD_UP_S:
                serve(0.0)  # what came meanwhile says that nobody was silent
            if late_s >= 0.0:
                return
