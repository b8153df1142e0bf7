"""The robot that was measured against the model that was fitted to it.

Speeds, angles that are left over, and the table of constants.
"""

from __future__ import annotations

from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from host.experiments.robot.calibrate import BASE, CHECK, STEPS, drive_of, kinds
from host.experiments.robot.identification import Drive, Traits, constants_of, follow
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings, Row
from robot.kicks import WHEELS
from sim_motor.motor import Array, load

_STRETCHES = 4
_SIZES = (6.0, 3.0)  # of marks, so that both wheels show where they agree
_REACH = 2  # a speed is measured over so many ticks before and after
_LABELS = {
    "speed_per_v": ("no-load speed for each volt", "rad/s/V", 1.0),
    "time_constant_s": ("mechanical time constant", "ms", 1000.0),
    "viscous_part": ("viscous part of the damping", "%", 100.0),
    "static_pct": ("static friction", "% duty", 1.0),
    "kinetic_pct": ("kinetic friction", "% duty", 1.0),
    "sag": ("sag: resistance at full duty", "+ %", 100.0),
    "delay_ms": ("delay: latency and coil", "ms", 1.0),
    "backlash_deg": ("backlash", "deg", 1.0),
}


def draw(rows: list[Row], findings: Findings) -> Figure:
    """The figure of the experiment's rows."""
    kind = kinds(rows)
    drives = {side: drive_of(rows, side) for side in WHEELS}
    models = {side: follow(drive, _constants(findings, side)) for side, drive in drives.items()}
    numbers = drives[WHEELS[0]].stretches
    last_steps = np.unique(numbers[kind == STEPS])[-_STRETCHES:]
    columns = (
        ("fitted: pushes forth and back", np.isin(numbers, last_steps)),
        ("predicted: as in the paper, with a kick", kind == CHECK),
    )
    with styled():
        figure = Figure(**SIZE)
        places = figure.subplot_mosaic(
            [["speeds 0", "speeds 1"], ["errors 0", "errors 1"], ["table", "table"]],
            height_ratios=(4, 2, 4),
        )
        for row, label in (("speeds", "speed (rad/s)"), ("errors", "model less\nrobot (°)")):
            places[row + " 0"].set_ylabel(label)
            places[row + " 1"].sharey(places[row + " 0"])
        places["errors 0"].set_title("grey: one count of the encoder", fontsize=11, loc="right")
        for column, (title, chosen) in enumerate(columns):
            speeds, errors = places[f"speeds {column}"], places[f"errors {column}"]
            _draw_speeds(speeds, drives, models, chosen)
            _draw_errors(errors, drives, models, chosen)
            speeds.set_title(title, fontsize=13)
            errors.set_xlabel("time (s)")
            errors.sharex(speeds)
            speeds.tick_params(labelbottom=False)
        places["speeds 1"].legend(loc="center right", fontsize=11)
        _draw_table(places["table"], findings)
        figure.suptitle("This robot and the model that was fitted to it", fontsize=16)
    return figure


def _constants(findings: Findings, side: str) -> Any:
    return constants_of(
        Traits(**findings.numbers["traits"][side]), load(BASE), findings.numbers["battery_v"]
    )


def _speed(angles: Array, times: Array) -> Array:
    return np.asarray(
        (angles[2 * _REACH :] - angles[: -2 * _REACH])
        / (times[2 * _REACH :] - times[: -2 * _REACH])
    )


def _pieces(drive: Drive, chosen: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """The rows of each run of chosen ticks."""
    rows = np.flatnonzero(chosen)
    return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)


def _draw_speeds(
    axes: Axes, drives: dict[str, Drive], models: dict[str, Array], chosen: NDArray[np.bool_]
) -> None:
    for index, side in enumerate(WHEELS):
        drive = drives[side]
        for number, piece in enumerate(_pieces(drive, chosen)):
            when = drive.times[piece][_REACH:-_REACH]
            label: Any = {} if number else {"label": f"{side}: robot"}
            measured = _speed(drive.angles[piece], drive.times[piece])
            axes.plot(
                when,
                measured,
                "o",
                color=COLOURS[index],
                markersize=_SIZES[index],
                alpha=0.6,
                markeredgewidth=0,
                **label,
            )
            label = {} if number else {"label": f"{side}: model"}
            axes.plot(
                when,
                _speed(models[side][piece], drive.times[piece]),
                color=COLOURS[index],
                linewidth=1.3,
                **label,
            )


def _draw_errors(
    axes: Axes, drives: dict[str, Drive], models: dict[str, Array], chosen: NDArray[np.bool_]
) -> None:
    axes.axhspan(-0.5, 0.5, color="lightgrey", alpha=0.7, linewidth=0)
    for index, side in enumerate(WHEELS):
        drive = drives[side]
        for piece in _pieces(drive, chosen):
            axes.plot(
                drive.times[piece],
                np.degrees(models[side] - drive.angles)[piece],
                color=COLOURS[index],
                linewidth=1.0,
            )


def _draw_table(axes: Axes, findings: Findings) -> None:
    axes.set_axis_off()
    cells = []
    for name, (label, unit, factor) in _LABELS.items():
        cells.append([label, unit, *(_value(findings, side, name, factor) for side in WHEELS)])
    titles = ["constant (95 % interval)", "unit", *WHEELS]
    table = axes.table(
        cells,
        colLabels=titles,
        cellLoc="left",
        colLoc="left",
        colWidths=(0.34, 0.1, 0.28, 0.28),
        bbox=Bbox.from_bounds(0, -0.05, 1, 1.05),
    )
    table.auto_set_font_size(False)
    table.set_fontsize(11)
    for (row, _), cell in table.get_celld().items():
        cell.set_edgecolor("lightgrey")
        cell.visible_edges = "B"
        if row == 0:
            cell.set_text_props(weight="bold")


def _value(findings: Findings, side: str, name: str, factor: float) -> str:
    """To as many decimals as the intervals are worth."""
    value = findings.numbers["traits"][side][name] * factor
    low, high = (bound * factor for bound in findings.numbers["intervals"][side][name])
    widest = (
        max(
            end - begin
            for begin, end in (each[name] for each in findings.numbers["intervals"].values())
        )
        * factor
    )
    decimals = max(0, 1 - floor(log10(widest)))
    return f"{value:.{decimals}f}  ({low:.{decimals}f} to {high:.{decimals}f})"
