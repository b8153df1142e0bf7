"""The analytic model in symbols, from the same source as its numbers, and derivatives of its rates.

sympy takes seconds to import and to differentiate. So the derivatives are kept as text, which a
second process reads instead (sim_motor.kept_files). The user's own functions have no symbols: their
derivatives are by differences (host.theory.model.differences).
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Sequence
from functools import cache
from importlib.metadata import version
from itertools import product
from typing import Any

import numpy as np

from host.theory.model import differences
from host.theory.model.laws import PAPER, Law, law_of, rates_of, under
from host.theory.model.wheel import Array, Wheel, rates
from robot.sources import fingerprint
from sim_motor.function_digest import function_digest
from sim_motor.kept_files import keep, load

STATE = ("x1", "x2", "phi", "omega")
Floats = Callable[..., tuple[float, ...]]


def _symbols() -> tuple[tuple[Any, ...], tuple[Any, ...]]:
    """The state and the constants of a wheel."""
    import sympy

    constants = sympy.symbols(" ".join(Wheel._fields), positive=True)
    return sympy.symbols(" ".join(STATE), real=True), constants


@cache
def _field(law: Law) -> tuple[Any, ...]:
    """The four rates as expressions in the state and the constants. Eq. dot_x_phi."""
    import sympy

    state, constants = _symbols()
    names = ("sin", "cos", "exp", "tanh")
    symbolic = {name: getattr(sympy, name) for name in names}
    found = under(law, rates, symbolic)(*state, *constants)
    return tuple(sympy.nsimplify(rate) for rate in found)


def _text(arguments: Sequence[Any], expressions: Sequence[Any]) -> str:
    """The source of a plain function `derived` of the arguments that returns a tuple of floats."""
    import inspect

    import sympy

    derived = sympy.lambdify(list(arguments), tuple(expressions), modules="math", cse=True)
    source = inspect.getsource(derived)
    return source.replace("def _lambdifygenerated(", "def derived(")


def _kept(name: str, law: Law, write: Callable[[], str]) -> Floats:
    """The function `derived` of a text that is written once a machine.

    It uses `math` only, so that numba compiles it.
    """
    sources = function_digest(under(law, rates), {}), fingerprint(__file__), version("sympy")
    key = (name, Wheel._fields, *sources)
    file = f"{name}-{hashlib.sha256(repr(key).encode()).hexdigest()[:16]}"
    content = load("derivatives", file)
    if content is None:
        content = write().encode()
        keep("derivatives", file, content)
    names = {**vars(math), "__name__": __name__}
    exec(content, names)  # noqa: S102 - what sympy wrote
    derived: Floats = names["derived"]
    return derived


@cache
def derivatives(order: int, law: Law = PAPER) -> Floats:
    """The function of all derivatives of this order of a law's rates by the state.

    It takes the state and the constants. In its result the rate counts first, and the last variable
    runs fastest. numba compiles it, beyond order 1 only without the user's own functions.
    """
    if law.own:
        if order == 1:
            return under(law, differences.jacobian)
        return differences.of_order(order, under(law, rates))

    def write() -> str:
        import sympy

        state, constants = _symbols()
        found = [
            sympy.diff(rate, *variables)
            for rate in _field(law)
            for variables in product(state, repeat=order)
        ]
        return _text([*state, *constants], found)

    return _kept(f"order{order}", law, write)


@cache
def derivatives_by_constant(number: int, law: Law = PAPER) -> Floats:
    """The function of the derivatives of the four rates by the wheel's constant of this number."""
    if law.own:
        return under(law, differences.by_constant, differences.which(number))

    def write() -> str:
        import sympy

        state, constants = _symbols()
        found = [sympy.diff(rate, constants[number]) for rate in _field(law)]
        return _text([*state, *constants], found)

    return _kept(f"constant{number}", law, write)


@cache
def rates_of_vector(law: Law = PAPER) -> Floats:
    """The function of the rates of a state, and of a vector that the Jacobian drives.

    It takes the state, the vector and the constants.
    """
    if law.own:
        return under(law, differences.rates_and_driven)

    def write() -> str:
        import sympy

        state, constants = _symbols()
        vector = sympy.symbols("v1 v2 v3 v4", real=True)
        driven = sympy.Matrix(_field(law)).jacobian(state) * sympy.Matrix(vector)
        return _text([*state, *vector, *constants], (*_field(law), *driven))

    return _kept("vector", law, write)


def jacobian_at(state: Sequence[float], wheel: Wheel) -> Array:
    """The Jacobian, (4, 4), in 1/s."""
    law = law_of(wheel)
    own: Floats = _compiled_jacobian(law) if law.own else derivatives(1, law)
    return np.array(own(*state, *wheel)).reshape(4, 4)


@cache
def _compiled_jacobian(law: Law) -> Floats:
    """The Jacobian by differences, which takes 64 rates, compiled."""
    from sim_motor.compiled import compiled

    own: Floats = compiled(derivatives(1, law))
    return own


def jacobian_by_differences(state: Sequence[float], wheel: Wheel, step: float = 1e-5) -> Array:
    """The Jacobian, (4, 4), by central differences of the rates: a check, good to about step^2."""
    columns, constants, own_rates = [], list(wheel), rates_of(wheel)
    for index in range(4):
        ahead, behind = (list(state) for _ in range(2))
        ahead[index] += step
        behind[index] -= step
        columns.append(
            (np.array(own_rates(*ahead, *constants)) - np.array(own_rates(*behind, *constants)))
            / (2 * step)
        )
    return np.array(columns).T
