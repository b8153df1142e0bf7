"""A wheel that turns at constant angular velocity.

Its neurons' potentials (eq. X-t), and the speed at which it keeps turning (eq. F_tan_ana).
"""

from __future__ import annotations

from math import sqrt
from typing import Any

import numpy as np

from host.theory.model.wheel import Array, Wheel, numpy_positions
from robot.controller import actual_positions, membrane_rate

# After this many time constants nothing is left of how the neurons began.
_SETTLED = 40.0


def potentials(phi: Any, omega: Any, tau_s: float) -> tuple[Any, Any]:
    """The potentials of neurons that see a wheel turn at constant speed. Eq. X-t.

    Args:
        phi: The wheel's angle, rad.
        omega: Its speed, rad/s.
        tau_s: The neurons' time constant, s.

    Returns:
        (x1, x2).
    """
    (cosine, sine), lag = numpy_positions(phi), omega * tau_s
    return (cosine + lag * sine) / (1 + lag**2), (sine - lag * cosine) / (1 + lag**2)


def turning(phi: Array, omega: Array, wheel: Wheel) -> Array:
    """States of wheels whose potentials are as if they had always turned with their present speed.

    Args:
        phi: Angles, rad, (wheels,).
        omega: Speeds, rad/s, (wheels,).
        wheel: The constants of all wheels.

    Returns:
        (4, wheels).
    """
    return np.array([*potentials(phi, omega, wheel.tau), phi, omega])


def constant_velocity(wheel: Wheel) -> float | None:
    """The paper's omega (rad/s) of locomotion, for neurons in their linear range. Eq. F_tan_ana.

    None where the wheel has none.
    """
    # On average over a turn each rod gives half of the drive.
    drive, brake = wheel.a * wheel.k * wheel.tau * wheel.rods / 2, 2 * wheel.f
    return sqrt((drive - brake) / brake) / wheel.tau if drive > brake > 0.0 else None


def rolling_states(parameters: Array) -> Array:
    """States at angle 0 of wheels that turn with their constant velocity, or rest without one.

    Args:
        parameters: The wheels' constants, (constants, wheels).

    Returns:
        (4, wheels).
    """
    wheels = [Wheel(*column) for column in parameters[: len(Wheel._fields)].T.tolist()]
    return np.hstack(
        [
            turning(np.zeros(1), np.array([constant_velocity(wheel) or 0.0]), wheel)
            for wheel in wheels
        ]
    )


def driven(phi: Array, omega: float, tau_s: float) -> Array:
    """The potentials of `potentials` by numbers: a check.

    The robot's two neurons see the positions of the turning wheel, and begin at 0.

    Args:
        phi: Angles, rad, ascending, from 0 or more.
        omega: The wheel's speed, rad/s.
        tau_s: The neurons' time constant, s.

    Returns:
        (2, angles).
    """
    from scipy.integrate import solve_ivp

    def rate(time_s: float, x: Array) -> list[float]:
        seen = actual_positions(omega * time_s)
        return [float(membrane_rate(x[i], seen[i], tau_s)) for i in range(2)]

    turns = np.ceil(_SETTLED * tau_s * abs(omega) / (2 * np.pi))
    times = (2 * np.pi * turns + phi) / omega
    solved = solve_ivp(
        rate, (0.0, times[-1]), [0.0, 0.0], method="DOP853", t_eval=times, rtol=1e-11, atol=1e-13
    )
    found: Array = solved.y
    return found
