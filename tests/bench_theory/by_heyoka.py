"""heyoka.py: Taylor's method with adaptive order and steps.

Batches are as wide as the processor's vectors, and each core has a thread. heyoka's own
ensemble_propagate_until_batch copies the integrator for every batch, which for this small system
costs as much as the work; so each thread here keeps one integrator, which is faster.
"""

from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from functools import partial

import heyoka
import numpy as np

from host.theory.model.wheel import Wheel, rates
from sim_motor.mathematics import with_mathematics
from tests.bench_theory.problem import (
    MEASURED_S,
    TRANSIENT_S,
    WORKERS,
    Contestant,
    averages,
    starts,
)

TOLERANCES = (1e-15, 1e-12, 1e-9, 1e-6)


def equations():
    """(those of a wheel, and with the integral for the standard deviation).

    Tau, k and omega's offset in it are parameters.
    """
    state = heyoka.make_vars("x1", "x2", "phi", "omega")
    symbolic_rates = with_mathematics(
        rates, {"sin": heyoka.sin, "cos": heyoka.cos, "exp": heyoka.exp}
    )
    wheel = list(
        zip(
            state,
            symbolic_rates(*state, *Wheel()._replace(tau=heyoka.par[0], k=heyoka.par[1])),
            strict=True,
        )
    )
    return wheel, [*wheel, (heyoka.make_vars("square"), (state[3] - heyoka.par[2]) ** 2)]


def propagated(integrator, states, parameters, seconds):
    """The states (rows, wheels) after some seconds. parameters: (tau, k, offset), (3, wheels)."""
    rows, count = states.shape
    width = getattr(integrator, "batch_size", 1)
    wheels = np.append(np.arange(count), np.full(-count % width, count - 1)).reshape(-1, width)
    found = np.empty((rows, wheels.size), dtype=states.dtype)

    def some(worker):
        own = deepcopy(integrator)
        for batch in range(worker, len(wheels), WORKERS):
            own.set_time(0.0) if width > 1 else setattr(own, "time", states.dtype.type(0.0))
            own.pars[:] = parameters[: len(own.pars), wheels[batch]].reshape(own.pars.shape)
            own.state[:] = states[:, wheels[batch]].reshape(own.state.shape)
            own.propagate_until(states.dtype.type(seconds))
            found[:, batch * width : (batch + 1) * width] = own.state.reshape(rows, width)

    with ThreadPoolExecutor(WORKERS) as pool:
        list(pool.map(some, range(WORKERS)))
    return found[:, :count]


def _followed(transient, measuring, parameters, real):
    count = parameters.shape[1]
    constants = np.vstack([parameters[1:3], np.zeros(count)]).astype(real)
    at_start = propagated(transient, starts(count).astype(real), constants, TRANSIENT_S)
    constants[2] = at_start[3]
    return averages(
        at_start,
        propagated(
            measuring, np.vstack([at_start, np.zeros(count, dtype=real)]), constants, MEASURED_S
        ),
    )


def batches(tolerance, parameters):
    """The work in double precision.

    fast_math makes heyoka a third faster here, and no less accurate.
    """
    width = heyoka.recommended_simd_size()
    integrators = [
        heyoka.taylor_adaptive_batch(
            system,
            np.zeros((len(system), width)),
            tol=tolerance,
            compact_mode=False,
            fast_math=True,
        )
        for system in equations()
    ]
    return partial(_followed, *integrators, parameters, np.float64)


def exact(parameters):
    """The reference: averages in extended precision (a mantissa of 64 bits), tolerance 1e-18."""
    real = np.longdouble
    integrators = [
        heyoka.taylor_adaptive(
            system,
            np.zeros(len(system), dtype=real),
            tol=real(1e-18),
            compact_mode=False,
            fp_type=real,
        )
        for system in equations()
    ]
    return _followed(*integrators, parameters, real)


def contestants():
    """heyoka with all tolerances."""
    for tolerance in TOLERANCES:
        yield Contestant("heyoka batch", f"tol {tolerance:g}", 1, partial(batches, tolerance))
