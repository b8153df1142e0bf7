"""What stands between the controller and the motors: the limiter, the robot's states, the lease."""

from math import isnan

from robot.errors import Refused
from robot.record import STATES
from robot.words import duration, person

# In characters, so that a status fits into a frame whatever a motor's driver says.
LONGEST_REASON = 250

IDLE, RUNNING, HELD, STOPPED, FAULT = range(len(STATES))


def limit_duty(torque, max_duty_pct):
    """The duty cycle for a relative torque.

    Args:
        torque: Relative torque M, between -1 and 1; anything else is limited too.
        max_duty_pct: The duty cycle at M = 1, in percent.

    Returns:
        A whole number of percent, never beyond +-max_duty_pct nor +-100; 0 if the torque is NaN.
    """
    duty = max_duty_pct * torque
    if isnan(duty):
        return 0
    bound = int(min(max_duty_pct, 100.0))
    return round(max(-bound, min(bound, duty)))


class Safety(object):
    """The robot's state, and the reason for it. A fault latches: only `clear` ends it.

    Attributes:
        state: IDLE, RUNNING, HELD, STOPPED or FAULT.
        reason: Why the robot is in this state, in words.
    """

    def __init__(self):
        self.state = IDLE
        self.reason = "not started yet"

    def start(self):
        """Go to running.

        Raises:
            Refused: The robot is in fault, or runs already.
        """
        if self.state == FAULT:
            raise Refused(
                "fault",
                "the robot is in fault: " + self.reason,
                "mend the cause, then: kickctl clear, kickctl start",
            )
        if self.state in (RUNNING, HELD):
            raise Refused("state", "the robot runs already", "stop it first to start again")
        self._enter(RUNNING, "started")

    def stop(self, reason):
        """Go to stopped from any state but a fault, which stays.

        Args:
            reason: Who or what stopped the robot.
        """
        if self.state != FAULT:
            self._enter(STOPPED, reason)

    def hold(self, reason):
        """Go from running to held: motors brake, neurons pause.

        Args:
            reason: What the robot waits for.
        """
        self._enter(HELD, reason)

    def resume(self, reason):
        """Go from held back to running.

        Args:
            reason: Why it goes on.
        """
        self._enter(RUNNING, reason)

    def fault(self, reason):
        """Go to fault from any state. A second fault does not replace the first one's reason.

        Args:
            reason: The cause, and what a person can do.
        """
        if self.state != FAULT:
            self._enter(FAULT, reason)

    def clear(self):
        """Go from fault to stopped.

        Raises:
            Refused: There is no fault.
        """
        if self.state != FAULT:
            raise Refused("state", "there is no fault to clear", "kickctl status shows its state")
        self._enter(STOPPED, "fault cleared")

    def _enter(self, state, reason):
        self.state = state
        self.reason = reason[:LONGEST_REASON]


class Lease(object):
    """Which host may command the robot, since when, and when the robot last heard from it.

    Attributes:
        holder: The session that has the lease; None if nobody has it.
        name: What that host calls itself.
    """

    def __init__(self):
        self.holder = self.name = self._since = self._heard = None
        # Who lost the lease to somebody who took over, and to whom.
        self._loser = self._winner = None

    def take(self, holder, name, now, over=False):
        """Give the lease to a session, which may have it already.

        Args:
            holder: The session.
            name: What its host calls itself.
            now: s of the robot's clock.
            over: Whether to take it from another session.

        Returns:
            The name of the host from which it was taken, None if nobody has lost it.

        Raises:
            Refused: Another session has it.
        """
        loser = None
        if self.holder not in (None, holder):
            if not over:
                raise self._refusal(holder, now)
            loser = self.name
            self._loser, self._winner = self.holder, name
        elif self._loser == holder:
            self._loser = None
        if self.holder != holder:
            self._since = now
        self.holder = holder
        self.name = name
        self._heard = now
        return loser

    def held_s(self, now):
        """For how long the holder has had the lease, s; None if nobody has it.

        Args:
            now: s of the robot's clock.
        """
        return None if self.holder is None else now - self._since

    def taken_over_by(self, holder):
        """Who took the lease from a session that has not taken it again since; None if nobody did.

        Args:
            holder: The session.
        """
        return self._winner if holder == self._loser else None

    def require(self, holder, now):
        """Check that a session has the lease.

        Args:
            holder: The session.
            now: s of the robot's clock.

        Raises:
            Refused: It does not have the lease.
        """
        if self.holder != holder:
            raise self._refusal(holder, now)

    def _refusal(self, holder, now):
        if self.holder is None:
            winner = self.taken_over_by(holder)
            if winner is None:
                return Refused("lease", "you do not control the robot", "take the lease first")
            return Refused(
                "lease",
                "{} has taken over, and has finished".format(person(winner)),
                "take the lease again",
            )
        message = "the robot has been driven by {} for {}".format(
            person(self.name), duration(self.held_s(now))
        )
        if holder == self._loser:
            message = "{} has taken over, {} ago".format(
                person(self.name), duration(self.held_s(now))
            )
        return Refused(
            "lease",
            message,
            "wait until they have finished, or take over: --take-over, in Python"
            " robot.take_over(). Anyone may stop the robot: kickctl stop",
        )

    def heard(self, holder, now):
        """Note that the robot heard from a session; this counts if it has the lease.

        Args:
            holder: The session.
            now: s of the robot's clock.
        """
        if self.holder == holder:
            self._heard = now

    def release(self, holder):
        """Give the lease back; a host that does so is not lost.

        Args:
            holder: The session.
        """
        if self.holder == holder:
            self.holder = None

    def expire(self, now, patience_s):
        """Take the lease from a holder that has been silent for too long.

        Args:
            now: s of the robot's clock.
            patience_s: How long it may be silent.

        Returns:
            Whether the holder has just lost the lease.
        """
        if self.holder is None or now - self._heard <= patience_s:
            return False
        self.holder = None
        return True
