"""The four equations of a wheel (eq. dot_x_phi).

They are the robot's controller, and the mechanics that the paper adds to it.

A state is (x1, x2, phi, omega): membrane potentials (1), angle (rad), angular velocity (rad/s).
Torques are in the units of the rods' forces, moments of inertia in these times s^2, friction in
these times s. Arrays of states are (4, wheels), of parameters (constants, wheels), with the rows of
`Wheel`. Other wheels than the paper's have other equations, see host.theory.model.laws.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from math import inf, isfinite
from numbers import Real
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.model import own_functions
from host.util.arguments import need_seconds, wrong
from robot.controller import (
    actual_positions,
    membrane_rate,
    rod_force,
    tangential_force,
    target_position,
)
from sim_motor.mathematics import with_mathematics

Array = NDArray[np.float64]
PHI, OMEGA = 2, 3
STEEPEST = 100.0


def rates(
    x1: Any,
    x2: Any,
    phi: Any,
    omega: Any,
    a: Any,
    tau_s: Any,
    k: Any,
    inertia: Any,
    friction: Any,
    dry_friction: Any,
    bounded: Any = inf,
    rods: Any = 2,
    own: Any = 0,
) -> tuple[Any, Any, Any, Any]:
    """(dx1/dt, dx2/dt, dphi/dt, domega/dt) of the paper's wheel. Eq. dot_x_phi.

    dry_friction: torque of dry friction on a wheel that rolls forward, negative for one that rolls
    backward; 0 in the paper's equations. The arguments are floats, or what the functions take in
    another mathematics (sim_motor.mathematics). The last three make no difference here: a wheel
    that needs them has equations of its own (host.theory.model.laws).
    """
    actual_1, actual_2 = actual_positions(phi)
    return seen_rates(
        x1,
        x2,
        omega,
        actual_1,
        actual_2,
        actual_1,
        actual_2,
        a,
        tau_s,
        k,
        inertia,
        friction,
        dry_friction,
        bounded,
    )


def seen_rates(
    x1: Any,
    x2: Any,
    omega: Any,
    actual_1: Any,
    actual_2: Any,
    seen_1: Any,
    seen_2: Any,
    a: Any,
    tau_s: Any,
    k: Any,
    inertia: Any,
    friction: Any,
    dry_friction: Any,
    bounded: Any,
) -> tuple[Any, Any, Any, Any]:
    """The same for neurons that see (seen_1, seen_2), which a kick may have changed."""
    force_1 = rod_force(target_position(x1, a), actual_1, k)
    force_2 = rod_force(target_position(x2, a), actual_2, k)
    force = tangential_force(force_1, force_2, actual_1, actual_2)
    faster = acceleration(torque(force, bounded), omega, inertia, friction, dry_friction)
    return membrane_rate(x1, seen_1, tau_s), membrane_rate(x2, seen_2, tau_s), omega, faster


def torque(force: Any, bounded: Any) -> Any:
    """The torque on the wheel: all of the rods' force."""
    return force


def acceleration(force: Any, omega: Any, inertia: Any, friction: Any, dry_friction: Any) -> Any:
    """domega/dt (rad/s^2) of a wheel that is driven by a torque. Eq. dot_x_phi."""
    return (force - friction * omega - dry_friction) / inertia


