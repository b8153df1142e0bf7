"""The controllers of all wheels of a body, compiled together.

Robot/controller.py with one rod, and the kicks of robot/kicks.py.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from robot import kicks
from robot.controller import actual_positions, step_wheel
from sim_motor.compiled import compiled, jit

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

_actual_positions, _step_wheel = compiled(actual_positions), compiled(step_wheel)
_seen_positions, _pulse_weight, _pulsed = (
    compiled(kicks.seen_positions),
    compiled(kicks.pulse_weight),
    compiled(kicks.pulsed),
)
NEVER = -1


class Wheels:
    """All wheels of a body: potentials, constants, and the quenched kick that each is under.

    Each name stands for (wheels,).

    x2 is a potential without a rod. begin, ticks: of the kick, in steps; begin is NEVER where there
    is none. All stand in two arrays, `floats` (7, wheels) and `whole` (4, wheels), which compiled
    code gets faster than eleven.
    """

    def __init__(self, wheels: int, a: float, tau_s: float, k: float, radius_m: float) -> None:
        """So many equal wheels, not kicked, with potentials 0."""
        self.floats = np.zeros((7, wheels))
        self.whole = np.zeros((4, wheels), dtype=np.int64)
        self.x1, self.x2, self.a, self.tau_s, self.k, self.radius_m, self.value = self.floats
        self.begin, self.ticks, self.pulse, self.smooth = self.whole
        self.a[:], self.tau_s[:], self.k[:], self.radius_m[:], self.begin[:], self.pulse[:] = (
            a,
            tau_s,
            k,
            radius_m,
            NEVER,
            kicks.NO_PULSE,
        )


@jit
def drive(
    step: int,
    dt_s: float,
    floats: Array,
    whole: Whole,
    angles: Whole,
    qpos: Array,
    ctrl: Array,
    drags: Array,
    bodies: Whole,
    velocity: Array,
    pull: Array,
) -> None:
    """Step all neurons by dt_s, and set the motors' torques (N m), R k sin(phi) (x_t - cos phi), and the drag of bodies (N).

    floats, whole: of Wheels. angles: where in qpos the wheels' angles stand; bodies: which rows of
    `pull`, (bodies, 6), are the cars'; velocity: theirs, 3 each.
    """
    x1, x2, gain, time_constant, spring, radius_m, value = floats
    begin, ticks, pulse, smooth = whole
    for i in range(len(angles)):
        phi = qpos[angles[i]]
        a, tau_s, k = gain[i], time_constant[i], spring[i]
        actual_1, actual_2 = _actual_positions(phi)
        seen_1, seen_2 = actual_1, actual_2
        age = step - begin[i]
        if begin[i] != NEVER and 0 <= age < ticks[i]:
            weight = _pulse_weight(age, ticks[i], smooth[i])
            a, tau_s, k, beta, shift_rad = _pulsed(pulse[i], value[i], weight, a, tau_s, k)
            seen_1, seen_2 = _seen_positions(phi, beta, shift_rad)
        x1[i], x2[i], force, _ = _step_wheel(
            x1[i], x2[i], actual_1, actual_2, seen_1, seen_2, dt_s, a, tau_s, k, 1
        )
        ctrl[i] = radius_m[i] * force
    for i in range(len(bodies)):
        for axis in range(3):
            pull[bodies[i], axis] = -drags[i] * velocity[3 * i + axis]
