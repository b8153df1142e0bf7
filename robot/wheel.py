"""One wheel's neurons from tick to tick.

The controller's equations under the kick that acts, if one does.
"""

from robot.controller import actual_positions, step_wheel
from robot.kicks import (
    MEMBRANE,
    WHEELS,
    invert_membrane,
    jump,
    pulse_weight,
    pulsed,
    seen_positions,
)


class Wheel(object):
    """The membrane potentials of a wheel ('left' or 'right'), and the force and torque of the latest tick.

    phi (rad) is the wheel's angle at the beginning of a tick; whoever reads it sets it.
    """

    __slots__ = ("index", "side", "phi", "x1", "x2", "force", "torque")

    def __init__(self, side):
        self.index = WHEELS.index(side)
        self.side = side
        self.phi = self.x1 = self.x2 = self.force = self.torque = 0.0

    def step(self, tick, dt_s, params, kick):
        """Advance by one tick of dt_s; `kick` acts in it, or is None. Returns the torque M."""
        a, tau_s, k = params.a, params.tau_s, params.k
        actual_1, actual_2 = seen_1, seen_2 = actual_positions(self.phi)
        if kick is not None and self.side in kick.wheels and kick.acts_at(tick):
            if kick.pulse:
                weight = pulse_weight(tick - kick.begin, kick.ticks, kick.smooth)
                a, tau_s, k, beta, shift_rad = pulsed(
                    kick.pulse, kick.values[self.index], weight, a, tau_s, k
                )
                seen_1, seen_2 = seen_positions(self.phi, beta, shift_rad)
            elif kick.mode == MEMBRANE:
                self.x1, self.x2 = invert_membrane(self.x1, self.x2)
            else:
                setattr(self, kick.variable, jump(getattr(self, kick.variable), kick.delta))
        self.x1, self.x2, self.force, self.torque = step_wheel(
            self.x1, self.x2, actual_1, actual_2, seen_1, seen_2, dt_s, a, tau_s, k, params.rods
        )
        return self.torque

    def rest(self):
        """A tick without control: the potentials stay, no force acts."""
        self.force = self.torque = 0.0
