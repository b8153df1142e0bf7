"""The table of the experiment `kick-map`: its cells, its rows, and what is counted in them."""

from __future__ import annotations

from typing import NotRequired

import numpy as np
from numpy.typing import NDArray

from host.kicking import kick_map
from host.kicking.kick_map import LENGTHS, PHASE_BINS, KickCell


class ChunkCell(KickCell):
    """Many simulated kicks of one kind and length.

    Attributes:
        chunk: number of the chunk, from 0.
        kicks: how many kicks.
    """

    chunk: int
    kicks: int


class TrialCell(KickCell):
    """One kick of a robot.

    Attributes:
        trial: number of the round, from 0.
    """

    trial: int


Cell = ChunkCell | TrialCell


class Row(kick_map.Row):
    """A row of the map: a kick, and what it did.

    Attributes:
        chunk: number of the chunk of simulated kicks, from 0; none on a robot.
        kicks: how many kicks the chunk has; none on a robot.
        trial: number of the round on a robot, from 0; none in a simulation.
    """

    chunk: NotRequired[int]
    kicks: NotRequired[int]
    trial: NotRequired[int]


def of_kind(rows: list[Row], mode: str, sign: int, before: int) -> list[Row]:
    """The rows of a kind of kick on wheels of a direction."""
    kicks = [row for row in rows if row["mode"] == mode and row["sign"] == sign]
    return [row for row in kicks if row["before"] == before]


def counts(rows: list[Row]) -> NDArray[np.float64]:
    """Reversals and trials, (2, LENGTHS, PHASE_BINS)."""
    totals = np.zeros((2, len(LENGTHS), PHASE_BINS))
    for row in rows:
        totals[:, LENGTHS.index(row["ticks"]), row["phase"]] += row["reversed"], row["tried"]
    return totals


def share(totals: NDArray[np.float64]) -> NDArray[np.float64]:
    """The rates of these counts; NaN where nothing was tried."""
    done, tried = totals
    rates: NDArray[np.float64] = np.divide(
        done, tried, out=np.full_like(done, np.nan), where=tried > 0
    )
    return rates
