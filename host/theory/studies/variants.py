"""Which studies take which variants of the wheel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from host.errors import WrongUse


def require_two_rods(options: Mapping[str, Any]) -> None:
    """Raise WrongUse for a wheel with one rod, in a study that needs the symmetry of two."""
    if options["rods"] == 1:
        raise WrongUse(
            "this study looks at a quarter turn, which repeats itself with two rods only",
            "leave --rods out; fixpoints, hopf, phase-diagram, lyapunov, lyapunov-plane and escape"
            " take one rod",
        )
