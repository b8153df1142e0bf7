"""The controllers of all wheels of a body, compiled together: robot/controller.py with one rod, and the kicks of robot/kicks.py."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robot import kicks
from robot.controller import actual_positions, step_wheel
from sim_motor.compiled import assembled, compiled

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

_actual_positions, _step_wheel = compiled(actual_positions), compiled(step_wheel)
_seen_positions, _pulse_weight, _pulsed = compiled(kicks.seen_positions), compiled(kicks.pulse_weight), compiled(kicks.pulsed)
NEVER = -1


class Wheels(NamedTuple):
    """All wheels of a body: potentials, constants, and the quenched kick that each is under, (wheels,).

    x2 is a potential without a rod. begin, ticks: of the kick, in steps; begin is NEVER where there is none.
    """

    x1: Array
    x2: Array
    a: Array
    tau_s: Array
    k: Array
    radius_m: Array
    begin: Whole
    ticks: Whole
    pulse: Whole
    value: Array
    smooth: Whole

    @classmethod
    def of(cls, wheels: int, a: float, tau_s: float, k: float, radius_m: float) -> Wheels:
        """So many equal wheels, not kicked, with potentials 0."""
        x1, x2, gain, time_constant, spring, radius = (np.full(wheels, value) for value in (0.0, 0.0, a, tau_s, k, radius_m))
        begin, ticks, pulse, smooth = (np.full(wheels, value, dtype=np.int64) for value in (NEVER, 0, kicks.NO_PULSE, 0))
        return cls(x1, x2, gain, time_constant, spring, radius, begin, ticks, pulse, np.zeros(wheels), smooth)


@assembled
def drive(
    step: int, dt_s: float, w: Wheels, angles: Whole, qpos: Array, ctrl: Array, drags: Array, bodies: Whole, velocity: Array, pull: Array
) -> None:
    """Step all neurons by dt_s, and set the motors' torques (N m), R k sin(phi) (x_t - cos phi), and the drag of bodies (N).

    angles: where in qpos the wheels' angles stand; bodies: which rows of `pull`, (bodies, 6), are the cars'; velocity: theirs, 3 each.
    """
    for i in range(len(angles)):
        phi = qpos[angles[i]]
        a, tau_s, k = w.a[i], w.tau_s[i], w.k[i]
        actual_1, actual_2 = _actual_positions(phi)
        seen_1, seen_2 = actual_1, actual_2
        age = step - w.begin[i]
        if w.begin[i] != NEVER and 0 <= age < w.ticks[i]:
            weight = _pulse_weight(age, w.ticks[i], w.smooth[i])
            a, tau_s, k, beta, shift_rad = _pulsed(w.pulse[i], w.value[i], weight, a, tau_s, k)
            seen_1, seen_2 = _seen_positions(phi, beta, shift_rad)
        w.x1[i], w.x2[i], force, _ = _step_wheel(w.x1[i], w.x2[i], actual_1, actual_2, seen_1, seen_2, dt_s, a, tau_s, k, 1)
        ctrl[i] = w.radius_m[i] * force
    for i in range(len(bodies)):
        for axis in range(3):
            pull[bodies[i], axis] = -drags[i] * velocity[3 * i + axis]
