"""The route to chaos along k.

What wheels settle on, where rolling loses its stability, and whether chaos ends in a crisis.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from host.theory.analysis.attractors import BACK, CHAOS, KINDS, ROLL, Kind
from host.theory.analysis.bifurcations import BifurcationType
from host.theory.analysis.transients import Crisis, Sample
from host.theory.studies.lyapunov_numbers import (
    AtK,
    CrisisNumbers,
    Line,
    Lives,
    Plane,
)
from host.theory.studies.lyapunov_rows import GridRow, RollingEnd, StartKind

_BIFURCATION: dict[BifurcationType, str] = {
    "neimark-sacker": "Neimark-Sacker point",
    "fold": "fold",
    "pitchfork": "pitchfork",
}
# Lives are taken for exponentially distributed unless their likeness is less.
LIKELY = 0.01


def along(rows: list[GridRow]) -> Line:
    """At each k, on which attractors wheels of either start ended, and the exponent of chaos.

    The exponent is the mean over the chaotic wheels, 1/s.
    """
    entries = [_at_k(k, rows) for k in dict.fromkeys(row["k"] for row in rows)]
    chaos = [entry["k"] for entry in entries if entry["chaotic_exponent"] is not None]
    both = [
        row["k"]
        for row in rows
        if row["kind"] == KINDS[ROLL] and any(abs(row["k"] - k) < 1e-12 for k in chaos)
    ]
    windows = [
        entry["k"]
        for entry in entries
        if chaos
        and entry["k"] > chaos[0]
        and any(KINDS[BACK] in counts for counts in entry["counts"].values())
    ]
    return {
        "chaos_seen_k": [min(chaos), max(chaos)] if chaos else None,
        "chaos_and_rolling_seen_k": [min(both), max(both)] if both else None,
        "regular_switching_k": windows,
        "at": entries,
    }


def _at_k(k: float, rows: list[GridRow]) -> AtK:
    own = [row for row in rows if row["k"] == k]
    chaotic = [row["exponent"] for row in own if row["kind"] == KINDS[CHAOS]]
    counts: dict[StartKind, dict[Kind, int]] = {}
    for start in dict.fromkeys(row["start"] for row in own):
        found = Counter(row["kind"] for row in own if row["start"] == start)
        counts[start] = {kind: found[kind] for kind in KINDS if kind in found}
    return {
        "k": k,
        "counts": counts,
        "chaotic_exponent": float(np.mean(chaotic)) if chaotic else None,
    }


def tally(rows: list[GridRow]) -> Plane:
    """Shares of the plane, by start and kind of attractor.

    start_decides: the share of points at which the two starts end on different kinds.
    """
    shares: dict[StartKind, dict[Kind, float]] = {}
    for start in dict.fromkeys(row["start"] for row in rows):
        own = [row["kind"] for row in rows if row["start"] == start]
        shares[start] = {kind: own.count(kind) / len(own) for kind in KINDS}
    ends: dict[tuple[float, float], set[Kind]] = {}
    for row in rows:
        ends.setdefault((row["tau"], row["k"]), set()).add(row["kind"])
    return {
        "shares": shares,
        "start_decides": float(np.mean([len(kinds) > 1 for kinds in ends.values()])),
    }


def rolling_end_numbers(row: RollingEnd | None) -> RollingEnd | None:
    """Where rolling loses its stability as k rises, without the part's name."""
    if row is None:
        return None
    return {
        "k": row["k"],
        "k_off_by": row["k_off_by"],
        "type": row["type"],
        "omega_mean": row["omega_mean"],
        "above": row["above"],
    }


def crisis_numbers(found: Crisis) -> CrisisNumbers:
    """A crisis as plain data."""
    return {
        "k": found.k,
        "k_interval": found.k_interval,
        "power": found.power,
        "power_interval": found.power_interval,
        "factor": found.factor,
        "misfit": found.misfit,
    }


def lives_numbers(one: Sample) -> Lives:
    """The lives at one k as plain data."""
    return {
        "k": one.k,
        "wheels": one.wheels,
        "ended": one.ended,
        "mean_s": one.mean_s,
        "likeness": one.likeness,
    }


def route(
    found: Crisis | None, samples: list[Sample], rolls: RollingEnd | None, most_s: float
) -> tuple[bool, str]:
    """Whether chaos begins through a crisis, as the phase diagram's caption says, and why.

    Args:
        found: The crisis, if one was found.
        samples: The lives of chaotic transients.
        rolls: Where rolling loses its stability; None if it does not.
        most_s: How long wheels were followed, s.

    Returns:
        Whether it does, and the route to chaos in words.
    """
    tested = [one.likeness for one in samples if one.likeness is not None]
    exponential = sum(likeness > LIKELY for likeness in tested)
    lives = f"lives are exponentially distributed at {exponential} of {len(tested)} k"
    words = ["no crisis was found on the way to it", lives]
    holds = False
    if found:
        above = [one for one in samples if one.k > found.k_interval[1]]
        left, watched = sum(one.ended for one in above), sum(one.wheels for one in above)
        holds = bool(watched and not left and exponential >= 0.8 * len(tested) > 0)
        perhaps = "" if holds else "perhaps "
        k, power = _range(found.k, found.k_interval), _range(found.power, found.power_interval)
        words = [
            f"going down in k it ends {perhaps}in a crisis at {k}",
            f"below, chaos is a transient with a mean life as (k_c - k)^-g, g = {power}",
            lives,
            f"above, {left} of {watched} wheels left it in {most_s:g} s",
        ]
    if rolls:
        words.append(
            f"going up in k, rolling stays stable as far as k = {rolls['k']:.8g}, a"
            f" {_BIFURCATION[rolls['type']]}; a little above, the wheel is {rolls['above']}"
        )
    return holds, "; ".join(words)


def _range(value: float, interval: tuple[float, float]) -> str:
    return f"{value:.2f} ({interval[0]:.2f} to {interval[1]:.2f})"
