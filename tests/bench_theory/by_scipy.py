"""scipy's solvers, a point at a time, on two processes.

The rates are compiled, which is the best that its users can do.
"""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

import numba
import numpy as np
from scipy.integrate import odeint, solve_ivp

from host.theory.model.wheel import rates
from sim_motor.compiled import compiled
from tests.bench_theory.problem import MEASURED_S, START, TRANSIENT_S, WORKERS, Contestant, averages

_rates = compiled(rates)
TOLERANCES = (1e-6, 1e-8, 1e-10)


@numba.njit(error_model="numpy")
def field(time, state, constants):
    """The rates of the four variables, and of the fifth, which makes the standard deviation."""
    out = np.empty_like(state)
    x1, x2, phi, omega = state[:4]
    a, tau_s, k, inertia, friction, dry = constants[:6]
    around = constants[-1]
    out[0], out[1], out[2], out[3] = _rates(x1, x2, phi, omega, a, tau_s, k, inertia, friction, dry)
    if len(state) == 5:
        out[4] = (omega - around) ** 2
    return out


def by_solve_ivp(method, tolerance, state, seconds, constants):
    """The state after some seconds."""
    found = solve_ivp(
        field,
        (0.0, seconds),
        state,
        method,
        (seconds,),
        rtol=tolerance,
        atol=tolerance,
        args=(constants,),
    )
    return found.y[:, -1]


def by_odeint(tolerance, state, seconds, constants):
    """The state after some seconds."""
    return odeint(
        field,
        state,
        (0.0, seconds),
        (constants,),
        rtol=tolerance,
        atol=tolerance,
        mxstep=10**8,
        tfirst=True,
    )[-1]


def follow(solve, constants):
    """(before, after) measuring, of one wheel."""
    at_start = solve(np.array(START), TRANSIENT_S, np.append(constants, 0.0))
    return at_start, solve(np.append(at_start, 0.0), MEASURED_S, np.append(constants, at_start[3]))


def warm(solve):
    """Compile in a worker."""
    follow(partial(_short, solve), np.array([4.0, 1.0, 1.0, 1.0, 1.0, 0.0]))


def _short(solve, state, seconds, constants):
    return solve(state, 0.01, constants)


def prepared(pool, solve, parameters):
    """The work on two processes."""
    list(pool.map(warm, [solve] * (4 * WORKERS)))
    wheels = list(parameters.T)

    def run():
        found = list(pool.map(partial(follow, solve), wheels))
        return averages(
            np.array([at_start for at_start, _ in found]).T,
            np.array([at_end for _, at_end in found]).T,
        )

    return run


def contestants():
    """solve_ivp and odeint with all settings. The slower a method, the fewer points."""
    pool = ProcessPoolExecutor(WORKERS, get_context("spawn"))
    for method, every, tolerances in (
        ("RK45", 128, TOLERANCES[:2]),
        ("DOP853", 64, TOLERANCES),
        ("LSODA", 64, TOLERANCES),
    ):
        for tolerance in tolerances:
            work = partial(prepared, pool, partial(by_solve_ivp, method, tolerance))
            yield Contestant("scipy solve_ivp", f"{method} {tolerance:g}", every, work)
    for tolerance in TOLERANCES:
        yield Contestant(
            "scipy odeint",
            f"{tolerance:g}",
            64,
            partial(prepared, pool, partial(by_odeint, tolerance)),
        )
