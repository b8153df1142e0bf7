"""diffrax: JAX's solvers in double precision, half of the points on each of two devices (cores)."""

import os
from functools import partial

# Before JAX is imported: otherwise the processor is one device, and small operations use one
# core.
os.environ["XLA_FLAGS"] = "--xla_force_host_platform_device_count=2"

import diffrax
import jax
import jax.numpy as jnp
import numpy as np

from host.theory.model.wheel import rates
from sim_motor.mathematics import with_mathematics
from tests.bench_theory.problem import MEASURED_S, START, TRANSIENT_S, WORKERS, Contestant, averages

jax.config.update("jax_enable_x64", True)
_rates = with_mathematics(rates, {"sin": jnp.sin, "cos": jnp.cos, "exp": jnp.exp})


def _field(time, y, constants):
    wheel, around = constants
    return (*_rates(*y[:4], *wheel), (y[3] - around) ** 2)[: len(y)]


def _followed(solver, tolerance, wheel):
    def after(y, around, seconds):
        found = diffrax.diffeqsolve(
            diffrax.ODETerm(_field),
            solver,
            0.0,
            seconds,
            None,
            y,
            (tuple(wheel), around),
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
            adjoint=diffrax.ForwardMode(),
            max_steps=None,
        )
        return tuple(values[-1] for values in found.ys)

    at_start = after(tuple(jnp.asarray(value) for value in START), 0.0, TRANSIENT_S)
    return at_start, after((*at_start, jnp.zeros(())), at_start[3], MEASURED_S)


def prepared(solver, tolerance, parameters):
    """The work, compiled for as many points as there are; every device gets every second one."""
    shares = jnp.asarray(parameters.T.reshape(-1, WORKERS, parameters.shape[0]).swapaxes(0, 1))
    ready = jax.pmap(jax.vmap(partial(_followed, solver, tolerance))).lower(shares).compile()

    def run():
        at_start, at_end = jax.block_until_ready(ready(shares))
        return averages(
            *(np.array([np.asarray(row).T.ravel() for row in rows]) for rows in (at_start, at_end))
        )

    return run


def contestants():
    """Two of diffrax's explicit solvers.

    In lockstep, all points of a device do as many steps as the slowest, so they are not too many.
    """
    for solver, tolerances in ((diffrax.Tsit5(), (1e-6,)), (diffrax.Dopri8(), (1e-6, 1e-9))):
        for tolerance in tolerances:
            yield Contestant(
                "diffrax",
                f"{type(solver).__name__} {tolerance:g}",
                8,
                partial(prepared, solver, tolerance),
            )
