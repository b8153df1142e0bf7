"""Parts of the figures `section` and `orbit`: colours of motions, and letters of constants."""

from __future__ import annotations

from matplotlib.lines import Line2D

from host.figures.style import COLOURS
from host.theory.analysis.sections import MotionKind

COLOUR: dict[MotionKind, str] = {
    "at rest": COLOURS[6],
    "forth-and-back": COLOURS[4],
    "rolling": COLOURS[0],
    "chaotic": COLOURS[1],
    "quasi-periodic": COLOURS[2],
    "undecided": COLOURS[5],
}
# Those of motions that do not repeat themselves are small.
MARKER: dict[MotionKind, str] = {
    "at rest": "s",
    "forth-and-back": "^",
    "rolling": "o",
    "chaotic": ".",
    "quasi-periodic": "x",
    "undecided": "+",
}
LETTERS = {"tau": r"$\tau$", "a": "$a$", "k": "$k$", "f": "$f$", "I": "$I$"}
UNITS = {"tau": " s", "f": " s", "I": " s²"}


def handles(kinds: set[MotionKind]) -> list[Line2D]:
    """Entries of a legend for these motions."""
    return [
        Line2D([], [], color=colour, marker=MARKER[kind], markersize=7, linestyle="", label=kind)
        for kind, colour in COLOUR.items()
        if kind in kinds
    ]
