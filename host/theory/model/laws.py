"""The equations of other wheels than the paper's: variants of host.theory.model.wheel's `rates`.

A variant takes the place of one function that `rates` calls. All other lines are the paper's.

- One rod: only the first rod pulls.
- A bounded torque: M = M_max tanh(F_tan / M_max), as on the robot with M_max = 1.
- The user's own transfer function or mechanics (host.theory.model.own_functions).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from math import inf
from typing import Any, NamedTuple, TypeVar

import numpy as np

from host.errors import WrongUse
from host.theory.model import own_functions
from host.theory.model.wheel import NUMPY, Array, Wheel, acceleration, rates, torque
from robot.controller import motor_torque, tangential_force
from sim_motor.mathematics import with_mathematics

F = TypeVar("F", bound=Callable[..., Any])
BOUNDED, RODS, OWN = (Wheel._fields.index(name) for name in ("bounded", "rods", "own"))


class Law(NamedTuple):
    """Which equations drive a wheel.

    Attributes:
        one_rod: whether only the first rod exists.
        bounded: whether the torque is bounded.
        own: the number of the user's functions, 0 without.
    """

    one_rod: bool = False
    bounded: bool = False
    own: int = 0


PAPER = Law()
# States at which symmetries are tried.
_TRIED = 20


def law_of(constants: Sequence[float] | Array) -> Law:
    """The law of a wheel, or of many wheels at once.

    Args:
        constants: A Wheel, or parameters of wheels, (constants, wheels).

    Returns:
        The law that drives all of them.

    Raises:
        WrongUse: Different wheels have different laws.
    """
    numbers = np.asarray(constants, dtype=np.float64).reshape(len(constants), -1)
    if not numbers.shape[1]:
        return PAPER
    one_rod, bounded, own = numbers[RODS] == 1.0, numbers[BOUNDED] < inf, numbers[OWN]
    if any((kind != kind[0]).any() for kind in (one_rod, bounded, own)):
        raise WrongUse(
            "wheels with different equations cannot be followed at once",
            "give all of them as many rods, a bounded torque or none, and the same functions",
        )
    return Law(bool(one_rod[0]), bool(bounded[0]), int(own[0]))


def _of_first_rod(force_1: Any, force_2: Any, actual_1: Any, actual_2: Any) -> Any:
    """F_tan of the first rod alone."""
    return tangential_force(force_1, 0.0, actual_1, actual_2)


def _bounded(force: Any, bounded: Any) -> Any:
    """The torque of a motor that cannot give more than some torque. Eq. torque."""
    return bounded * motor_torque(force / bounded)


def torque_under(law: Law) -> Callable[[Any, Any], Any]:
    """The function that gives the torque from the force and the greatest torque."""
    return _bounded if law.bounded else torque


def under(
    law: Law,
    function: F,
    mathematics: Mapping[str, Any] | None = None,
    finish: Callable[[Any], Any] = lambda function: function,
) -> F:
    """A function that calls `rates`, or is it, with the equations of a law.

    Args:
        law: The law.
        function: A plain Python function.
        mathematics: See sim_motor.mathematics.
        finish: See there.

    Returns:
        What `finish` returns for the new function.

    Raises:
        WrongUse: This process does not know the user's functions.
    """
    parts: dict[str, Callable[..., Any]] = {"torque": torque_under(law)}
    if law.one_rod:
        parts["tangential_force"] = _of_first_rod
    if law.own:
        parts |= own_functions.parts(law.own)
    basis = mathematics or {}
    own = {name: with_mathematics(part, basis, finish) for name, part in parts.items()}
    return with_mathematics(function, {**basis, **own}, finish)


def rates_of(wheel: Wheel) -> Callable[..., Any]:
    """The function of floats that gives the four rates of a wheel, as `rates` does."""
    return _scalar(law_of(wheel))


@cache
def array_rates(law: Law) -> Callable[..., Any]:
    """The function of arrays that gives the four rates of wheels of a law, as `rates` does."""
    if law.own:  # which may take floats only
        return np.vectorize(under(law, rates), otypes=4 * [np.float64])
    return under(law, rates, NUMPY)


def has_symmetries(wheel: Wheel) -> bool:
    """Whether a quarter turn and a reflection turn each motion of a wheel into another one.

    The paper's wheel has both symmetries, see host.theory.analysis.cycles. They are tried at some
    states.
    """
    states = np.random.default_rng(0).normal(size=(4, _TRIED))
    x1, x2, phi, omega = states
    found = array_rates(law_of(wheel))
    r1, r2, r3, r4 = found(*states, *wheel)
    turned = found(-x2, x1, phi + np.pi / 2, omega, *wheel)
    mirrored = found(x1, -x2, -phi, -omega, *wheel)
    expected = (-r2, r1, r3, r4), (r1, -r2, -r3, -r4)
    return np.allclose((turned, mirrored), expected, rtol=1e-9, atol=1e-9)


@cache
def _scalar(law: Law) -> Callable[..., Any]:
    return rates if law == PAPER else under(law, rates)


def require_friction(wheel: Wheel) -> None:
    """Raise WrongUse for a wheel that nothing slows down, and that therefore never settles.

    Dry friction slows it down, and so may mechanics of the user.
    """
    own_mechanics = acceleration.__name__ in own_functions.parts(int(wheel.own))
    if not (wheel.f or wheel.dry_friction or own_mechanics):
        raise WrongUse(
            "without friction a wheel can roll faster and faster, and never settles",
            "give f above 0",
        )
