"""How predictions of kicks come true: reliability diagram, scores, and how sure they are."""

from __future__ import annotations

from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.robot.predictions import Numbers, Row
from host.figures.style import COLOURS, SIZE, styled
from host.kicking.outcome import REVERSES
from host.runs.contract import Findings

PANELS = ("reliability", "scores", "shares")
_SHARES = np.linspace(0.0, 1.0, 21)


def draw(rows: list[Row], findings: Findings) -> Figure:
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        places = figure.subplot_mosaic([["reliability", "scores"], ["reliability", "shares"]])
        _draw_reliability(places["reliability"], numbers)
        _draw_scores(places["scores"], numbers)
        _draw_shares(places["shares"], rows)
        figure.suptitle(f"{numbers['kicks']} kicks: predicted and happened", fontsize=16)
    return figure


def _draw_reliability(axes: Axes, numbers: Numbers) -> None:
    """The share that reversed against the predicted one, with 95 % intervals."""
    axes.plot([0, 1], [0, 1], color="black", linestyle=":", label="as predicted")
    for one in numbers["bins"]:
        share = one["reversed"] / one["wheels"]
        low, high = one["interval"]
        axes.errorbar(
            one["predicted"],
            share,
            yerr=[[max(0.0, share - low)], [max(0.0, high - share)]],
            fmt="o" if one["fits"] else "X",
            markersize=8,
            capsize=4,
            color=COLOURS[0] if one["fits"] else COLOURS[1],
        )
        right = one["predicted"] < 0.5 or one["predicted"] == 1.0
        axes.annotate(
            f"{one['wheels']}",
            (one["predicted"], share),
            xytext=(10 if right else -10, -4),
            textcoords="offset points",
            ha="left" if right else "right",
            fontsize=11,
        )
    axes.set_xlim(-0.06, 1.16)
    axes.set_ylim(-0.06, 1.16)
    axes.set_aspect("equal")
    axes.set_xlabel("predicted share that reverses")
    axes.set_ylabel("share that reversed (95 % intervals; numbers of wheels)")
    axes.legend(loc="upper left", fontsize=11)


def _draw_scores(axes: Axes, numbers: Numbers) -> None:
    """The Brier scores by mode."""
    names = list(numbers["scores"])
    places = np.arange(len(names))
    kinds: tuple[tuple[str, Literal["brier", "same", "always"], str, str], ...] = (
        ("prediction", "brier", COLOURS[0], ""),
        ("the same share for all", "same", COLOURS[5], ".."),
        ("'always reverses'", "always", COLOURS[1], "//"),
    )
    for index, (label, key, colour, hatch) in enumerate(kinds):
        heights = [numbers["scores"][name][key] for name in names]
        axes.bar(
            places + 0.27 * (index - 1),
            heights,
            0.25,
            color=colour,
            hatch=hatch,
            edgecolor="white",
            label=label,
        )
    axes.set_xticks(places, names, fontsize=9.5)
    axes.set_ylabel("Brier score")
    axes.set_ylim(0, 1.0)
    axes.legend(fontsize=11)


def _draw_shares(axes: Axes, rows: list[Row]) -> None:
    """How sure the predictions are, and what happened."""
    groups = [
        [row["reverses"] / row["of"] for row in rows if (row["result"] == REVERSES) is reverses]
        for reverses in (True, False)
    ]
    axes.hist(
        groups,
        bins=_SHARES.tolist(),
        stacked=True,
        color=[COLOURS[0], COLOURS[4]],
        label=["reversed", "did not"],
        rwidth=0.9,
    )
    axes.set_xlabel("predicted share that reverses")
    axes.set_ylabel("wheels")
    axes.legend(fontsize=11, loc="upper center")
