"""Where something changes between two numbers, down to the last bit.

To import scipy's root finders would take longer than most searches.
"""

from __future__ import annotations

from collections.abc import Callable


def last_alike(
    holds: Callable[[float], bool], begin: float, end: float, within: float = 0.0
) -> float:
    """The last number before something changes.

    Args:
        holds: Whether it holds at a number.
        begin: Where the search begins.
        end: A number at which it is not as at `begin`, less or greater.
        within: How far the change may be from the number.

    Returns:
        The number; with `within` = 0 the next float is behind the change.
    """
    first = holds(begin)
    while (middle := (begin + end) / 2) not in (begin, end) and abs(end - begin) > within:
        begin, end = (middle, end) if holds(middle) == first else (begin, middle)
    return begin
