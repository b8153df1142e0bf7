"""Parts of the figures `section` and `orbit`: colours of motions, and a wheel's constants."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from host.figures.style import COLOURS
from host.theory.analysis.sections import MotionKind

COLOUR: dict[MotionKind, str] = {
    "at rest": COLOURS[6],
    "forth-and-back": COLOURS[4],
    "rolling": COLOURS[0],
    "chaotic": COLOURS[1],
    "quasi-periodic": COLOURS[2],
}
LETTERS = {"tau": r"$\tau$", "a": "$a$", "k": "$k$", "f": "$f$", "I": "$I$"}
UNITS = {"tau": " s", "f": " s", "I": " s²"}


def handles(kinds: set[MotionKind]) -> list[Line2D]:
    """Entries of a legend for these motions."""
    return [
        Line2D([], [], color=colour, marker="o", markersize=7, linestyle="", label=kind)
        for kind, colour in COLOUR.items()
        if kind in kinds
    ]


def write_constants(figure: Figure, constants: dict[str, float]) -> None:
    """Write the constants of a wheel into the figure's lower right corner, below all panels."""
    figure.set_layout_engine("constrained", rect=(0.0, 0.03, 1.0, 0.97))
    words = ", ".join(
        f"{LETTERS[name]} = {value:g}{UNITS.get(name, '')}" for name, value in constants.items()
    )
    figure.text(0.995, 0.005, words, ha="right", va="bottom", fontsize=11)
