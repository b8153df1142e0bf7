"""Where a resting wheel begins to swing: the Hopf bifurcation of the even fixpoints.

Exactly, and by the paper's expansion. At phi = 0 the potential x1 decouples; with S = x_t(1) the
others have the characteristic polynomial
    I tau l^3 + (I + f tau) l^2 + (f - k S tau) l + k (a/2 - S),
from which `hopf` follows by the criterion of Routh and Hurwitz.
"""

from __future__ import annotations

from math import cos, inf, sin, sqrt
from typing import Any, NamedTuple

import numpy as np

from host.errors import WrongUse
from host.theory.analysis.bisection import last_alike
from host.theory.analysis.fixpoints import ANGLES, fixpoint
from host.theory.model.symbolic import derivatives, jacobian_at
from host.theory.model.wheel import Wheel
from robot.controller import target_position


class Hopf(NamedTuple):
    """A Hopf bifurcation in k.

    Above k, cycles are states z q + conjugate with |z|^2 = mu / (-l1 omega); mu is the real part of
    the leading eigenvalues there, q their eigenvector.

    Attributes:
        k: the spring constant at which it happens.
        omega: angular frequency of the cycles, rad/s.
        l1: first Lyapunov coefficient (Kuznetsov, Elements of Applied Bifurcation Theory, section
            5.4, with eigenvectors of length 1). If it is negative, cycles are born stable: the
            bifurcation is supercritical.
    """

    k: float
    omega: float
    l1: float


def hopf(wheel: Wheel) -> Hopf:
    """The Hopf bifurcation of the even fixpoints in k.

    >>> hopf(Wheel(tau=0.25))
    Hopf(k=1.58727677..., omega=3.06535941..., l1=-0.04873232...)

    Args:
        wheel: The wheel; its own k does not matter.

    Returns:
        The bifurcation.

    Raises:
        WrongUse: There is none: without friction every resting wheel is unstable, and with a = 0
            the rods do not pull.
    """
    if wheel.checked().f == 0.0 or wheel.a == 0.0:
        why = (
            "without friction every k makes a resting wheel swing"
            if wheel.a
            else "with a = 0 the rods do not pull"
        )
        raise WrongUse(
            f"there is no Hopf bifurcation: {why}", f"give {'f' if wheel.a else 'a'} above 0"
        )
    k = critical_k(wheel)
    # omega^2 = (f - k S tau) / (I tau), without the difference, which nearly vanishes for small
    # tau.
    omega = sqrt(
        k * (wheel.a / 2 - float(target_position(1.0, wheel.a))) / (wheel.I + wheel.f * wheel.tau)
    )
    return Hopf(k, omega, _lyapunov_coefficient(wheel._replace(k=k), omega))


def critical_k(wheel: Wheel) -> float:
    """The k above which rest is unstable, in closed form.

    0 without friction; infinite with a = 0.
    """
    tau_s, inertia, friction = wheel.tau, wheel.I, wheel.f
    pull = tau_s * (target_position(1.0, wheel.a) * friction * tau_s + inertia * wheel.a / 2)
    return float(friction * (inertia + friction * tau_s) / pull) if pull else inf


def _lyapunov_coefficient(wheel: Wheel, omega: float) -> float:
    state = (1.0, 0.0, 0.0, 0.0)
    second, third = (np.array(derivatives(order)(*state, *wheel)) for order in (2, 3))
    quadratic, cubic = second.reshape(4, 4, 4), third.reshape(4, 4, 4, 4)
    matrix = jacobian_at(state, wheel)
    values, vectors = np.linalg.eig(matrix)
    q = vectors[:, np.argmin(np.abs(values - 1j * omega))]
    values, vectors = np.linalg.eig(matrix.T)
    p = vectors[:, np.argmin(np.abs(values + 1j * omega))]
    p = p / np.vdot(q, p)  # so that <p, q> = 1

    def twice(u: Any, v: Any) -> Any:
        return np.einsum("ijk,j,k", quadratic, u, v)

    mean = np.linalg.solve(matrix, twice(q, q.conj()))
    double = np.linalg.solve(2j * omega * np.eye(4) - matrix, twice(q, q))
    inner = (
        np.einsum("ijkl,j,k,l", cubic, q, q, q.conj())
        - 2 * twice(q, mean)
        + twice(q.conj(), double)
    )
    return float(np.vdot(p, inner).real / (2 * omega))


def bautin_tau_s(wheel: Wheel, low: float, high: float) -> float | None:
    """The time constant between two others at which l1 changes its sign: a Bautin point.

    On one side of it cycles are born stable, on the other side unstable.

    Args:
        wheel: The wheel; its own tau and k do not matter.
        low: Least time constant, s.
        high: Greatest time constant, s.

    Returns:
        The time constant, s; None if the sign is the same at both ends.

    Raises:
        WrongUse: There is no Hopf bifurcation.
    """

    def born_stable(tau_s: float) -> bool:
        return hopf(wheel._replace(tau=tau_s)).l1 < 0.0

    return None if born_stable(low) == born_stable(high) else last_alike(born_stable, low, high)


def estimate(wheel: Wheel) -> float:
    """The paper's critical k = 2 f / (a tau), infinite with a = 0. Eq. k_critical."""
    return 2 * wheel.f / (wheel.a * wheel.tau) if wheel.a else inf


def adaptive_friction(phi: float, wheel: Wheel) -> float:
    """gamma(phi), the coefficient of omega in the paper's expansion for slow wheels.

    A resting wheel swings where it is positive. Eq. friction_gamma, in which 4 y (1 - y) =
    1 - x_t^2.
    """
    slopes = [1.0 - target_position(x, wheel.a) ** 2 for x in (cos(phi), sin(phi))]
    return float(
        wheel.k * wheel.a * wheel.tau / 2 * (slopes[0] * sin(phi) ** 2 + slopes[1] * cos(phi) ** 2)
        - wheel.f
    )


def by_eigenvalues(wheel: Wheel) -> float:
    """The k of the Hopf bifurcation from eigenvalues of the Jacobian: a check.

    Searched between half and twice the closed form. Raises WrongUse as `hopf` does.
    """
    k = hopf(wheel).k

    def grows(factor: float) -> bool:
        return bool(fixpoint(ANGLES[0], wheel._replace(k=factor * k)).eigenvalues[0].real > 0.0)

    return k * last_alike(grows, 0.5, 2.0)
