"""The controllers of all wheels of a body, compiled together.

They are those of robot/controller.py with one rod, under the kicks of robot/kicks.py.
"""

from __future__ import annotations

from math import isfinite

import numpy as np
from numpy.typing import NDArray

from robot.controller import actual_positions, step_wheel
from robot.kicks import QUENCH, apply_kick, seen_positions
from sim_motor.compiled import compiled, jit

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

_actual_positions, _step_wheel = compiled(actual_positions), compiled(step_wheel)
_apply_kick, _seen_positions = compiled(apply_kick), compiled(seen_positions)


class Wheels:
    """All wheels of a body: potentials, constants, and the quenched kick that each is under.

    Each name stands for an array, (wheels,). x2 is a potential without a rod. begin, ticks: of the
    kick, in steps; ticks is 0 where there is none. All stand in two arrays, `floats` (7, wheels)
    and `whole` (4, wheels), which compiled code gets faster than eleven.
    """

    def __init__(self, wheels: int, a: float, tau_s: float, k: float, radius_m: float) -> None:
        """Equal wheels, not kicked, with potentials 0."""
        self.floats = np.zeros((7, wheels))
        self.whole = np.zeros((4, wheels), dtype=np.int64)
        self.x1, self.x2, self.a, self.tau_s, self.k, self.radius_m, self.value = self.floats
        self.begin, self.ticks, self.pulse, self.smooth = self.whole
        self.a[:], self.tau_s[:], self.k[:], self.radius_m[:] = a, tau_s, k, radius_m


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
) -> bool:
    """Step all neurons by dt_s, and set the torques of the motors and the drag of the bodies.

    Torques, in N m, are R k sin(phi) (x_t - cos phi); drags are in N. floats, whole: of Wheels.
    angles: where in qpos the wheels' angles stand. bodies: the rows of `pull`, (bodies, 6), that
    are the cars'. velocity: theirs, 3 each. Returns whether all potentials and torques are finite.
    """
    finite = True
    x1, x2, gain, time_constant, spring, radius_m, value = floats
    begin, ticks, pulse, smooth = whole
    no_waveform = floats[0, :0]
    for i in range(len(angles)):
        phi = qpos[angles[i]]
        a, tau_s, k = gain[i], time_constant[i], spring[i]
        actual_1, actual_2 = _actual_positions(phi)
        kick = (QUENCH, begin[i], ticks[i], pulse[i], smooth[i] != 0, value[i], no_waveform)
        x1[i], x2[i], a, tau_s, k, beta, shift_rad = _apply_kick(
            kick, step, x1[i], x2[i], a, tau_s, k
        )
        seen_1, seen_2 = _seen_positions(phi, beta, shift_rad)
        x1[i], x2[i], force, _ = _step_wheel(
            x1[i],
            x2[i],
            actual_1,
            actual_2,
            actual_1,
            actual_2,
            seen_1,
            seen_2,
            dt_s,
            a,
            tau_s,
            k,
            1,
        )
        ctrl[i] = radius_m[i] * force
        finite = finite and isfinite(x1[i] + x2[i]) and isfinite(ctrl[i])
    for i in range(len(bodies)):
        for axis in range(3):
            pull[bodies[i], axis] = -drags[i] * velocity[3 * i + axis]
    return finite
