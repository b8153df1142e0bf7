"""The study `lyapunov`: the four exponents of a wheel, with errors and a verdict (M8)."""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np

from host.runs.contract import Setting
from host.theory.model.wheel import wheel_of
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_report import report
from host.theory.studies.lyapunov_rows import Block, LyapunovCell, SeriesSample

__all__ = ["cells", "report", "simulate"]

# A wheel is followed for at most this long (s): longer runs take more wheels.
LONGEST_S = 250.0
# A piece follows pieces.WHEELS wheels.
PIECES = 2


def cells(options: dict[str, Any], *, batch: bool = True) -> list[LyapunovCell]:
    """Batches of wheels, and a time series. Raises WrongUse if wheels are too fast for long."""
    pieces.require_slow(wheel_of(options))
    longer = ceil(options["seconds"] / LONGEST_S)
    seconds = options["seconds"] / longer
    found: list[LyapunovCell] = [
        {"part": "point", "batch": number, "seconds": seconds} for number in range(PIECES * longer)
    ]
    return [*found, {"part": "series"}]


def simulate(cell: LyapunovCell, setting: Setting) -> list[Block] | list[SeriesSample]:
    """The exponents of a batch, or the series."""
    wheel, rng = wheel_of(setting.options), np.random.default_rng(setting.seed_of(cell))
    if cell["part"] == "series":
        return pieces.series(wheel, rng)
    return pieces.spectrum_in_blocks(wheel, cell["seconds"], rng)
