"""What the functions of kickctl.theory take and return: checked arguments, results that show."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from host.errors import WrongUse
from host.theory.model.laws import has_symmetries
from host.theory.model.wheel import Array, Wheel
from host.util.arguments import wrong

# A notebook shows arrays of at most this length.
_SHOWN = 6


class Result:
    """A result whose repr says what is in its arrays, instead of all their numbers."""

    def __repr__(self) -> str:
        names = [field.name for field in fields(self)]  # type: ignore[arg-type]
        values = ", ".join(f"{name}={_shown(getattr(self, name))}" for name in names)
        return f"{type(self).__name__}({values})"


def _shown(value: Any) -> str:
    """A value in a few words."""
    if isinstance(value, np.ndarray):
        return _shown_array(value)
    if isinstance(value, tuple):
        return f"({', '.join(map(_shown, value))})"
    return f"{value:.6g}" if isinstance(value, float) else repr(value)


def _shown_array(value: NDArray[Any]) -> str:
    """A short array itself, of a long one its shape and what is in it."""
    if value.size <= _SHOWN:
        return np.array2string(value, precision=6, separator=", ")
    if value.dtype.kind in "Ub":
        content = ", ".join(map(str, np.unique(value)))
    elif value.dtype.kind == "c":
        content = "complex"
    elif np.isnan(value).all():
        content = "nan"
    else:
        content = f"{np.nanmin(value):.6g} to {np.nanmax(value):.6g}"
    return f"<{' x '.join(map(str, value.shape))}: {content}>"


def need_wheel(value: object) -> Wheel:
    """The value, if it is a wheel that can be. Raises WrongUse."""
    if not isinstance(value, Wheel):
        raise wrong("wheel", value, "a Wheel, such as Wheel(k=8, tau=0.25)")
    return Wheel(**{name: float(own) for name, own in value.checked()._asdict().items()})


def need_numbers(name: str, values: object, wanted: str) -> Array:
    """The values as an array, (values,), of finite numbers. Raises WrongUse."""
    try:
        found = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError, OverflowError):
        raise wrong(name, values, wanted) from None
    if found.ndim != 1 or not len(found) or not np.isfinite(found).all():
        raise wrong(name, values, wanted)
    return found


def need_ascending(name: str, values: object, wanted: str, least: float = -np.inf) -> Array:
    """The same for values that ascend, none of them below `least`. Raises WrongUse."""
    found = need_numbers(name, values, wanted)
    if found[0] < least or (np.diff(found) <= 0.0).any():
        raise wrong(name, values, wanted)
    return found


def need_symmetric(wheel: Wheel, what: str) -> None:
    """Raise WrongUse for a wheel that lacks a symmetry of the paper's."""
    if not has_symmetries(wheel):
        raise WrongUse(
            f"{what} are computed with the symmetries of the paper's wheel, which this one lacks",
            "give two rods, x_t(-x) = -x_t(x), and mechanics that give the opposite acceleration"
            " for the opposite torque and omega",
        )


def need_smooth(wheel: Wheel, what: str) -> None:
    """Raise WrongUse for a wheel with dry friction, which is not smooth at omega = 0."""
    if wheel.dry_friction:
        raise WrongUse(f"{what} of a wheel with dry friction are not computed", "leave it out")
