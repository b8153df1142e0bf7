"""Numbers as people write them on a command line: 3, -0.5, 1e-3, but not nan, inf or 1_0."""

from __future__ import annotations

import argparse
import re
from math import inf
from typing import Any

# Numbers that Python knows, and that nobody can use here.
UNUSABLE = ("nan", "inf", "-inf")
# More values of one option are a mistake.
MOST_VALUES = 10_000
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
        return f"give {number}" + (f", {self.span()}" if self.span() else "")

    def span(self) -> str:
        """From where to where it may go; empty if it may be any number."""
        if self.least > -inf and self.most < inf:
            return f"from {self.least:.10g} to {self.most:.10g}"
        return f"{self.least:.10g} or more" if self.least > -inf else ""


class Values(Number):
    """What an option takes that can be swept: a number, or several of them.

    Several are separated by commas, and start:stop:count stands for evenly spaced ones, with both
    ends: 0.1,0.25,0.5 or 0.1:1:10.
    """

    def __call__(self, text: str) -> Any:
        """The number as a float or int, or several as a list of them.

        Raises argparse.ArgumentTypeError.
        """
        parts = text.split(",")
        if len(parts) == 1 and ":" not in text:
            return super().__call__(text)
        values: list[float] = []
        for part in parts:
            values += self._range(part) if ":" in part else [super().__call__(part)]
        return values

    def _range(self, text: str) -> list[float]:
        """Evenly spaced numbers, as start:stop:count gives them."""
        parts = text.split(":")
        if len(parts) != len(("start", "stop", "count")):
            raise argparse.ArgumentTypeError(
                f"cannot be '{_short(text)}'; write start:stop:count, as in 0.1:1:10"
            )
        start, stop = (super(Values, self).__call__(part) for part in parts[:2])
        count = parse_number(parts[2])
        if not isinstance(count, int) or not 2 <= count <= MOST_VALUES:
            raise argparse.ArgumentTypeError(
                f"cannot be '{_short(text)}': its third part counts the values, from 2 to"
                f" {MOST_VALUES}; write start:stop:count, as in 0.1:1:10"
            )
        # Twelve digits, so that 0.3 is no 0.30000000000000004.
        values = [float(f"{start + (stop - start) * n / (count - 1):.12g}") for n in range(count)]
        if not self.whole:
            return values
        if any(value != int(value) for value in values):
            raise argparse.ArgumentTypeError(
                f"cannot be '{_short(text)}', which is not in whole steps; {self.advice()}, or"
                " choose another count"
            )
        return [int(value) for value in values]


def _short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."
