"""Power series in time, as compiled code for eight wheels at a time.

`Lanes` is a number of eight wheels at once: what is done with it becomes instructions of the
compiler LLVM. `Series` is a function of time: it computes its Taylor coefficients on demand. The
plain functions of host.theory.model take both, as they take floats (sim_motor.mathematics).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir

from host.theory.engine import elementary
from sim_motor.mathematics import with_mathematics

LANES = 8
_REAL, _WHOLE = ir.VectorType(ir.DoubleType(), LANES), ir.VectorType(ir.IntType(64), LANES)
# As elementary.OPTIONS: contracting or dividing by a reciprocal changes the last bit only.
_FLAGS = ("contract", "arcp", "nsz")


class Lanes:
    """Eight floats, or eight whole numbers of 64 bits, in the code that a builder writes."""

    def __init__(self, builder: Any, value: Any) -> None:
        self.builder, self.value = builder, value

    @classmethod
    def load(cls, builder: Any, data: Any, row: int) -> Lanes:
        """A row of a table of eight columns."""
        return cls(builder, builder.load(_place(builder, data, row), align=8))

    def store(self, data: Any, row: int) -> None:
        """Write into a row of a table of eight columns."""
        self.builder.store(self.value, _place(self.builder, data, row), align=8)

    def _other(self, other: Any) -> Any:
        if isinstance(other, Lanes):
            return other.value
        return ir.Constant(self.value.type, LANES * [other])

    def _new(self, value: Any) -> Lanes:
        return Lanes(self.builder, value)

    def __add__(self, other: Any) -> Any:
        instruction = "add" if self.value.type == _WHOLE else "fadd"
        return _written(instruction, self, other)

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        return _written("fsub", self, other)

    def __rsub__(self, other: float) -> Any:
        return self._new(self._other(other)) - self

    def __neg__(self) -> Lanes:
        return self._new(self.builder.fneg(self.value))

    def __mul__(self, other: Any) -> Any:
        return _written("fmul", self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return _written("fdiv", self, other)

    def __rtruediv__(self, other: float) -> Any:
        return self._new(self._other(other)) / self

    def __lshift__(self, bits: int) -> Any:
        return _written("shl", self, bits)

    def __and__(self, other: Any) -> Any:
        return _written("and_", self, other)

    def __xor__(self, other: Any) -> Any:
        return _written("xor", self, other)

    def larger(self, other: Any) -> Lanes:
        """The larger one of two floats; `other` where this is not a number."""
        bigger = self.builder.fcmp_ordered(">", self.value, self._other(other))
        return self._new(self.builder.select(bigger, self.value, self._other(other)))

    def smaller(self, other: Any) -> Lanes:
        """The smaller one of two floats; `other` where this is not a number."""
        less = self.builder.fcmp_ordered("<", self.value, self._other(other))
        return self._new(self.builder.select(less, self.value, self._other(other)))

    def any_is(self, value: float) -> Any:
        """Whether one of the floats has this value, as a whole number: 0 if none has it."""
        same = self.builder.fcmp_ordered("==", self.value, self._other(value))
        return self.builder.zext(self.builder.bitcast(same, ir.IntType(LANES)), ir.IntType(64))

    def magnitude(self) -> Lanes:
        """The floats without their signs."""
        return float_of(bits_of(self) & ((1 << 63) - 1))

    def as_float(self) -> Lanes:
        """Whole numbers as floats of the same value."""
        return self._new(self.builder.sitofp(self.value, _REAL))

    def as_whole(self) -> Lanes:
        """Floats as whole numbers, cut."""
        return self._new(self.builder.fptosi(self.value, _WHOLE))


def _written(instruction: str, one: Lanes, other: Any) -> Any:
    """What an instruction makes of two numbers; a series knows better what to do with a number."""
    if isinstance(other, Series):
        return NotImplemented
    flags = {"flags": _FLAGS} if instruction.startswith("f") else {}
    write = getattr(one.builder, instruction)
    return Lanes(one.builder, write(one.value, one._other(other), **flags))  # noqa: SLF001


def _place(builder: Any, data: Any, row: int) -> Any:
    first = builder.gep(data, [ir.Constant(ir.IntType(64), row * LANES)])
    return builder.bitcast(first, _REAL.as_pointer())


def bits_of(number: Lanes) -> Lanes:
    """The bits of floats as whole numbers."""
    return Lanes(number.builder, number.builder.bitcast(number.value, _WHOLE))


def float_of(bits: Lanes) -> Lanes:
    """The floats with these bits."""
    return Lanes(bits.builder, bits.builder.bitcast(bits.value, _REAL))


def _chosen(condition: Lanes, one: Lanes, other: Lanes) -> Lanes:
    builder = condition.builder
    zero = ir.Constant(_WHOLE, LANES * [0])
    truth = builder.icmp_signed("!=", condition.value, zero)
    return Lanes(builder, builder.select(truth, one.value, other.value))


def _of_lanes(name: str) -> Any:
    """A function of host.theory.engine.elementary for `Lanes`: the same code."""
    parts = {"_bits": bits_of, "_float": float_of, "_chosen": _chosen}
    for helper in ("_polynomial", "_sin_of_quarters", "exp"):
        parts[helper] = with_mathematics(getattr(elementary, helper).py_func, parts)
    parts |= {"min": Lanes.smaller, "max": Lanes.larger}
    return with_mathematics(getattr(elementary, name).py_func, parts)


_SIN, _COS, _EXP, _TANH = map(_of_lanes, ("sin", "cos", "exp", "hyperbolic_tangent"))


class Series:
    """A function of time as a series; x[n] is the coefficient of t^n."""

    def __init__(self, coefficient: Callable[[int], Any]) -> None:
        self._coefficient, self._known = coefficient, list[Any]()

    def __getitem__(self, power: int) -> Any:
        while len(self._known) <= power:
            self._known.append(self._coefficient(len(self._known)))
        return self._known[power]

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series(lambda n: self[n] + other[n])
        return Series(lambda n: self[n] if n else self[0] + other)

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Series(lambda n: -self[n])

    def __sub__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series(lambda n: self[n] - other[n])
        return Series(lambda n: self[n] if n else self[0] - other)

    def __rsub__(self, other: Any) -> Series:
        return Series(lambda n: -self[n] if n else other - self[0])

    def __mul__(self, other: Any) -> Series:
        if isinstance(other, Series):
            return Series(lambda n: _folded(self, other, 0, n))
        return Series(lambda n: self[n] * other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        if isinstance(other, Series):
            return _quotient(lambda n: self[n], other)
        return self * (1.0 / other)

    def __rtruediv__(self, other: Any) -> Series:
        return _quotient(lambda n: None if n else other, self)


def _folded(one: Series, other: Series, first: int, last: int, terms: range | None = None) -> Any:
    """The sum of one[j] other[last - j] over j from `first` to `last`, or over some terms."""
    first, *others = range(first, last + 1) if terms is None else terms
    total = one[first] * other[last - first]
    for j in others:
        total = total + one[j] * other[last - j]
    return total


def square(one: Series) -> Series:
    """Its square, for half of the work of a product."""

    def coefficient(n: int) -> Any:
        total = one[n // 2] * one[n // 2] if n % 2 == 0 else 0.0
        if n:
            half = _folded(one, one, 0, n, range((n + 1) // 2))
            total = half + half + total
        return total

    return Series(coefficient)


def _quotient(above: Callable[[int], Any], below: Series) -> Series:
    """From quotient * below = above. `above` gives None for 0."""

    def coefficient(n: int) -> Any:
        if n == 0:
            return above(0) / below[0]
        rest, given = _folded(below, quotient, 1, n), above(n)
        return (-rest if given is None else given - rest) * inverse[0]

    quotient = Series(coefficient)
    inverse = Series(lambda _: 1.0 / below[0])
    return quotient


def _slope(one: Series) -> Series:
    return Series(lambda n: one[n + 1] * float(n + 1))


def driven(first: Any, slope: Callable[[int], Any]) -> Series:
    """The series with this first coefficient and this derivative."""
    return Series(lambda n: slope(n - 1) * (1.0 / n) if n else first())


class Mathematics:
    """sin, cos, exp and tanh of series. A sine and the cosine of the same series belong together.

    Each obeys a differential equation, as d sin(u) = cos(u) du.
    """

    def __init__(self) -> None:
        self._circular = dict[Series, tuple[Series, Series]]()
        self.names = {name: getattr(self, name) for name in ("sin", "cos", "exp", "tanh")}

    def _both(self, one: Series) -> tuple[Series, Series]:
        if one not in self._circular:
            slope = _slope(one)
            sine = driven(lambda: _SIN(one[0]), lambda n: _folded(slope, cosine, 0, n))
            cosine = driven(lambda: _COS(one[0]), lambda n: -_folded(slope, sine, 0, n))
            self._circular[one] = sine, cosine
        return self._circular[one]

    def sin(self, one: Series) -> Series:
        """The sine."""
        return self._both(one)[0]

    def cos(self, one: Series) -> Series:
        """The cosine."""
        return self._both(one)[1]

    def exp(self, one: Series) -> Series:
        """e to the power of the series."""
        slope = _slope(one)
        found = driven(lambda: _EXP(one[0]), lambda n: _folded(slope, found, 0, n))
        return found

    def tanh(self, one: Series) -> Series:
        """The hyperbolic tangent."""
        slope = _slope(one)
        found = driven(lambda: _TANH(one[0]), lambda n: _folded(slope, rest, 0, n))
        rest = 1.0 - square(found)
        return found
