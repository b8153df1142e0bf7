"""What all figures look like, and parts that several of them share.

They are legible on a projector, in colours that people with any colour vision can tell apart
(Okabe and Ito).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
STYLE: Any = {
    "font.size": 13,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "svg.hashsalt": "kickctl",  # the same drawing is the same file
}
# 1600 pixels wide.
SIZE: Any = {"figsize": (10.0, 6.4), "dpi": 160, "layout": "constrained"}


@contextmanager
def styled() -> Iterator[None]:
    """Draw figures in this style within the context."""
    with rc_context(STYLE):
        yield


def share_legend(place: Axes | Figure, panels: Iterable[Axes], **style: Any) -> None:
    """Put one legend for several panels into a panel or the figure, each label once."""
    known: dict[str, Any] = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        known |= dict(zip(labels, handles, strict=True))
    place.legend(list(known.values()), list(known), **style)
