"""Runge and Kutta's classical method, written plainly for numba.

It has sin, cos and exp of `math`, and spreads points over both cores by prange.
"""

from functools import partial

import numba
import numpy as np

from host.theory.model.wheel import rates
from sim_motor.compiled import compiled
from tests.bench_theory.problem import MEASURED_S, TRANSIENT_S, Contestant, averages, starts

STEPS_S = (0.01, 0.005, 0.002, 0.001)
_rates = compiled(rates)


@numba.njit(error_model="numpy")
def _field(y, p, around):
    x1, x2, phi, omega, _ = y
    a, b, c, d = _rates(x1, x2, phi, omega, p[0], p[1], p[2], p[3], p[4], p[5])
    return a, b, c, d, (omega - around) ** 2


@numba.njit(error_model="numpy")
def _moved(y, h, f):
    return y[0] + h * f[0], y[1] + h * f[1], y[2] + h * f[2], y[3] + h * f[3], y[4] + h * f[4]


@numba.njit(error_model="numpy")
def _follow(y, p, around, step_s, count):
    for _ in range(count):
        f1 = _field(y, p, around)
        f2 = _field(_moved(y, step_s / 2, f1), p, around)
        f3 = _field(_moved(y, step_s / 2, f2), p, around)
        f4 = _field(_moved(y, step_s, f3), p, around)
        y = _moved(
            _moved(_moved(_moved(y, step_s / 6, f1), step_s / 3, f2), step_s / 3, f3),
            step_s / 6,
            f4,
        )
    return y


@numba.njit(error_model="numpy", parallel=True)
def _all(states, parameters, step_s, transient, measured):
    count = states.shape[1]
    at_start, at_end = np.empty((4, count)), np.empty((5, count))
    for i in numba.prange(count):
        p = parameters[:, i].copy()
        y = _follow(
            (states[0, i], states[1, i], states[2, i], states[3, i], 0.0), p, 0.0, step_s, transient
        )
        at_start[0, i], at_start[1, i], at_start[2, i], at_start[3, i] = y[:4]
        y = _follow((y[0], y[1], y[2], y[3], 0.0), p, y[3], step_s, measured)
        at_end[0, i], at_end[1, i], at_end[2, i], at_end[3, i], at_end[4, i] = y
    return at_start, at_end


def prepared(step_s, parameters):
    """The work with steps of step_s."""
    states = starts(parameters.shape[1])
    _all(states[:, :2], parameters[:, :2], step_s, 1, 1)
    return lambda: averages(
        *_all(states, parameters, step_s, round(TRANSIENT_S / step_s), round(MEASURED_S / step_s))
    )


def contestants():
    """numba with all steps."""
    for step_s in STEPS_S:
        yield Contestant(
            "numba RK4",
            f"step {1000 * step_s:g} ms",
            int(max(4, 0.016 / step_s)),
            partial(prepared, step_s),
        )
