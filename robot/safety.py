"""What stands between the controller and the motors.

The limiter, the robot's states, and the dead-man of the lease.
"""

from math import isnan

from robot.errors import Refused
from robot.record import STATES

IDLE, RUNNING, HELD, STOPPED, FAULT = range(len(STATES))


def limit_duty(torque, max_duty_pct):
    """The duty cycle for a relative torque.

    A whole number of percent, never beyond +-max_duty_pct nor +-100; 0 for NaN.
    """
    duty = max_duty_pct * torque
    if isnan(duty):
        return 0
    bound = int(min(max_duty_pct, 100.0))
    return round(max(-bound, min(bound, duty)))


class Safety(object):
    """The state of the robot and why it is in it. A fault latches: only `clear` leaves it."""

    def __init__(self):
        self.state = IDLE
        self.reason = "not started yet"

    def start(self):
        """To running. Raises Refused in a fault or when running already."""
        if self.state == FAULT:
            raise Refused(
                "fault",
                "the robot is in fault: " + self.reason,
                "mend the cause, then clear the fault",
            )
        if self.state in (RUNNING, HELD):
            raise Refused("state", "the robot runs already", "stop it first to start anew")
        self._enter(RUNNING, "started")

    def stop(self, reason):
        """To stopped, from anywhere but a fault, which stays."""
        if self.state != FAULT:
            self._enter(STOPPED, reason)

    def hold(self, reason):
        """From running to held: motors braked, neurons paused."""
        self._enter(HELD, reason)

    def resume(self, reason):
        """From held to running."""
        self._enter(RUNNING, reason)

    def fault(self, reason):
        """To fault, from anywhere. The first cause stays the one that is told."""
        if self.state != FAULT:
            self._enter(FAULT, reason)

    def clear(self):
        """From fault to stopped. Raises Refused if there is none."""
        if self.state != FAULT:
            raise Refused("state", "there is no fault to clear")
        self._enter(STOPPED, "fault cleared")

    def _enter(self, state, reason):
        self.state = state
        self.reason = reason


class Lease(object):
    """Who may command the robot, and when that host was last heard (s of the robot's clock)."""

    def __init__(self):
        self.holder = self.name = self._heard = None

    def take(self, holder, name, now):
        """Give the lease to `holder`, who may hold it already.

        Raises Refused while another has it.
        """
        if self.holder not in (None, holder):
            raise Refused(
                "lease",
                "'{}' controls the robot".format(self.name),
                "wait until it lets go; anyone may stop the robot",
            )
        self.holder = holder
        self.name = name
        self._heard = now

    def require(self, holder):
        """Raises Refused unless `holder` has the lease."""
        if self.holder != holder:
            raise Refused("lease", "you do not control the robot", "take the lease first")

    def heard(self, holder, now):
        """The holder was heard: its time starts anew."""
        if self.holder == holder:
            self._heard = now

    def release(self, holder):
        """Let go; a host that does so is not lost."""
        if self.holder == holder:
            self.holder = None

    def expire(self, now, patience_s):
        """True, once, when the holder has been silent for longer than patience_s.

        The lease is free then.
        """
        if self.holder is None or now - self._heard <= patience_s:
            return False
        self.holder = None
        return True
