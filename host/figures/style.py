"""What all figures look like.

Legible on a projector, colours that people who do not see all of them can tell apart (Okabe and
Ito).
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from matplotlib import rc_context

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
    """Within it, figures are drawn in this style."""
    with rc_context(STYLE):
        yield
