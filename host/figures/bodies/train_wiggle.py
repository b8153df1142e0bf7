"""A train that wiggles: the wave along its joints beside the authors' program, and its speed."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from host.experiments.bodies.train_wiggle import (
    AUTHORS,
    AUTHORS_LAG_DEG,
    JOINTS,
    JointAngleRow,
    Numbers,
    Row,
    TrainNumbers,
    joint_angles,
)
from host.figures.style import COLOURS, SIZE, share_legend, styled
from host.runs.contract import Findings

PANELS = ("wave", "speed", "amplitudes", "lags")
_MARKS = "os^"
# Of the joints, which can be told apart in grey, too.
_LINES = ("-", "--", "-.", ":")


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    numbers: Numbers = findings.numbers
    with styled():
        figure = Figure(**SIZE)
        (wave, speed), (far, lag) = figure.subplots(2, 2)
        snakes = [train for train in numbers["trains"] if train["preset"] == "snake2019"]
        first = snakes[0]
        _draw_wave(wave, [row for row in joint_angles(rows) if row["drag"] == first["drag"]], first)
        _draw_speed(speed, numbers["bent_rad_peak_late_rad_s"])
        for number, train in enumerate(snakes):
            style: dict[str, Any] = {"marker": _MARKS[number], "color": COLOURS[number]}
            _draw_amplitudes(far, train, style)
            _draw_lags(lag, train, style)
        _finish_amplitudes(far)
        _finish_lags(lag)
        share_legend(figure, [far], loc="outside lower center", ncols=4, fontsize=11)
        figure.suptitle(
            "A fast train wiggles: a wave that travels from its head to its tail (snake2019)",
            fontsize=15,
        )
    return figure


def _draw_wave(axes: Axes, angles: list[JointAngleRow], train: TrainNumbers) -> None:
    for joint in range(1, 1 + JOINTS):
        own = [row for row in angles if row["joint"] == joint]
        t_s = [row["t_s"] - own[0]["t_s"] for row in own]
        axes.plot(
            t_s,
            [row["deg"] for row in own],
            color=COLOURS[joint - 1],
            linestyle=_LINES[joint - 1],
            label=f"{joint}",
        )
    hz = "" if train["hz"] is None else f", {train['hz']:.2f} Hz"
    theirs = AUTHORS[train["drag"]]["hz"]
    axes.set_title(f"drag {train['drag']:g} N s/rad{hz} (theirs {theirs:.2f} Hz)", fontsize=12)
    axes.set(xlabel="time (s)", ylabel="yaw of the joint (°)")
    axes.set_ylim(top=axes.get_ylim()[1] * 1.45)
    axes.margins(x=0)
    axes.legend(
        title="joint, from the head", ncols=4, loc="upper center", fontsize=11, title_fontsize=11
    )


def _draw_speed(axes: Axes, trains: list[list[float]]) -> None:
    """Draw the speeds of trains, each (bend in rad, highest and late speed in rad/s)."""
    bends = [max(bend, 1e-8) for bend, _, _ in trains]
    for name, speeds, theirs, colour, mark in (
        ("highest", [peak for _, peak, _ in trains], AUTHORS[0.002]["peak_rad_s"], COLOURS[1], "o"),
        ("late", [late for _, _, late in trains], AUTHORS[0.002]["late_rad_s"], COLOURS[0], "s"),
    ):
        axes.plot(bends, speeds, marker=mark, color=colour, label=name)
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


def _draw_amplitudes(axes: Axes, train: TrainNumbers, style: dict[str, Any]) -> None:
    joints = range(1, 1 + JOINTS)
    axes.plot(joints, train["std_deg"], label=f"drag {train['drag']:g} N s/rad", **style)
    theirs = AUTHORS[train["drag"]]["std_deg"]
    axes.plot(joints, theirs, linestyle=":", fillstyle="none", **style)


def _finish_amplitudes(axes: Axes) -> None:
    theirs: Any = {"marker": "o", "color": "grey", "linestyle": ":", "fillstyle": "none"}
    axes.plot([], [], **theirs, label="authors' program (open)")
    axes.set(
        xlabel="joint, from the head",
        ylabel="yaw, standard deviation (°)",
        ylim=(0, None),
        xticks=range(1, 1 + JOINTS),
    )


def _draw_lags(axes: Axes, train: TrainNumbers, style: dict[str, Any]) -> None:
    lags = [lag for lag in train["lag_deg"] if lag is not None]
    if train["hz"] is not None:
        label = f"{train['hz']:.2f} Hz (theirs {AUTHORS[train['drag']]['hz']:.2f})"
        axes.plot(range(2, 1 + JOINTS), lags, label=label, **style)


def _finish_lags(axes: Axes) -> None:
    axes.axhspan(*AUTHORS_LAG_DEG, color="lightgrey", zorder=0, label="authors' program")
    axes.set(
        xlabel="joint, from the head",
        ylabel="phase shift per joint (°)",
        ylim=(-200, 20),
        xticks=range(2, 1 + JOINTS),
    )
    axes.legend(fontsize=11, loc="upper right")
