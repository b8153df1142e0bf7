"""A train that wiggles: its joints' wave, amplitudes and lags beside the authors' program, and the highest speed by the start."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_wiggle import AUTHORS, AUTHORS_LAG_DEG, TRAINS
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row

_MARKS = "os^"


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    with styled():
        figure = Figure(**{**SIZE, "figsize": (10.0, 8.6)})
        (wave, speed), (far, lag) = figure.subplots(2, 2)
        snakes = [train for train in findings.numbers["trains"] if train["preset"] == "snake2019"]
        _draw_wave(wave, rows, snakes[0])
        _draw_speed(speed, findings.numbers["bent_rad_peak_late_rad_s"])
        _draw_joints(far, lag, snakes)
        style: Any = {"loc": "outside lower center", "ncols": 4, "fontsize": 11}
        figure.legend(*far.get_legend_handles_labels(), **style)
        figure.suptitle(
            "A fast train wiggles: a wave that travels from its head to its tail (snake2019)",
            fontsize=15,
        )
    return figure


def _draw_wave(axes: Axes, rows: list[Row], train: dict[str, Any]) -> None:
    for joint in range(4):
        own = [
            row
            for row in rows
            if row.get("joint") == joint + 1 and "deg" in row and row["drag"] == TRAINS[0]["drag"]
        ]
        begin = own[0]["t_s"]
        axes.plot(
            [row["t_s"] - begin for row in own],
            [row["deg"] for row in own],
            color=COLOURS[joint],
            label=f"{joint + 1}",
        )
    hz = "" if train["hz"] is None else f", {train['hz']:.2f} Hz"
    axes.set_title(
        f"drag {train['drag']:g} N s/rad{hz} (theirs {AUTHORS[train['drag']]['hz']:.2f} Hz)",
        fontsize=12,
    )
    axes.set(xlabel="time (s)", ylabel="yaw of the joint (°)")
    axes.set_ylim(top=axes.get_ylim()[1] * 1.45)
    axes.margins(x=0)
    axes.legend(
        title="joint, from the head", ncols=4, loc="upper center", fontsize=11, title_fontsize=11
    )


def _draw_speed(axes: Axes, bents: list[list[float]]) -> None:
    for column, name, colour, mark in (
        (1, "highest", COLOURS[1], "o"),
        (2, "late", COLOURS[0], "s"),
    ):
        theirs = AUTHORS[0.002]["peak_rad_s" if column == 1 else "late_rad_s"]
        axes.plot(
            [max(bent[0], 1e-8) for bent in bents],
            [bent[column] for bent in bents],
            marker=mark,
            color=colour,
            label=name,
        )
        axes.axhline(theirs, color=colour, linestyle=":", label=f"{name}, authors' program")
    axes.set_xscale("log")
    axes.set_xticks([1e-8, 1e-6, 1e-4, 1e-2], ["0", r"$10^{-6}$", r"$10^{-4}$", r"$10^{-2}$"])
    axes.set(
        xlabel="bend of the joints at the start (rad)",
        ylabel="speed of the wheels (rad/s)",
        ylim=(0, None),
    )
    axes.set_title("drag 0.002 N s/rad", fontsize=12)
    axes.legend(fontsize=11, loc="lower left")


def _draw_joints(far: Axes, lag: Axes, snakes: list[dict[str, Any]]) -> None:
    for number, train in enumerate(snakes):
        style: dict[str, Any] = {"marker": _MARKS[number], "color": COLOURS[number]}
        joints = range(1, 1 + len(train["std_deg"]))
        far.plot(joints, train["std_deg"], label=f"drag {train['drag']:g} N s/rad", **style)
        far.plot(joints, train["authors"]["std_deg"], linestyle=":", fillstyle="none", **style)
        if train["hz"] is not None:
            lag.plot(
                range(2, 1 + len(joints)),
                train["lag_deg"],
                label=f"{train['hz']:.2f} Hz (theirs {train['authors']['hz']:.2f})",
                **style,
            )
    far.plot(
        [],
        [],
        marker="o",
        color="grey",
        linestyle=":",
        fillstyle="none",
        label="authors' program (open)",
    )
    far.set(
        xlabel="joint, from the head",
        ylabel="yaw, standard deviation (°)",
        ylim=(0, None),
        xticks=range(1, 5),
    )
    lag.axhspan(*AUTHORS_LAG_DEG, color="lightgrey", zorder=0, label="authors' program")
    lag.set(
        xlabel="joint, from the head",
        ylabel="phase, less the joint's before (°)",
        ylim=(-200, 20),
        xticks=range(2, 5),
    )
    lag.legend(fontsize=11, loc="upper right")
