"""The study `lyapunov`: exponents, the route to chaos along k, and how long chaos lasts (M8).

The whole spectrum is measured at (k, tau). Along k and over the plane (k, tau), wheels from random
states and wheels that roll are assigned to attractors, each with its largest exponent. Along k,
the multipliers of the rotation show where rolling ends, and the lives of chaotic transients show
where chaos begins.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np

from host.errors import WrongUse
from host.runs.contract import Setting
from host.theory.engine.ensemble import rate_per_s
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_report import LONGEST_S, report
from host.theory.studies.lyapunov_rows import GridCell, GridPoint, LyapunovCell, Measured

__all__ = ["cells", "report", "simulate"]

# Values of k on the line, wheels of either start at each, and values in a cell.
LINE_KS, LINE_WHEELS, LINE_BAND = 160, 8, 16
# Values of k, and of tau, in the plane; values of tau in a cell.
PLANE, PLANE_BAND = 60, 4
# The axes end here, or at BEYOND times the study's own point.
MOST_K, MOST_TAU_S, BEYOND = 20.0, 1.5, 1.25
# Where lives are measured, relative to the least k with chaos.
LIVES_AT = (-0.1, -0.07, -0.045, -0.025, -0.01, 0.0, 0.005, 0.01, 0.015, 0.02)
# A wheel that changes faster (1/s) takes more than an hour.
FASTEST = 5000.0


def k_axis(options: dict[str, Any], points: int) -> Array:
    """The midpoints of `points` equal intervals from 0 to the greatest k, (points,)."""
    return np.asarray((np.arange(points) + 0.5) * max(MOST_K, BEYOND * options["k"]) / points)


def tau_axis(options: dict[str, Any]) -> Array:
    """The same for the plane's tau, s, (PLANE,)."""
    return np.asarray((np.arange(PLANE) + 0.5) * max(MOST_TAU_S, BEYOND * options["tau"]) / PLANE)


def cells(options: dict[str, Any], *, batch: bool = True) -> list[LyapunovCell]:
    """All pieces. Raises WrongUse if wheels are too fast to be followed for long."""
    wheel = wheel_of(options)
    extremes = [
        wheel._replace(k=k, tau_s=tau)
        for k in k_axis(options, LINE_KS)[[-1]]
        for tau in (options["tau"], tau_axis(options)[0])
    ]
    fastest = max(float(rate_per_s(own.columns(1))[0]) for own in extremes)
    if not fastest <= FASTEST:
        why = (
            f"a wheel with these constants, and k up to {extremes[0].k:g}, changes within"
            f" {1 / fastest:.1g} s: minutes of it take too long"
        )
        raise WrongUse(why, "choose a larger tau, I or f, or a smaller k")
    batches = ceil(options["seconds"] / LONGEST_S)
    seconds = options["seconds"] / batches
    found: list[LyapunovCell] = [{"part": "series"}]
    found += [{"part": "plane", "first": first} for first in range(0, PLANE, PLANE_BAND)]
    found += [{"part": "line", "first": first} for first in range(0, LINE_KS, LINE_BAND)]
    found += [{"part": "rolling"}, {"part": "check"}]
    found += [{"part": "lives", "offset": offset} for offset in LIVES_AT]
    found += [{"part": "point", "batch": batch, "seconds": seconds} for batch in range(batches)]
    return found


def simulate(cell: LyapunovCell, setting: Setting) -> Measured:
    """One of the pieces."""
    options, rng = setting.options, np.random.default_rng(setting.seed_of(cell))
    wheel = wheel_of(options)
    match cell["part"]:
        case "point":
            return pieces.spectrum_in_blocks(wheel, cell["seconds"], rng)
        case "series":
            return pieces.series(wheel, rng)
        case "rolling":
            return pieces.rolling(wheel, float(k_axis(options, LINE_KS)[-1]), rng)
        case "lives":
            most_k = float(k_axis(options, LINE_KS)[-1])
            return pieces.lives_near_chaos(wheel, cell["offset"], most_k, rng)
        case "check":
            return pieces.step_check(wheel, k_axis(options, PLANE), tau_axis(options), rng)
        case _:
            return _grid(cell, options, wheel, rng)


def _grid(
    cell: GridCell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[GridPoint]:
    """A band of the line or of the plane."""
    first = cell["first"]
    if cell["part"] == "line":
        ks = k_axis(options, LINE_KS)[first : first + LINE_BAND]
        return pieces.from_both_starts(wheel.columns(len(ks), k=ks), LINE_WHEELS, rng)
    ks, taus = k_axis(options, PLANE), tau_axis(options)[first : first + PLANE_BAND]
    parameters = wheel.columns(
        len(ks) * len(taus), k=np.tile(ks, len(taus)), tau_s=np.repeat(taus, len(ks))
    )
    return pieces.from_both_starts(parameters, 1, rng)
