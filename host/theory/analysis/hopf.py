"""Where a resting wheel begins to swing: the Hopf bifurcation of the even fixpoints.

Exactly, and by the paper's expansion. At phi = 0 the potential x1 decouples; with S = x_t(1) the
others have the characteristic polynomial
    I tau l^3 + (I + f tau) l^2 + (f - k S tau) l + k (a/2 - S),
from which `hopf` follows by the criterion of Routh and Hurwitz. A wheel with one rod rests at
phi = pi/2, where the polynomial is the same with S = 1. With the user's own functions the
bifurcation is found by numbers.
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, inf, isfinite, log, pi, sin, sqrt
from typing import Any, NamedTuple

import numpy as np

from host.errors import WrongUse
from host.theory.analysis.bisection import last_alike
from host.theory.analysis.fixpoints import angles, fixpoint
from host.theory.model.laws import law_of
from host.theory.model.symbolic import derivatives, jacobian_at
from host.theory.model.wheel import Wheel, resting, too_extreme
from robot.controller import target_position

# Values of k among which a bifurcation is looked for by numbers.
_TRIED = np.geomspace(1e-3, 1e3, 121)


class Hopf(NamedTuple):
    """A Hopf bifurcation in k.

    >>> found = hopf(Wheel(tau=0.25))
    >>> found.k < 1.6, found.l1 < 0  # and cycles are born stable
    (True, True)

    Above k, cycles are states z q + conjugate with abs(z)^2 = mu / (-l1 omega); mu is the real part
    of the leading eigenvalues there, q their eigenvector.

    Attributes:
        k: the spring constant at which it happens.
        omega: angular frequency of the cycles, rad/s.
        l1: first Lyapunov coefficient (Kuznetsov, Elements of Applied Bifurcation Theory, section
            5.4, with eigenvectors of length 1). If it is negative, cycles are born stable: the
            bifurcation is supercritical.
        phi: the angle of rest, rad.
    """

    k: float
    omega: float
    l1: float
    phi: float = 0.0


def hopf(wheel: Wheel) -> Hopf:
    """The Hopf bifurcation of the even fixpoints in k.

    >>> hopf(Wheel(tau=0.25))
    Hopf(k=1.58727677..., omega=3.06535941..., l1=-0.04873232...)

    Args:
        wheel: The wheel; its own k does not matter. With functions of the user the bifurcation of
            least k is found.

    Returns:
        The bifurcation.

    Raises:
        WrongUse: There is none: without friction every resting wheel is unstable, and with a = 0
            the rods do not pull; a single rod pulls a wheel out of its rest only with a above 2.
            Or its constants are too large or too small.
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
    if wheel.own:
        k, phi, omega = _crossing(wheel)
        if k == inf:
            raise WrongUse(
                f"there is no Hopf bifurcation for k from {_TRIED[0]:g} to {_TRIED[-1]:g}",
                "give other constants or functions",
            )
        return Hopf(k, omega, _lyapunov_coefficient(wheel._replace(k=k), omega, phi), phi)
    k, stiff = critical_k(wheel), _stiffness(wheel)
    if k == inf and not (wheel.rods == 1 and wheel.a <= 2.0):
        raise too_extreme(wheel)
    if k == inf:
        raise WrongUse(
            "there is no Hopf bifurcation: with a up to 2 a single rod holds a wheel at 90° for no"
            " k",
            "give a above 2, or two rods",
        )
    # omega^2 = (f - k S tau) / (I tau), without the difference, which nearly vanishes for small
    # tau.
    omega = sqrt(k * (wheel.a / 2 - stiff) / (wheel.I + wheel.f * wheel.tau))
    phi = pi / 2 if wheel.rods == 1 else 0.0
    return Hopf(k, omega, _lyapunov_coefficient(wheel._replace(k=k), omega, phi), phi)


def critical_k(wheel: Wheel) -> float:
    """The k above which rest is unstable, in closed form but with functions of the user.

    0 without friction; infinite where no k is enough.
    """
    if wheel.own:
        return _crossing(wheel)[0]
    tau_s, inertia, friction, stiff = wheel.tau, wheel.I, wheel.f, _stiffness(wheel)
    if wheel.rods == 1 and wheel.a <= 2.0:
        return inf
    pull = tau_s * (stiff * friction * tau_s + inertia * wheel.a / 2)
    return float(friction * (inertia + friction * tau_s) / pull) if pull else inf


def rests_stably(wheel: Wheel, phi: float) -> bool:
    """Whether a wheel that stands still close to an angle (rad) stays there.

    Dry friction holds it, and without springs or neurons nothing pulls it away.
    """
    if wheel.dry_friction or not (wheel.k and wheel.a):
        return True
    law = law_of(wheel)
    if law.one_rod or law.own:
        return fixpoint(phi, wheel).stable
    return wheel.k < critical_k(wheel)


def above_hopf(wheel: Wheel) -> float:
    """ln(k / k_c): how far a wheel with friction and neurons is above the Hopf bifurcation."""
    return log(wheel.k / critical_k(wheel))


def _stiffness(wheel: Wheel) -> float:
    """S: the force on a wheel that is turned from rest, in units of k, with the neurons held."""
    return 1.0 if wheel.rods == 1 else float(target_position(1.0, wheel.a))


def _crossing(wheel: Wheel) -> tuple[float, float, float]:
    """The least k at which eigenvalues of a fixpoint cross the imaginary axis, by numbers.

    Returns:
        k, infinite without any; the fixpoint's angle, rad; the angular frequency, rad/s.
    """

    def pair(phi: float, k: float) -> complex:
        """Of the eigenvalues with an imaginary part, the leading one; -inf without any."""
        values = fixpoint(phi, wheel._replace(k=k)).eigenvalues
        return max(
            (value for value in values if value.imag > 0.0), key=lambda v: v.real, default=-inf
        )

    k, at, omega = inf, 0.0, 0.0
    for phi in angles(wheel._replace(k=1.0)):

        def grows(k: float, phi: float = phi) -> bool:
            return pair(phi, k).real > 0.0

        growing = [grows(k) for k in _TRIED.tolist()]
        for index in np.flatnonzero(np.diff(growing)).tolist():
            low, high = _TRIED[index : index + 2].tolist()
            if isfinite(pair(phi, low).real) and isfinite(pair(phi, high).real):
                own = last_alike(grows, low, high)
                # Fixpoints that are alike differ by rounding.
                if own < (1.0 - 1e-9) * k:
                    k, at, omega = own, phi, float(pair(phi, own).imag)
    return k, at, omega


# Where k is searched, each wheel that is tried has the same bifurcation.
@lru_cache(maxsize=1)
def _lyapunov_coefficient(wheel: Wheel, omega: float, phi: float) -> float:
    """l1 at a bifurcation. Raises WrongUse where rounding leaves nothing of it."""
    try:
        with np.errstate(all="ignore"):
            found = _coefficient(wheel, omega, phi)
    except (np.linalg.LinAlgError, ZeroDivisionError, OverflowError):
        raise too_extreme(wheel) from None
    if not isfinite(found):
        raise too_extreme(wheel)
    return found


def _coefficient(wheel: Wheel, omega: float, phi: float) -> float:
    state, law = resting(np.array([phi]))[:, 0].tolist(), law_of(wheel)
    second, third = (np.array(derivatives(order, law)(*state, *wheel)) for order in (2, 3))
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
    k, *_, phi = hopf(wheel)

    def grows(factor: float) -> bool:
        return bool(fixpoint(phi, wheel._replace(k=factor * k)).eigenvalues[0].real > 0.0)

    return k * last_alike(grows, 0.5, 2.0)
