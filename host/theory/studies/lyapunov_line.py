"""The study `lyapunov-line`: the route to chaos along k.

Wheels from random states and wheels that roll are assigned to attractors, each with its largest
exponent. The multipliers of the rotation show where rolling ends, and the lives of chaotic
transients show where chaos begins.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from host.runs.answers import Answer
from host.runs.contract import Findings, Part, Row, Setting, as_rows
from host.theory.analysis.transients import crisis, least_chaotic_k, sample
from host.theory.model.wheel import Array, wheel_of
from host.theory.studies import lyapunov_pieces as pieces
from host.theory.studies.lyapunov_numbers import LineNumbers
from host.theory.studies.lyapunov_rows import (
    LineCell,
    LineRow,
    line_of,
    lives_of,
    rolling_end_of,
)
from host.theory.studies.route_to_chaos import (
    along,
    crisis_numbers,
    lives_numbers,
    rolling_end_numbers,
    route,
)
from host.theory.studies.variants import require_two_rods
from host.util.intervals import standard_error

# Values of k, wheels of either start at each, and values in a cell.
KS, WHEELS, BAND = 160, 8, 16
# Where lives are measured, relative to the least k with chaos.
LIVES_AT = (-0.1, -0.07, -0.045, -0.025, -0.01, 0.0, 0.005, 0.01, 0.015, 0.02)


def cells(options: dict[str, Any], *, batch: bool = True) -> list[LineCell]:
    """The rotation, bands of k, and lives. Raises WrongUse if wheels are too fast for long."""
    require_two_rods(options)
    pieces.require_slow(wheel_of(options)._replace(k=options["k_to"]))
    found: list[LineCell] = [{"part": "rolling"}]
    found += [{"part": "line", "first": first} for first in range(0, KS, BAND)]
    found += [{"part": "lives", "offset": offset} for offset in LIVES_AT]
    return found


def simulate(cell: LineCell, setting: Setting) -> list[Row]:
    """One of the pieces."""
    return [row for part in parts(cell, setting, None) for row in part.rows]


def parts(cell: LineCell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """One of the pieces. Where lives are measured depends on a long search, which is a part."""
    options, rng = setting.options, np.random.default_rng(setting.seed_of(cell))
    wheel, most_k = wheel_of(options), options["k_to"]
    if cell["part"] == "rolling":
        yield Part(as_rows(pieces.rolling(wheel, most_k, rng)))
    elif cell["part"] == "lives":
        least = begun.state if begun else least_chaotic_k(wheel, most_k, pieces.FINENESS)
        if begun is None:
            yield Part([], least, 0.5)
        yield Part(as_rows(pieces.lives_near_chaos(wheel, cell["offset"], least, rng)))
    else:
        ks: Array = pieces.midpoints(most_k, KS)[cell["first"] : cell["first"] + BAND]
        yield Part(as_rows(pieces.from_both_starts(wheel.columns(len(ks), k=ks), WHEELS, rng)))


def report(rows: list[LineRow], setting: Setting) -> Findings:
    """The route to chaos at this tau. The paper claims nothing about it in numbers."""
    rolls = rolling_end_numbers(rolling_end_of(rows))
    samples = [
        sample(k, np.array([row["life_s"] for row in own]), np.array([row["ended"] for row in own]))
        for k, own in lives_of(rows).items()
    ]
    found = crisis(samples)
    through_a_crisis, words = route(found, samples, rolls, pieces.LIVES_S)
    numbers: LineNumbers = {
        "tau": setting.options["tau"],
        "line": along(line_of(rows)),
        "rolling_ends": rolls,
        "crisis": None if found is None else crisis_numbers(found),
        "through_a_crisis": through_a_crisis,
        "lives": [lives_numbers(one) for one in samples],
        "in_words": words,
    }
    seen = numbers["line"]
    answers = [
        Answer("chaos was seen for k from", _range(seen["chaos_seen_k"])),
        Answer("chaos beside rolling for k from", _range(seen["chaos_and_rolling_seen_k"])),
        Answer("rolling is stable up to k", rolls and rolls["k"]),
        Answer("it ends in a", rolls and rolls["type"]),
        Answer("a little above, wheels are", rolls and rolls["above"]),
    ]
    if found:
        answers += [
            Answer("chaos lasts above k (crisis)", found.k, standard_error(found.k_interval)),
            Answer("power of the mean life", found.power, standard_error(found.power_interval)),
        ]
    return Findings([], numbers, answers=answers)


def _range(ends: list[float] | None) -> str | None:
    """The ends of a range of k in words; None if there is none."""
    return f"{ends[0]:.6g} to {ends[1]:.6g}" if ends else None
