"""One wheel's neurons from tick to tick: the controller's equations under a kick, if one acts."""

from robot.controller import actual_positions, lagging_angle, step_wheel
from robot.kicks import WHEELS, apply_kick, direction, seen_positions


class Wheel(object):
    """The membrane potentials of a wheel, and the force and torque of its latest tick.

    Args:
        side: 'left' or 'right'.

    Attributes:
        phi: The wheel's angle at the beginning of a tick, rad. Set by the caller who reads it.
        phi_before: The angle of the tick before, rad, if the wheel was under control; else None.
        x1: First membrane potential, 1.
        x2: Second membrane potential, 1.
        force: F_tan of the latest tick, 1.
        torque: M of the latest tick, in (-1, 1).
    """

    __slots__ = ("index", "side", "phi", "phi_before", "x1", "x2", "force", "torque")

    def __init__(self, side):
        self.index = WHEELS.index(side)
        self.side = side
        self.phi = self.x1 = self.x2 = self.force = self.torque = 0.0
        self.phi_before = None

    def step(self, tick, dt_s, params, kick):
        """Advance by one tick.

        Args:
            tick: Its number.
            dt_s: How long it lasts, s.
            params: A robot.params.Params.
            kick: The robot.kicks.Kick of the robot, which may be over or act on the other wheel
                only, or None.

        Returns:
            The torque M, in (-1, 1).
        """
        a, tau_s, k = params.a, params.tau_s, params.k
        phi, x1, x2 = self.phi, self.x1, self.x2
        actual_1, actual_2 = rod_1, rod_2 = seen_1, seen_2 = actual_positions(phi)
        if params.rod_lag_s and self.phi_before is not None:
            rod_1, rod_2 = actual_positions(
                lagging_angle(phi, self.phi_before, dt_s, params.rod_lag_s)
            )
        if kick is not None and self.side in kick.wheels:
            numbers = kick.numbers(self.index)
            x1, x2, a, tau_s, k, beta, shift_rad = apply_kick(numbers, tick, x1, x2, a, tau_s, k)
            seen_1, seen_2 = seen_positions(phi, beta, shift_rad)
        x1, x2, force, torque = step_wheel(
            x1,
            x2,
            actual_1,
            actual_2,
            rod_1,
            rod_2,
            seen_1,
            seen_2,
            dt_s,
            a,
            tau_s,
            k,
            params.rods,
        )
        self.x1, self.x2, self.force, self.torque = x1, x2, force, torque
        self.phi_before = phi
        return torque

    def rest(self):
        """A tick without control: the potentials stay, no force acts."""
        self.force = self.torque = 0.0
        self.phi_before = None


class Side(object):
    """A wheel, its motor, and its latest angles (rad), which show where it goes."""

    __slots__ = ("wheel", "motor", "travel")

    def __init__(self, wheel, motor, travel):
        self.wheel = wheel
        self.motor = motor
        self.travel = travel

    def direction(self):
        """1 forward, -1 backward, 0 at rest."""
        return direction(self.travel[-1] - self.travel[0]) if self.travel else 0
