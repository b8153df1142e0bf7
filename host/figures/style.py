"""What all figures look like, and parts that several of them share.

They are legible on a projector, in colours that people with any colour vision can tell apart
(Okabe and Ito).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context, rcdefaults, rcParams
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import Bbox

from host.figures.caption import Caption
from host.util.whole_files import whole_file

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
STYLE: Any = {
    "font.size": 13,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "svg.hashsalt": "kickctl",  # the same drawing is the same file
    "svg.fonttype": "none",  # text as text
    "pdf.fonttype": 42,
}
# The strip below a figure in which its parameters stand, inches.
STRIP = 0.25
# With this strip a slide of 16:9, 1920 by 1080 pixels.
SIZE: Any = {"figsize": (12.0, 6.75 - STRIP), "dpi": 160, "layout": "constrained"}
_CORNER: Any = {"ha": "right", "va": "center", "fontsize": 10, "color": "#333333"}


@contextmanager
def styled() -> Iterator[None]:
    """Draw figures in this style within the context, no matter what the user's matplotlibrc says.

    A figure has to be saved in it, too: fonts, colours and sizes count until then.
    """
    with rc_context():
        rcdefaults()
        rcParams.update(STYLE)
        yield


def save(
    figure: Figure, path: str | Path, caption: Caption | None = None, *, new: bool = False
) -> Path:
    """Write a figure to a file, which appears when it is whole.

    Args:
        figure: The figure.
        path: The file; its ending, such as .png or .svg, says the format.
        caption: What the figure says about its run, in a strip below it and in the file's metadata.
        new: Whether the file must not exist.

    Returns:
        The path.

    Raises:
        FileTaken: `new`, and there is such a file.
        OSError: The file cannot be written.
    """
    ending = Path(path).suffix.removeprefix(".").lower() or "png"
    about: dict[str, Any] = {"metadata": (caption or Caption("", "")).metadata(ending)}
    with styled(), whole_file(path, new=new) as draft:
        if caption is not None:
            width, height = figure.get_size_inches()
            about["bbox_inches"] = Bbox.from_extents(0.0, -STRIP, width, height)
            place = (1.0 - 0.1 / width, -0.6 * STRIP / height)
            _fix_layout(figure)
            words = figure.text(*place, caption.parameters, **_CORNER)
        try:
            figure.savefig(draft, format=ending, **about)
        finally:
            if caption is not None:
                words.remove()
    return Path(path)


def _fix_layout(figure: Figure) -> None:
    """Lay a figure out, once for all formats: this takes longer than drawing it.

    Afterwards a strip below the figure moves no legend that is outside of all panels.
    """
    engine = figure.get_layout_engine()
    if not isinstance(engine, ConstrainedLayoutEngine):
        return
    engine.execute(figure)
    figure.set_layout_engine(None)  # with "none", matplotlib draws twice for each file
    for legend in figure.legends:
        if legend.get_bbox_to_anchor() is figure.bbox:
            legend.set_bbox_to_anchor((0.0, 0.0, 1.0, 1.0), figure.transFigure)


# A legend above a panel, on the right: it covers no data.
ABOVE: Any = {"loc": "lower right", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.1}


def say_if_empty(axes: Axes, words: str) -> None:
    """Write into a panel without data why it has none."""
    drawn = any(np.isfinite(np.asarray(line.get_ydata(), float)).any() for line in axes.lines)
    if not drawn and not axes.collections and not axes.images:
        axes.text(0.5, 0.5, words, ha="center", va="center", transform=axes.transAxes)
        axes.set(xticks=[], yticks=[])


def share_legend(place: Axes | Figure, panels: Iterable[Axes], **style: Any) -> None:
    """Put one legend for several panels into a panel or the figure, each label once."""
    known: dict[str, Any] = {}
    for axes in panels:
        handles, labels = axes.get_legend_handles_labels()
        known |= dict(zip(labels, handles, strict=True))
    place.legend(list(known.values()), list(known), **style)
