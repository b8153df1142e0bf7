"""Left, the mean time until an escape over 1 / D^2, with Arrhenius's law.

Right, the share of wheels that have not yet escaped, which at a constant rate is exponential.
"""

from __future__ import annotations

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from host.figures.style import SIZE, styled
from host.runs.contract import Findings
from host.theory.studies.escape import Numbers, strength_of
from host.theory.studies.escape_rows import EscapeRow, by_level

PANELS = ("times", "shares")

_FROM = {"rest": "from the well", "roll": "from rolling"}


def draw(rows: list[EscapeRow], findings: Findings) -> Figure:
    """The figure of the study's rows."""
    numbers: Numbers = findings.numbers
    found, law = numbers["levels"], numbers["arrhenius"]
    shades = colormaps["viridis"](np.linspace(0.0, 0.85, len(found)))
    letter = r"D_M" if found[0]["noise"] else r"D_\varphi"
    with styled():
        figure = Figure(**SIZE)
        means, shares = figure.subplots(1, 2)
        for number, (row, own) in enumerate(zip(found, by_level(rows), strict=True)):
            colour, inverse = tuple(shades[number]), 1.0 / strength_of(row) ** 2
            if row["mean_s"] is None:
                means.plot(inverse, row["low_s"], "^", color=colour, markersize=9)
            else:
                bars = [[row["mean_s"] - row["low_s"]], [(row["high_s"] or 0.0) - row["mean_s"]]]
                means.errorbar(inverse, row["mean_s"], bars, fmt="o", color=colour, capsize=4)
                times = np.sort([one["time_s"] for one in own if one["ended"]]) / row["mean_s"]
                left = 1.0 - np.arange(len(times) + 1) / len(own)
                label = f"${letter}$ = {strength_of(row):.3g}"
                shares.step([0.0, *times], left, where="post", color=colour, label=label)
        if law is not None:
            ends = np.array([1.0 / strength_of(row) ** 2 for row in (found[0], found[-1])])
            line = law["prefactor_s"] * np.exp(law["barrier"] * ends)
            means.plot(ends, line, color="dimgrey", zorder=0, label="$T_0$ exp($B$ / $D^2$)")
            means.legend(loc="upper left")
        means.set_yscale("log")
        unit_of = "1/s" if found[0]["noise"] else r"s/rad$^2$"
        means.set(xlabel=f"$1/{letter}^2$ ({unit_of})", ylabel="mean time until an escape (s)")
        unit = np.array([0.0, np.log(found[0]["wheels"])])
        shares.plot(unit, np.exp(-unit), "--", color="dimgrey", label="at a constant rate")
        shares.set_yscale("log")
        shares.set(xlabel="time / mean time", ylabel="share of wheels that have not escaped")
        shares.set_ylim(bottom=0.7 / found[0]["wheels"])
        shares.legend(fontsize=12)
        start = _FROM[numbers["start"]]
        figure.suptitle(f"How long noise takes to drive a wheel {start}", fontsize=16)
    return figure
