"""Trains that start from random phases: how their wheels' order rises, and which way they go."""

from __future__ import annotations

from itertools import groupby

from matplotlib.figure import Figure

from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

_WAYS = {1: ("forward", COLOURS[0], "-"), -1: ("backward", COLOURS[1], "--")}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**SIZE)
        lines = figure.subplots(len(findings.numbers), 2, sharex="col", squeeze=False)
        for (order, speed), (name, told) in zip(lines, findings.numbers.items(), strict=True):
            for _, train in groupby(
                (row for row in rows if row["preset"] == name), key=lambda row: row["number"]
            ):
                own = list(train)
                word, colour, dashes = _WAYS[1 if own[-1]["omega_rad_s"] >= 0 else -1]
                t = [row["t_s"] for row in own]
                order.plot(
                    t,
                    [row["order"] for row in own],
                    color=colour,
                    linestyle=dashes,
                    linewidth=1,
                    alpha=0.7,
                )
                speed.plot(
                    t,
                    [row["omega_rad_s"] for row in own],
                    color=colour,
                    linestyle=dashes,
                    linewidth=1.2,
                    label=word,
                )
            order.plot(
                t, _means(rows, name), color="black", linewidth=2.5, label="mean of all trains"
            )
            order.axhline(0.9, color="black", linewidth=1, linestyle=":")
            order.set(ylim=(-0.03, 1.04), ylabel="order parameter")
            order.set_title(
                f"{name}: {told['ordered']} of {told['trains']} above 0.9", loc="left", fontsize=13
            )
            speed.axhline(0, color="lightgrey", linewidth=1, zorder=0)
            speed.set_ylabel(r"mean $\omega$ (rad/s)")
            speed.set_title(
                f"{told['forward']} forward, {told['backward']} backward", loc="left", fontsize=13
            )
        for axes in lines[-1]:
            axes.set_xlabel("time (s)")
            axes.margins(x=0)
        named = {
            label: handle
            for axes in figure.axes
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(
            named.values(), named.keys(), loc="outside lower center", ncols=4, fontsize=12
        )
        figure.suptitle("A train of five cars starts from random wheel phases", fontsize=16)
    return figure


def _means(rows: list[Row], name: str) -> list[float]:
    """The order parameter's mean over the trains of a preset, by time."""
    by_time: dict[float, list[float]] = {}
    for row in rows:
        if row["preset"] == name:
            by_time.setdefault(row["t_s"], []).append(row["order"])
    return [sum(orders) / len(orders) for orders in by_time.values()]