class Wheel(NamedTuple):
    """The constants of a wheel by the paper's letters, in the order in which `rates` takes them.

    The defaults are the paper's, where it gives any. Dry friction opposes motion in either
    direction and holds a wheel at rest (host.theory.engine.sliding). What follows cycles takes the
    smooth equations of a wheel that rolls forward.

    >>> Wheel(k=8, tau=0.25)
    Wheel(a=4.0, tau=0.25, k=8, I=0.05, f=0.5, dry_friction=0.0, bounded=inf, rods=2.0, own=0.0)

    Attributes:
        a: gain of the neurons, without unit.
        tau: time constant of the membrane potentials, s.
        k: spring constant of the rods, without unit.
        I: moment of inertia, s^2 (its torque has no unit).
        f: friction, s (its torque has no unit).
        dry_friction: torque of dry friction, without unit.
        bounded: the motor's greatest torque M_max, without unit. The torque is then
            M_max tanh(F_tan / M_max), with 1 the robot's; infinite in the paper's equations.
        rods: 2, or 1 if only the first rod exists.
        own: the number of the user's functions in this process, 0 without (see with_functions).
    """

    a: float = 4.0
    tau: float = 0.25
    k: float = 1.85
    I: float = 0.05  # noqa: E741
    f: float = 0.5
    dry_friction: float = 0.0
    bounded: float = inf
    rods: float = 2.0
    own: float = 0.0

    def checked(self) -> Wheel:
        """The same wheel. Raises WrongUse if no wheel can have these constants."""
        above_0 = ("tau", "I", "bounded")
        for name, value in zip(self._fields, self, strict=True):
            # To ask for Real alone takes as long as all else.
            number = isinstance(value, (float, Real)) and not isinstance(value, bool)
            finite = number and (isfinite(value) or (name == "bounded" and value == inf))
            if not finite or value < 0.0 or (value == 0.0 and name in above_0):
                wanted = "a finite number, " + ("above 0" if name in above_0 else "0 or more")
                if name == "bounded":
                    wanted += ", or leave it out for no bound"
                raise wrong(name, value, wanted)
        if self.rods not in (1, 2):
            raise WrongUse(f"a wheel cannot have {self.rods:g} rods", "give 1 or 2")
        if self.a > STEEPEST:
            raise WrongUse(
                f"a cannot be {self.a!r}",
                f"give at most {STEEPEST:g}: steeper neurons are switches, and no longer smooth",
            )
        return self

    def with_older_rods(self, lag_s: float) -> Wheel:
        """A wheel whose rods are older than the angle in F_tan, as robot.controller.lagging_angle.

        That adds -k sin(omega lag) to F_tan, whatever the neurons do. To first order in omega lag
        this is a friction of k lag. The form ends where omega lag is no longer small: the force is
        then weaker than the friction by k (omega lag)^3 / 6, 6 % of it at omega lag = 0.6.

        Args:
            lag_s: How much older the rods are, s, at a constant speed.

        Raises:
            WrongUse: The lag is below 0, or no wheel can have that friction.
        """
        lag = need_seconds("lag_s", lag_s)
        return self.checked()._replace(f=self.f + self.k * lag).checked()

    def options(self) -> dict[str, Any]:
        """The constants as a study takes them, by the paper's letters: the inverse of `wheel_of`.

        Dry friction and the user's functions are left out.
        """
        return {
            "a": self.a,
            "tau": self.tau,
            "k": self.k,
            "I": self.I,
            "f": self.f,
            "rods": int(self.rods),
            "bounded": self.bounded if self.bounded < inf else None,
        }

    def with_functions(
        self,
        transfer: Callable[[Any, Any], Any] | None = None,
        mechanics: Callable[[Any, Any, Any, Any, Any], Any] | None = None,
    ) -> Wheel:
        """A wheel with the user's own equations in the place of two of the paper's.

        The functions take floats, return one float and must be smooth. They may use `math`,
        constants and functions of their module; numba compiles them.

        Args:
            transfer: x_t (1) from (x, a), instead of robot.controller.target_position.
            mechanics: domega/dt (rad/s^2) from (torque, omega, inertia, friction, dry_friction),
                instead of `acceleration`. Dry friction is 0.

        Returns:
            The wheel. It is known to this process alone.

        Raises:
            WrongUse: A function does not compile, or gives no finite number.
        """
        if mechanics is not None and self.dry_friction:
            raise WrongUse(
                "a wheel with its own mechanics cannot have dry_friction, too",
                "leave dry_friction at 0, and write your friction into the function",
            )
        return self._replace(own=float(own_functions.number_of(transfer, mechanics)))

    def columns(self, count: int, **varied: Array) -> Array:
        """The constants of many wheels, (constants, count).

        Args:
            count: How many.
            varied: The constants in which they differ, by name, (count,) each.
        """
        parameters = np.repeat(np.array(self, dtype=np.float64)[:, None], count, axis=1)
        for name, values in varied.items():
            parameters[self._fields.index(name)] = values
        return parameters


def in_words(constants: Iterable[float]) -> str:
    """The constants of a wheel by the paper's letters: the first five."""
    letters = ("a", "tau", "k", "I", "f")
    return ", ".join(f"{name} = {value:g}" for name, value in zip(letters, constants, strict=False))


def too_extreme(wheel: Wheel) -> WrongUse:
    """The exception for a wheel whose constants leave no digits to compute with."""
    return WrongUse(
        f"a wheel with {in_words(wheel)} cannot be computed: its numbers are too large or too"
        " small",
        "give constants that are nearer to the paper's",
    )


def wheel_of(options: Mapping[str, Any]) -> Wheel:
    """The wheel with the constants that options give by the paper's letters, else the paper's.

    Raises:
        WrongUse: No wheel can have them.
    """
    given = {letter: options.get(letter) for letter in Wheel._fields}
    return Wheel(
        **{letter: value for letter, value in given.items() if value is not None}
    ).checked()


def resting(phi: Array) -> Array:
    """States of resting wheels with the potentials that belong to their angles.

    Args:
        phi: Angles, rad, (wheels,).

    Returns:
        (4, wheels).
    """
    return np.array([*numpy_positions(phi), phi, np.zeros_like(phi)])


NUMPY = {name: getattr(np, name) for name in ("cos", "sin", "exp", "tanh")}
# The functions of arrays.
numpy_positions: Any = with_mathematics(actual_positions, NUMPY)
numpy_rates: Any = with_mathematics(rates, NUMPY)
