"""The model by other means: the right-hand side as the paper prints it, and scipy."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import ode, solve_ivp
from scipy.optimize import fsolve


def rates(y, wheel):
    """Eq. dot_x_phi with the logistic function; also with one rod, or a bounded torque.

    Of one state, or of many at once.
    """
    # With one of numpy's numbers each operation takes ten times as long as with Python's.
    x1, x2, phi, omega = y.tolist() if isinstance(y, np.ndarray) and y.ndim == 1 else y
    mathematics = np if isinstance(x1, np.ndarray) else math
    a, tau, k, inertia, f, _, most, rods, _ = wheel
    first, second = (2.0 / (1.0 + mathematics.exp(-a * x)) - 1.0 for x in (x1, x2))
    sine, cosine = mathematics.sin(phi), mathematics.cos(phi)
    force = k * first * sine - k * (second if rods == 2 else sine) * cosine
    torque = most * mathematics.tanh(force / most) if math.isfinite(most) else force
    return np.array(
        [
            (cosine - x1) / tau,
            (sine - x2) / tau,
            omega,
            (torque - f * omega) / inertia,
        ]
    )


def jacobian(y, wheel):
    """The derivatives of the paper's rates by the state."""
    x1, x2, phi, _ = map(float, y)
    a, tau, k, inertia, f, *_ = map(float, wheel)
    first, second = (2.0 / (1.0 + math.exp(-a * x)) - 1.0 for x in (x1, x2))
    steep_1, steep_2 = (
        2.0 * a * math.exp(-a * x) / (1.0 + math.exp(-a * x)) ** 2 for x in (x1, x2)
    )
    sine, cosine = math.sin(phi), math.cos(phi)
    by_phi = k * (first * cosine + second * sine)
    return np.array(
        [
            [-1.0 / tau, 0.0, -sine / tau, 0.0],
            [0.0, -1.0 / tau, cosine / tau, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [part / inertia for part in (k * steep_1 * sine, -k * steep_2 * cosine, by_phi, -f)],
        ]
    )


def follow(y, wheel, seconds, events=None, t_eval=None, rtol=1e-12):
    """A wheel's course, as scipy solves it."""
    return solve_ivp(
        lambda _, y: rates(y, wheel),
        (0.0, seconds),
        y,
        "DOP853",
        t_eval=t_eval,
        events=events,
        rtol=rtol,
        atol=1e-13,
    )


def last(y, wheel, seconds, rtol=1e-12):
    """Where a wheel's course ends."""
    return end_of(lambda y: rates(y, wheel), y, seconds, rtol, 1e-13)


def end_of(field, y, seconds, rtol, atol):
    """Where a state ends whose rates are a function of it alone.

    By the same method as `follow`, which scipy has in compiled code, too.
    """
    solver = ode(lambda _, y: field(y)).set_integrator(
        "dop853", rtol=rtol, atol=atol, nsteps=1_000_000
    )
    found = solver.set_initial_value(y).integrate(seconds)
    assert solver.successful()
    return found


def quarter_turn(y, wheel):
    """The state a quarter turn later, seen from there, and the time that it takes."""

    def turned(_, y):
        return y[2] - np.pi / 2

    turned.terminal = True
    run = follow(y, wheel, 100.0, turned)
    x1, x2, _, omega = run.y[:, -1]
    return np.array([x2, -x1, 0.0, omega]), run.t[-1]


def turning(wheel):
    """The state at phi = 0 of a wheel that turns steadily. Eqs. x-t and F_tan_ana."""
    a, tau, k, _, f, *_ = wheel
    omega = np.sqrt((a * k * tau - 2 * f) / (2 * f * tau**2))
    lag = omega * tau
    return np.array([1.0, -lag, 0.0, omega * (1 + lag**2)]) / (1 + lag**2)


def rotation(wheel, start):
    """The rotation: its state at phi = 0, and the time of a quarter turn."""

    def off(unknowns):
        y = np.array([unknowns[0], unknowns[1], 0.0, unknowns[2]])
        return (quarter_turn(y, wheel)[0] - y)[[0, 1, 3]]

    x1, x2, omega = fsolve(off, np.array(start)[[0, 1, 3]], xtol=1e-12)
    y = np.array([x1, x2, 0.0, omega])
    return y, quarter_turn(y, wheel)[1]


UNDO_QUARTER = np.eye(4)
UNDO_QUARTER[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]


def multipliers(y, seconds, wheel, back=UNDO_QUARTER):
    """The multipliers of a quarter turn from y, or of what `back` undoes, the greatest first."""

    def both(z):
        driven = jacobian(z[:4], wheel) @ z[4:].reshape(4, 4)
        return np.concatenate([rates(z[:4], wheel), driven.ravel()])

    begin = np.concatenate([y, np.eye(4).ravel()])
    end = end_of(both, begin, seconds, 1e-11, 1e-12)
    found = np.linalg.eigvals(back @ end[4:].reshape(4, 4))
    found = np.delete(found, np.argmin(abs(found - 1.0)))
    return found[np.argsort(-abs(found))]


def growth_of_area(y, wheel, seconds, rng):
    """The rate, 1/s, at which the area between two tangent vectors grows, after 10 s."""
    vectors, total, begin = np.linalg.qr(rng.normal(size=(4, 2)))[0], 0.0, 10

    def both(z):
        driven = jacobian(z[:4], wheel) @ z[4:].reshape(4, 2)
        return np.concatenate([rates(z[:4], wheel), driven.ravel()])

    for second in range(begin + round(seconds)):
        z = np.concatenate([y, vectors.ravel()])
        end = end_of(both, z, 1.0, 1e-7, 1e-9)
        y, (vectors, upper) = end[:4], np.linalg.qr(end[4:].reshape(4, 2))
        if second >= begin:
            total += np.log(abs(np.diag(upper))).sum()
    return total / seconds
