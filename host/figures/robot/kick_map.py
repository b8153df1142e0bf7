"""Kick maps: success against length and phase for each kind of kick, and the best kick."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from host.experiments.robot.kick_map import BestKick, BlindKick, KindNumbers, Numbers
from host.experiments.robot.kick_map_rows import Row, counts, of_kind, share
from host.figures.style import SIZE, styled
from host.kicking.kick_map import LENGTHS
from host.kicking.outcome import DIRECTIONS
from host.runs.contract import Findings
from robot.kicks import PHASE, POSITION

_KINDS = {
    (POSITION, 0): "positions inverted",
    (PHASE, 1): r"phase shifted by $+3\pi/4$",
    (PHASE, -1): r"phase shifted by $-3\pi/4$",
}
PANELS = tuple(
    f"{kind}-{direction}"
    for direction in DIRECTIONS
    for kind in ("position", "phase-plus", "phase-minus")
)
_EDGE_DEG = 0.5  # bins begin half a count of the encoder early
_BEST: Any = {"color": "#d55e00", "linewidth": 2.5}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    maps = {((entry["mode"], entry["sign"]), entry["before"]): entry for entry in numbers["maps"]}
    with styled():
        figure = Figure(**SIZE)
        panels = figure.subplots(2, 3, sharex=True, sharey=True)
        for line, (direction, before) in zip(panels, DIRECTIONS.items(), strict=True):
            for axes, (kind, name) in zip(line, _KINDS.items(), strict=True):
                image = _draw_map(axes, of_kind(rows, *kind, before), maps[kind, before])
                axes.set_title(name, fontsize=12)
            line[0].set_ylabel(f"wheel runs {direction}\nlength (ticks)")
        panels[0, 0].set_yticks(LENGTHS)
        panels[0, 0].set_xticks((0, 90, 180, 270))
        panels[1, 1].set_xlabel("phase of the wheel when the kick begins (°)")
        bar = figure.colorbar(image, ax=panels, shrink=0.9, pad=0.02)
        bar.set_label("reversed (%); beside each row: at all phases together")
        gaps = any(np.ma.is_masked(axes.images[0].get_array()) for axes in panels.flat)
        figure.suptitle(
            f"Which kicks reverse a wheel, and when: {numbers['kicks']:,} kicks; the best"
            f" framed{'; white: not tried' if gaps else ''}",
            fontsize=16,
        )
    return figure


def _draw_map(axes: Axes, rows: list[Row], entry: KindNumbers) -> AxesImage:
    image = axes.imshow(
        100 * share(counts(rows)),
        origin="lower",
        aspect="auto",
        extent=(-_EDGE_DEG, 360 - _EDGE_DEG, LENGTHS[0] - 0.5, LENGTHS[-1] + 0.5),
        cmap="cividis",
        vmin=0,
        vmax=100,
    )
    axes.tick_params(axis="y", labelsize=10)
    for ticks, blind in zip(LENGTHS, entry["blind"], strict=True):
        axes.text(364, ticks, _percent(blind), fontsize=9, va="center")
    if entry["best"]:
        _frame(axes, entry["best"])
    return image


def _percent(blind: BlindKick) -> str:
    """The rate in percent, with a decimal if it is neither 0 nor 100."""
    rate = blind["rate"]
    if rate is None:
        return ""
    return f"{100 * rate:.0f}" if rate in (0, 1) else f"{100 * rate:.1f}"


def _frame(axes: Axes, best: BestKick) -> None:
    """Frame the best kick; a window around phase 0 has two frames."""
    low, high = best["window_deg"] or (-_EDGE_DEG, 360 - _EDGE_DEG)
    frames = [(low, high)] if low < high else [(low, 360 - _EDGE_DEG), (-_EDGE_DEG, high)]
    below, above = best["ticks"] - 0.5, best["ticks"] + 0.5
    for begin, end in frames:
        axes.plot([begin, end, end, begin, begin], [below, below, above, above, below], **_BEST)
