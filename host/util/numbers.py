"""Numbers as people write them on a command line: 3, -0.5, 1e-3, but not nan, inf or 1_0."""

from __future__ import annotations

import argparse
import re
from math import inf

# Numbers that Python knows, and that nobody can use here.
UNUSABLE = ("nan", "inf", "-inf")
_WHOLE = re.compile(r"[+-]?[0-9]{1,40}")
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def parse_number(text: str) -> float | None:
    """The number that a text says: an int if it is written as one. None if it says none."""
    if _WHOLE.fullmatch(text):
        return int(text)
    value = float(text) if _DECIMAL.fullmatch(text) else inf
    return value if abs(value) < inf else None


class Number:
    """What an option takes: a number from `least` to `most`, in a unit.

    argparse calls it with what was typed. Its words continue the option's name: '--k cannot be'.

    Attributes:
        unit: What is counted or measured, such as 's' or 'control periods'; empty for a number
            without a unit.
        least: The smallest number that makes sense.
        most: The greatest.
        whole: Whether only whole numbers make sense.
    """

    def __init__(
        self, unit: str = "", least: float = -inf, most: float = inf, *, whole: bool = False
    ) -> None:
        self.unit = unit
        self.least = least
        self.most = most
        self.whole = whole

    def __call__(self, text: str) -> float:
        """The number. Raises argparse.ArgumentTypeError."""
        value = parse_number(text)
        if value is None or (self.whole and not isinstance(value, int)):
            shown = text if text in UNUSABLE else f"'{_short(text)}'"
            raise argparse.ArgumentTypeError(f"cannot be {shown}; {self.advice()}")
        if not self.least <= value <= self.most:
            raise argparse.ArgumentTypeError(f"cannot be {_short(text)}; {self.advice()}")
        return value if self.whole else float(value)

    def advice(self) -> str:
        """What to write."""
        number = "a whole number" if self.whole else "a number"
        if self.unit:
            number += f" of {self.unit}" if self.whole else f" in {self.unit}"
        if self.least > -inf and self.most < inf:
            number += f", from {self.least:.10g} to {self.most:.10g}"
        elif self.least > -inf:
            number += f", {self.least:.10g} or more"
        return f"give {number}"


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
