"""What a pupil has found out with the model wheel, judged by what the page has shown of it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isclose
from typing import NamedTuple

from host.lab.lessons.checks import Finding
from host.lab.lessons.model import RUNS, exact_k, exact_slope

KS, K_OFF = 4, 0.05
# The number of pairs, and how far the slope of their mean may be from the exponent, 1/s. The
# standard deviation of single slopes is 0.24/s, that of the mean of eight 0.08/s.
PAIRS, SLOPE_OFF = 8, 0.25
# Numbers that pages show are rounded.
_ROUNDING = 1e-3


class Shown(NamedTuple):
    """One run as a page has shown it: what was chosen, and what was seen, as model.py has it."""

    value: float
    seen: list[float | None]


def check(name: str, runs: Sequence[Shown], own: float | None) -> list[Finding]:
    """Check an exercise with the model wheel.

    Args:
        name: The exercise's.
        runs: All runs that the page has shown in it.
        own: The number that the pupil has found; None for none yet.

    Returns:
        What was looked at; the exercise is done if all of it is as it should be.
    """
    return [*CHECKS[name](runs, own), _honest(name, runs)]


def _rest(runs: Sequence[Shown], own: float | None) -> list[Finding]:
    ks = sorted({run.value for run in runs})
    sizes = [run.seen[1] for run in runs if run.seen[1] is not None]
    dying, growing = sum(size < 1.0 for size in sizes), sum(size > 1.0 for size in sizes)
    return [
        Finding(len(ks) >= KS, f"different values of k: {len(ks)}, needed: {KS}"),
        Finding(
            dying > 0 and growing > 0,
            f"swings that died out: {dying}, swings that grew: {growing}, needed: one of each",
        ),
        _near(own, exact_k(), K_OFF, "k", "rest loses above k ="),
    ]


def _twins(runs: Sequence[Shown], own: float | None) -> list[Finding]:
    pairs = len({run.value for run in runs})
    return [
        Finding(pairs >= PAIRS, f"pairs of twins: {pairs}, needed: {PAIRS}"),
        _near(own, exact_slope(), SLOPE_OFF, "slope", "the model's largest exponent, in 1/s, is"),
    ]


def _near(own: float | None, exact: float, off: float, what: str, words: str) -> Finding:
    """Whether the pupil's number is near the exact one, which is said only then."""
    if own is None:
        return Finding(False, f"your own {what} is missing")
    if abs(own - exact) > off:
        return Finding(False, f"your {what}, {own:g}, is more than {off:g} off the exact one")
    return Finding(True, f"your {what} is {own:g}, and {words} {exact:.3f}")


def _honest(name: str, runs: Sequence[Shown]) -> Finding:
    """Whether the wheel did what the paper's equations say, in each run."""
    for number, run in enumerate(runs, start=1):
        again = RUNS[name](run.value).seen
        if len(again) != len(run.seen) or not all(map(_same, again, run.seen)):
            return Finding(
                False, f"run {number} is not what the model does: computed again, it is another one"
            )
    if not runs:
        return Finding(False, "the model wheel has not moved yet")
    if len(runs) == 1:
        return Finding(True, "1 run computed again: it follows the paper's equations")
    return Finding(True, f"{len(runs)} runs computed again: all follow the paper's equations")


def _same(one: float | None, other: float | None) -> bool:
    if one is None or other is None:
        return one is other
    return isclose(one, other, rel_tol=_ROUNDING, abs_tol=_ROUNDING)


CHECKS: dict[str, Callable[[Sequence[Shown], float | None], list[Finding]]] = {
    "rest": _rest,
    "twins": _twins,
}
