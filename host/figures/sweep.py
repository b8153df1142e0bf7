"""The main numbers of a sweep over its swept option; over two, as lines or as maps."""

from __future__ import annotations

from math import ceil, sqrt
from textwrap import wrap
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings, Row
from host.runs.sweep import Axis, Numbers

# More panels are too small to read; the table has all quantities.
MOST_PANELS = 9
# A map needs some values in both directions.
LEAST_MAP = 5
# One for each line, so that they can be told apart in grey, too.
MARKERS = "osD^vPX"
# Where numbers of one sign go over more than this factor, their axis is logarithmic.
WIDE = 30.0
# Numbers that differ by less than this share are shown as equal, not as what rounding does.
SAME = 1e-6
# How far apart words of neighbouring lines stand, in parts of the distance between two words.
ASIDE = 0.12


class Panel(NamedTuple):
    """One quantity: (first swept option, second one or 1) values, errors, and words if it has any.

    Words are numbered; `words` has them in this order.
    """

    name: str
    unit: str
    values: NDArray[np.float64]
    errors: NDArray[np.float64]
    words: list[str]


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of a sweep's table."""
    numbers: Numbers = findings.numbers
    swept = sorted(numbers["swept"], key=lambda axis: -len(axis["values"]))
    quantities = _panels(rows, swept)
    panels = quantities[:MOST_PANELS]
    as_map = len(swept) > 1 and len(swept[1]["values"]) >= LEAST_MAP
    with styled():
        figure = Figure(**SIZE)
        columns = ceil(sqrt(len(panels)))
        grid = figure.subplots(
            max(1, ceil(len(panels) / max(1, columns))),
            max(1, columns),
            squeeze=False,
            sharex=not as_map,
        )
        for axes in grid.flat[len(panels) :]:
            axes.set_axis_off()
        for axes, panel in zip(grid.flat, panels, strict=False):
            axes.set_label(panel.name)
            if as_map:
                _draw_map(axes, panel, swept)
            else:
                _draw_lines(axes, panel, swept)
                _draw_failed(axes, rows, swept[0])
            axes.set_title("\n".join(wrap(panel.name, 30)), fontsize=11)
        if len(swept) > 1 and not as_map and panels:
            share_legend(
                figure, grid.flat, title=_label(swept[1]), loc="outside right center", fontsize=11
            )
        over = " and ".join(axis["name"] for axis in numbers["swept"])
        figure.suptitle(f"{numbers['of']} over {over}", fontsize=16)
        notes = []
        if len(quantities) > len(panels):
            notes.append(
                f"the first {len(panels)} of {len(quantities)} quantities; all are in sweep.csv"
            )
        if any(row["failed"] for row in rows):
            notes.append("crosses and white: points that failed")
        figure.supxlabel("   ".join(notes), fontsize=10)
    return figure


def _panels(rows: list[Row], swept: list[Axis]) -> list[Panel]:
    """The quantities that have a number or word at any point."""
    names = dict.fromkeys(row["quantity"] for row in rows if row["quantity"] is not None)
    places = [{value: n for n, value in enumerate(axis["values"])} for axis in swept]
    shape = (len(places[0]), len(places[1]) if len(places) > 1 else 1)
    found: list[Panel] = []
    for name in names:
        own = [row for row in rows if row["quantity"] == name]
        words = list(dict.fromkeys(row["word"] for row in own if row["word"] is not None))
        values, errors = np.full(shape, np.nan), np.full(shape, np.nan)
        for row in own:
            at = tuple(
                known[row[axis["name"]]] for known, axis in zip(places, swept, strict=True)
            ) + (0,) * (2 - len(swept))
            number = words.index(row["word"]) if row["word"] is not None else row["value"]
            values[at] = np.nan if number is None else number
            errors[at] = np.nan if row["error"] is None else row["error"]
        if not np.isnan(values).all():
            found.append(Panel(name, own[0]["unit"], values, errors, words))
    return found


