"""Two panels of the figure `lyapunov-line`: how long chaotic transients last."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from host.figures.style import COLOURS
from host.theory.analysis.transients import ENTRY_S, FEWEST
from host.theory.studies.lyapunov_numbers import LineNumbers, Lives
from host.theory.studies.lyapunov_rows import LifeRow

_SMALL = 11
_ABOVE: Any = {
    "loc": "lower left",
    "bbox_to_anchor": (0.0, 1.0),
    "fontsize": _SMALL,
    "borderaxespad": 0.1,
    "handlelength": 1.0,
    "columnspacing": 1.0,
}


def draw_survival(axes: Axes, lives: dict[float, list[LifeRow]], numbers: LineNumbers) -> None:
    """The share of wheels that still switch, with the exponential of the same mean."""
    shown = _well_known(numbers)[-4:]
    if not shown:
        axes.set_title("chaotic transients", fontsize=13, loc="left")
        _say_none(axes)
        return
    longest = 0.0
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(shown)))
    for (entry, mean_s), shade in zip(shown, shades, strict=True):
        colour = tuple(shade)
        own = [row for row in lives[entry["k"]] if row["life_s"] > ENTRY_S]
        ended = np.sort([row["life_s"] - ENTRY_S for row in own if row["ended"]])
        axes.step(
            np.append(0.0, ended),
            1 - np.arange(len(ended) + 1) / len(own),
            where="post",
            color=colour,
            label=f"{entry['k']:.3f}",
        )
        longest = max(longest, float(ended[-1]))
        times = np.linspace(0.0, longest, 100)
        axes.plot(times, np.exp(-times / mean_s), color=colour, linestyle=":", linewidth=1.4)
    axes.set_yscale("log")
    axes.set_ylim(4e-3, 1.15)
    axes.set_xlim(0, longest)
    axes.set_xlabel("time (s)")
    axes.set_ylabel("share that still switches")
    words = "chaotic transients at $k$ = (dotted: exponential)"
    axes.legend(title=words, ncols=len(shown), title_fontsize=12, alignment="left", **_ABOVE)
    axes.xaxis.set_major_locator(MaxNLocator(5))


def draw_lives(axes: Axes, numbers: LineNumbers) -> None:
    """Mean lives against k, with the law of a crisis."""
    own = _well_known(numbers)
    axes.set_title("their mean life", fontsize=13, loc="left")
    if not own:
        _say_none(axes)
        return
    axes.set_yscale("log")
    means_s = [mean_s for _, mean_s in own]
    axes.errorbar(
        [entry["k"] for entry, _ in own],
        means_s,
        [mean_s / np.sqrt(entry["ended"]) for entry, mean_s in own],
        fmt="o",
        color="black",
        markersize=5,
    )
    found = numbers["crisis"]
    if found:
        begin, end = min(entry["k"] for entry, _ in own), found["k"]
        ks = end - (end - begin) * np.logspace(0, -2.5, 200)
        axes.plot(
            ks,
            found["factor"] * (end - ks) ** -found["power"],
            color=COLOURS[1],
            label=f"$\\sim (k_c-k)^{{-{found['power']:.2f}}}$",
        )
        axes.axvline(
            end, color=COLOURS[1], linestyle="--", linewidth=1.4, label=f"$k_c$ = {end:.3f}"
        )
        lasting = [
            entry["k"] for entry in numbers["lives"] if entry["k"] > end and not entry["ended"]
        ]
        top = 3 * max(means_s)
        axes.plot(
            lasting,
            [top] * len(lasting),
            marker="^",
            linestyle="",
            color="black",
            markersize=8,
            label="none ended",
        )
        axes.set_ylim(0.5 * min(means_s), 1.8 * top)
        axes.legend(fontsize=_SMALL, loc="upper left")
    axes.set_xlabel("spring constant $k$")
    axes.set_ylabel("mean life (s)")


def _well_known(numbers: LineNumbers) -> list[tuple[Lives, float]]:
    """The lives at each k where enough of them ended, and their mean (s)."""
    return [
        (entry, entry["mean_s"])
        for entry in numbers["lives"]
        if entry["mean_s"] is not None and entry["ended"] >= FEWEST
    ]


def _say_none(axes: Axes) -> None:
    axes.text(
        0.5,
        0.5,
        "no wheel was seen\nto leave chaos along this line",
        ha="center",
        va="center",
        transform=axes.transAxes,
    )
    axes.set_xticks([])
    axes.set_yticks([])
