"""The measured robot beside the model that was fitted to it: speeds, errors, and the traits."""

from __future__ import annotations

from math import floor, log10
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from numpy.typing import NDArray

from host.experiments.robot.calibrate import Numbers
from host.experiments.robot.calibrate_rows import CHECK, STEPS, Row, base, drive_of, kinds
from host.experiments.robot.identification import Drive, follow
from host.experiments.robot.motor_traits import Traits, constants_of
from host.figures.style import COLOURS, SIZE, styled
from host.runs.contract import Findings
from robot.kicks import WHEELS
from sim_motor.arrays import Array
from sim_motor.constants import Constants, load

PANELS = ("speeds-1", "speeds-2", "errors-1", "errors-2")
_STRETCHES = 4
_SIZES = (6.0, 3.0)  # of marks, so that both wheels show where they agree
_MOST_DECIMALS = 3
_REACH = 2  # a speed is measured from this many ticks before to as many after
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
    """Draw the rows."""
    numbers: Numbers = findings.numbers
    kind = kinds(rows)
    drives = {side: drive_of(rows, side) for side in WHEELS}
    published = load(base(rows))
    models = {
        side: follow(drive, _constants(numbers, side, published)) for side, drive in drives.items()
    }
    stretches = drives[WHEELS[0]].stretches
    last_steps = np.unique(stretches[kind == STEPS])[-_STRETCHES:]
    columns = (
        ("fitted: pushes forth and back", np.isin(stretches, last_steps)),
        ("predicted: as in the paper, with a kick", kind == CHECK),
    )
    with styled():
        figure = Figure(**SIZE)
        places = figure.subplot_mosaic(
            [["speeds-1", "speeds-2"], ["errors-1", "errors-2"], ["table", "table"]],
            height_ratios=(4, 2, 4),
        )
        for row, label in (("speeds", "speed (rad/s)"), ("errors", "model less\nrobot (°)")):
            places[row + "-1"].set_ylabel(label)
            places[row + "-2"].sharey(places[row + "-1"])
        places["errors-1"].set_title("grey: one count of the encoder", fontsize=11, loc="right")
        for column, (title, chosen) in enumerate(columns, start=1):
            speeds, errors = places[f"speeds-{column}"], places[f"errors-{column}"]
            _draw_speeds(speeds, drives, models, chosen)
            _draw_errors(errors, drives, models, chosen)
            speeds.set_title(title, fontsize=13)
            errors.set_xlabel("time (s)")
            errors.sharex(speeds)
            speeds.tick_params(labelbottom=False)
        places["speeds-2"].legend(loc="center right", fontsize=11)
        _draw_table(places["table"], numbers)
        figure.suptitle("This robot and the model that was fitted to it", fontsize=16)
    return figure


def _constants(numbers: Numbers, side: str, published: Constants) -> Constants:
    return constants_of(Traits(**numbers["traits"][side]), published, numbers["battery_v"])


def _speed(angles: Array, times: Array) -> Array:
    """Speeds (rad/s) from angles (rad) at times (s), _REACH ticks shorter at either end."""
    travel = angles[2 * _REACH :] - angles[: -2 * _REACH]
    return np.asarray(travel / (times[2 * _REACH :] - times[: -2 * _REACH]))


def _pieces(drive: Drive, chosen: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """The rows of each run of successive chosen ticks."""
    rows = np.flatnonzero(chosen)
    return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)


def _draw_speeds(
    axes: Axes, drives: dict[str, Drive], models: dict[str, Array], chosen: NDArray[np.bool_]
) -> None:
    for side, colour, size in zip(WHEELS, COLOURS, _SIZES, strict=False):
        drive = drives[side]
        dots: Any = {"color": colour, "markersize": size, "alpha": 0.6, "markeredgewidth": 0}
        for number, piece in enumerate(_pieces(drive, chosen)):
            times = drive.times[piece]
            when = times[_REACH:-_REACH]
            robot, model = (f"{side}: robot", f"{side}: model") if number == 0 else (None, None)
            axes.plot(when, _speed(drive.angles[piece], times), "o", label=robot, **dots)
            speeds = _speed(models[side][piece], times)
            axes.plot(when, speeds, color=colour, linewidth=1.3, label=model)


def _draw_errors(
    axes: Axes, drives: dict[str, Drive], models: dict[str, Array], chosen: NDArray[np.bool_]
) -> None:
    axes.axhspan(-0.5, 0.5, color="lightgrey", alpha=0.7, linewidth=0)
    for side, colour, line in zip(WHEELS, COLOURS, ("-", "--"), strict=False):
        drive = drives[side]
        errors = np.degrees(models[side] - drive.angles)
        for piece in _pieces(drive, chosen):
            axes.plot(drive.times[piece], errors[piece], line, color=colour, linewidth=1.0)


def _draw_table(axes: Axes, numbers: Numbers) -> None:
    axes.set_axis_off()
    cells = []
    for name, (label, unit, factor) in _LABELS.items():
        cells.append([label, unit, *(_value(numbers, side, name, factor) for side in WHEELS)])
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


def _value(numbers: Numbers, side: str, name: str, factor: float) -> str:
    """A trait and its interval, with as many decimals as the wider interval supports."""
    value = numbers["traits"][side][name] * factor
    low, high = (bound * factor for bound in numbers["intervals"][side][name])
    widest = max(own[name][1] - own[name][0] for own in numbers["intervals"].values()) * factor
    # An interval at the bound of what is possible, as for a motor without latency, has no width.
    decimals = max(0, 1 - floor(log10(widest))) if widest > 0.0 else _MOST_DECIMALS
    return f"{value:.{decimals}f}  ({low:.{decimals}f} to {high:.{decimals}f})"