def _draw_lines(axes: Axes, panel: Panel, swept: list[Axis]) -> None:
    """The quantity over the option with most values, a line for each value of the other one."""
    x = np.array(swept[0]["values"], dtype=float)
    order = np.argsort(x)
    others = swept[1]["values"] if len(swept) > 1 else [None]
    for n, other in enumerate(others):
        # Words of several lines at the same place stand one above the other.
        aside = ASIDE * (n - (len(others) - 1) / 2) if panel.words else 0.0
        axes.errorbar(
            x[order],
            panel.values[order, n] + aside,
            yerr=None if np.isnan(panel.errors).all() else np.nan_to_num(panel.errors[order, n]),
            fmt=MARKERS[n % len(MARKERS)] + ("" if panel.words else "-"),
            markersize=4,
            capsize=2,
            color=COLOURS[n % len(COLOURS)],
            label="" if other is None else f"{other:g}",
        )
    _scale(axes, "x", x)
    axes.set_xlabel(_label(swept[0]))
    axes.tick_params(labelbottom=True)
    if panel.words:
        axes.set_yticks(range(len(panel.words)), panel.words, fontsize=10)
        axes.set_ylim(-0.5, len(panel.words) - 0.5)
    elif panel.unit == "%":
        axes.set(ylabel=panel.unit, ylim=(-5.0, 105.0))
    else:
        _scale(axes, "y", panel.values, panel.errors)
        axes.set_ylabel(panel.unit)


def _draw_failed(axes: Axes, rows: list[Row], swept: Axis) -> None:
    """A cross below each value at which a point failed. All panels go over all values."""
    below: Any = {"transform": axes.get_xaxis_transform(), "linestyle": ""}
    axes.plot(swept["values"], [0.04] * len(swept["values"]), **below)
    failed = [row[swept["name"]] for row in rows if row["failed"]]
    axes.plot(failed, [0.04] * len(failed), marker="x", color="dimgrey", **below)


def _draw_map(axes: Axes, panel: Panel, swept: list[Axis]) -> None:
    """The quantity as a colour over both options."""
    x, y = (np.array(axis["values"], dtype=float) for axis in swept)
    order = np.argsort(x), np.argsort(y)
    values = panel.values[np.ix_(*order)].T
    _scale(axes, "x", x)
    _scale(axes, "y", y)
    image = axes.pcolormesh(x[order[0]], y[order[1]], values, cmap="cividis", shading="nearest")
    axes.set(xlabel=_label(swept[0]), ylabel=_label(swept[1]))
    if panel.words:
        image.set_clim(0, max(1, len(panel.words) - 1))
        colours = image.to_rgba(np.arange(len(panel.words)))
        handles = [
            Line2D([], [], marker="s", linestyle="", color=tuple(colour), label=word)
            for word, colour in zip(panel.words, colours.tolist(), strict=True)
        ]
        axes.legend(handles=handles, fontsize=9, frameon=True)
    elif axes.figure is not None:
        axes.figure.colorbar(image, ax=axes, label=panel.unit)


def _scale(
    axes: Axes, which: str, values: NDArray[np.float64], errors: NDArray[np.float64] | float = 0.0
) -> None:
    """A logarithmic axis for what is positive for sure, and goes over a wide range."""
    known = values[~np.isnan(values)]
    least = values - 2 * np.nan_to_num(errors)
    if len(known) and np.nanmin(least) > 0.0 and known.max() > WIDE * known.min():
        axes.set(**{f"{which}scale": "log"})
    elif len(known) and known.max() - known.min() <= SAME * abs(known.max()):
        middle = float(known.mean())
        margin = 0.1 * abs(middle) or 1.0
        axes.set(**{f"{which}lim": (middle - margin, middle + margin)})


def _label(axis: Axis) -> str:
    return f"{axis['name']} ({axis['unit']})" if axis["unit"] else axis["name"]
