"""Kick maps: for each kind of kick and each direction, success against length and phase, and the best kick."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from host.experiments.robot.kick_map import counts, of_kind, share
from host.figures.style import SIZE, styled
from host.kicking.kick_map import LENGTHS
from host.kicking.outcome import DIRECTIONS
from host.runs.contract import Findings, Row
from robot.kicks import PHASE, POSITION

_KINDS = {
    (POSITION, 0): "positions inverted",
    (PHASE, 1): r"phase shifted by $+3\pi/4$",
    (PHASE, -1): r"phase shifted by $-3\pi/4$",
}
_BEST: Any = {"color": "#d55e00", "linewidth": 2.5}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    maps = {
        ((entry["mode"], entry["sign"]), entry["before"]): entry
        for entry in findings.numbers["maps"]
    }
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(2, 3, sharex=True, sharey=True)
        for line, (direction, before) in zip(panels, DIRECTIONS.items(), strict=True):
            for axes, (kind, name) in zip(line, _KINDS.items(), strict=True):
                image = _draw_map(axes, of_kind(rows, *kind, before), maps[kind, before])
                if before == 1:
                    axes.set_title(name, fontsize=13)
            line[0].set_ylabel(f"wheel runs {direction}\nlength (ticks)")
        panels[0, 0].set_yticks(LENGTHS)
        panels[0, 0].set_xticks((0, 90, 180, 270))
        panels[1, 1].set_xlabel("phase of the wheel when the kick begins (°)")
        bar = figure.colorbar(image, ax=panels, shrink=0.9, pad=0.02)
        bar.set_label("reversed (%); beside each row: at all phases together")
        figure.suptitle(
            f"Which kicks reverse a wheel, and when: {findings.numbers['kicks']:,} kicks; the best"
            " framed",
            fontsize=16,
        )
    return figure


def _draw_map(axes: Axes, rows: list[Row], entry: dict[str, Any]) -> AxesImage:
    edge = 0.5  # bins begin half a count of the encoder early
    extent = (-edge, 360 - edge, LENGTHS[0] - 0.5, LENGTHS[-1] + 0.5)
    image = axes.imshow(
        100 * share(counts(rows)),
        origin="lower",
        aspect="auto",
        extent=extent,
        cmap="cividis",
        vmin=0,
        vmax=100,
    )
    axes.tick_params(axis="y", labelsize=10)
    for ticks, blind in zip(LENGTHS, entry["blind"], strict=True):
        share_text = (
            ""
            if blind["rate"] is None
            else f"{100 * blind['rate']:.{0 if blind['rate'] in (0, 1) else 1}f}"
        )
        axes.text(364, ticks, share_text, fontsize=9, va="center")
    best = entry["best"]
    if best:
        low, high = best["window_deg"] or (-edge, 360 - edge)
        for begin, end in [(low, high)] if low < high else [(low, 360 - edge), (-edge, high)]:
            box = np.array(
                [
                    [begin, end, end, begin, begin],
                    best["ticks"] + np.array([-0.5, -0.5, 0.5, 0.5, -0.5]),
                ]
            )
            axes.plot(*box, **_BEST)
    return image
