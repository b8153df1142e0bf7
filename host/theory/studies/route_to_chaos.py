"""What the rows of host.theory.studies.lyapunov come to.

The spectrum at a point, and the route to chaos along k.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.errors import NotDone
from host.runs.claims import Claim
from host.runs.contract import Row
from host.theory.analysis.attractors import BACK, CHAOS, KINDS, REST, ROLL
from host.theory.analysis.series_exponents import from_series, of_noise
from host.theory.analysis.tangent import divergence, kaplan_yorke
from host.theory.analysis.transients import Crisis, Sample
from host.theory.model.wheel import Array, Wheel
from host.util.intervals import wilson

ORDERS = range(1, 5)
# A normal distribution's 95 % and 99.7 %.
SURE, VERY_SURE = 1.96, 3.0
# Exponents nearer to 0 than this (1/s) are taken for 0 where the kind of an attractor is held
# against its exponent.
NEAR_ZERO = 0.05
# A period of the motion, in the series.
APART_S = 2.0
# A rolling wheel has reached its cycle if its windows (see host.theory.analysis.attractors) agree
# so well.
REACHED = 1e-7
# So many of the slowest dampings make the curve that is followed to 0.
NEAREST = 12
LIKELY = 0.01


def column(rows: list[Row], name: str) -> Array:
    """One field of rows."""
    return np.array([row[name] for row in rows], dtype=float)


def spectrum(rows: list[Row], wheel: Wheel) -> dict[str, Any]:
    """Exponents (1/s) of each kind of attractor that wheels kept, with standard errors from blocks; on top, of the kind most are on.

    Raises NotDone if no wheel kept its attractor.
    """
    kinds = {
        kind: [row for row in rows if row["kind"] == row["kind_after"] == kind] for kind in KINDS
    }
    found = {kind: _of_kind(own, kind) for kind, own in kinds.items() if own}
    if not found:
        raise NotDone(
            "no wheel stayed on an attractor while its exponents were measured",
            "measure longer or shorter, with --seconds",
        )
    main = max(found, key=lambda kind: int(found[kind]["wheels"]))
    wheels = len({(row["batch"], row["wheel"]) for row in rows})
    own = found[main]
    error = float(np.hypot(own["standard_errors"][0], own["by_pairs_error"]))
    return {
        **own,
        "kind": main,
        "attractors": found,
        "of_wheels": wheels,
        "changed": wheels - sum(entry["wheels"] for entry in found.values()),
        "accuracy": {
            "sum_of_exponents_exact": divergence(wheel),
            "sum_of_exponents_off_by": abs(sum(own["exponents"]) - divergence(wheel)),
            "two_algorithms_differ_by": abs(own["exponents"][0] - own["by_pairs"]),
            "two_algorithms_standard_error": error,
            "zero_exponent_off_by": (
                None if main == KINDS[REST] else min(abs(exponent) for exponent in own["exponents"])
            ),
            "errors_by_wheels": own["errors_by_wheels"],
        },
    }


def _of_kind(rows: list[Row], kind: str) -> dict[str, Any]:
    """Means over blocks; the error of a mean also from whole wheels, of which each has a past of its own."""
    values = np.array([column(rows, f"exponent_{order}") for order in ORDERS])
    wheels = [(row["batch"], row["wheel"]) for row in rows]
    of_wheels = np.array(
        [
            values[:, [own == wheel for own in wheels]].mean(axis=1)
            for wheel in dict.fromkeys(wheels)
        ]
    ).T
    pairs = column(rows, "by_pairs")
    # In the time there was, two that are equal may have come out in the wrong order.
    values, of_wheels = (own[np.argsort(-values.mean(axis=1))] for own in (values, of_wheels))
    exponents, errors = values.mean(axis=1), _error(values)
    # The flow's own direction neither grows nor shrinks; an exponent of rest that is near 0 is not
    # 0 for that.
    least = 0.0 if kind == KINDS[REST] else float(max(NEAR_ZERO, VERY_SURE * errors.max()))
    return {
        "wheels": of_wheels.shape[1],
        "exponents": exponents.tolist(),
        "standard_errors": errors.tolist(),
        "errors_by_wheels": _error(of_wheels).tolist() if of_wheels.shape[1] > 1 else None,
        "dimension": kaplan_yorke(exponents, least),
        "by_pairs": float(pairs.mean()),
        "by_pairs_error": float(_error(pairs[None])[0]),
        "omega_mean_abs": float(np.abs(column(rows, "omega_mean")).mean()),
        "omega_std": float(column(rows, "omega_std").mean()),
    }


def _error(values: Array) -> Array:
    """Standard errors of the means of rows."""
    count = values.shape[1]
    return (
        np.asarray(values.std(axis=1, ddof=1) / np.sqrt(count))
        if count > 1
        else np.zeros(len(values))
    )


def of_series(rows: list[Row], step_s: float) -> dict[str, Any] | None:
    """The largest exponent from the force alone, by neighbours in delay coordinates.

    None of a wheel that does not move enough.
    """
    force = column(rows, "force")
    found = from_series(force, step_s, APART_S) if np.ptp(force) > 1e-6 else None
    if found is None:
        return None
    exponent, embedded = found
    return {
        "per_s": exponent.rate,
        "interval": exponent.interval,
        "lag_s": embedded.lag * step_s,
        "dimension": embedded.dimension,
        "of_noise": of_noise(),
    }


def along(rows: list[Row]) -> dict[str, Any]:
    """At each k: how many wheels of each start ended on which attractor, and the mean of the chaotic ones' exponents."""
    entries = []
    for k in dict.fromkeys(row["k"] for row in rows):
        own = [row for row in rows if row["k"] == k]
        chaotic = [row["exponent"] for row in own if row["kind"] == KINDS[CHAOS]]
        counts = {
            start: {
                kind: number
                for kind in KINDS
                if (number := sum(row["kind"] == kind for row in own if row["start"] == start))
            }
            for start in dict.fromkeys(row["start"] for row in own)
        }
        entries.append(
            {
                "k": k,
                "counts": counts,
                "chaotic_exponent": float(np.mean(chaotic)) if chaotic else None,
            }
        )
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


def tally(rows: list[Row]) -> dict[str, Any]:
    """Shares of the plane by start and kind, and of points at which the two starts end on different kinds."""
    shares: dict[str, Any] = {}
    for start in dict.fromkeys(row["start"] for row in rows):
        own = [row["kind"] for row in rows if row["start"] == start]
        shares[start] = {kind: own.count(kind) / len(own) for kind in KINDS}
    ends: dict[tuple[float, float], set[str]] = {}
    for row in rows:
        ends.setdefault((row["tau"], row["k"]), set()).add(row["kind"])
    return {
        "shares": shares,
        "start_decides": float(np.mean([len(kinds) > 1 for kinds in ends.values()])),
        **_disagreement(rows),
    }


def _disagreement(rows: list[Row]) -> dict[str, Any]:
    """How often kind, from averages, and exponent, from the Jacobian, say different things about chaos."""
    chaotic = np.array([row["kind"] == KINDS[CHAOS] for row in rows])
    exponents = column(rows, "exponent")
    return {
        "chaotic_without_exponent": int(np.sum(chaotic & (exponents < NEAR_ZERO))),
        "regular_with_exponent": int(np.sum(~chaotic & (exponents > NEAR_ZERO))),
        "of": len(rows),
    }


def rolling_end(rows: list[Row]) -> dict[str, Any] | None:
    """The k at which a rolling wheel's cycle loses its stability, where the damping of disturbances, followed from below, is 0.

    None if it does not along this line. leaves_by: the least k above at which a wheel that rolled
    was found on something else.
    """
    reached = sorted(
        (row for row in rows if row["kind"] == KINDS[ROLL] and row["apart"] < REACHED),
        key=lambda row: float(row["k"]),
    )
    near = [row for row in reached if row["k"] > reached[-1]["k"] * 0.9][-NEAREST:]
    left = [
        row
        for row in rows
        if reached and row["k"] > reached[-1]["k"] and row["kind"] != KINDS[ROLL]
    ]
    if len(near) < NEAREST or not left:
        return None
    ks, pairs = column(near, "k"), column(near, "pair")
    # k as a polynomial of the damping, so that its value at 0 is the root.
    parabola, cubic = (float(np.polyval(np.polyfit(pairs, ks, degree), 0.0)) for degree in (2, 3))
    first = min(left, key=lambda row: float(row["k"]))
    last = near[-1]
    return {
        "k": cubic,
        "k_off_by": abs(cubic - parabola),
        "leaves_by": first["k"],
        "for": first["kind"],
        "last": {name: last[name] for name in ("k", "pair", "exponent_2", "exponent_3")},
    }


def checked(rows: list[Row]) -> dict[str, Any]:
    """What halved steps change; of chaotic wheels only that they are."""
    regular = [row for row in rows if row["kind"] == row["kind_finer"] != KINDS[CHAOS]]
    changes = np.abs(column(regular, "exponent") - column(regular, "exponent_finer"))
    speeds = column(regular, "speed_off_by")
    return {
        "halved_steps": {
            "points": len(rows),
            "same_kind": sum(row["kind"] == row["kind_finer"] for row in rows),
            "median_exponent_off_by": float(np.median(changes)) if regular else None,
            "median_speed_off_by_rad_s": float(np.median(speeds)) if regular else None,
        },
        "kind_against_exponent": _disagreement(rows),
    }


def spectrum_claim(point: dict[str, Any], series: dict[str, Any] | None, route: str) -> Claim:
    """M8: chaos at the paper's point, by the sign of the largest exponent, found by two algorithms that have to agree."""
    rate, error = point["exponents"][0], point["standard_errors"][0]
    accuracy = point["accuracy"]
    agree = (
        accuracy["two_algorithms_differ_by"] < VERY_SURE * accuracy["two_algorithms_standard_error"]
    )
    chaotic = point["attractors"].get(KINDS[CHAOS], {"wheels": 0})["wheels"]
    low, high = wilson(chaotic, point["of_wheels"])
    from_force = (
        "none"
        if series is None
        else f"{series['per_s']:.2f}/s, where noise alone makes {series['of_noise']:.2f}/s"
    )
    others = ", ".join(f"{exponent:.3f}" for exponent in point["exponents"])
    return Claim(
        "M8",
        "chaos at k = 15, tau = 1: the largest Lyapunov exponent is positive",
        "series and Lyapunov spectrum",
        rate,
        "1/s",
        (rate - SURE * error, rate + SURE * error),
        rate > VERY_SURE * error and point["kind"] == KINDS[CHAOS] and agree,
        f"spectrum {others} 1/s, dimension {point['dimension']:.3f}; by pairs of near wheels"
        f" {point['by_pairs']:.3f} +- {point['by_pairs_error']:.3f}/s; from the series of the force"
        f" {from_force}; {chaotic} of {point['of_wheels']} wheels are chaotic ({low:.0%} to"
        f" {high:.0%}); {route}",
    )


def route(
    found: Crisis | None, samples: list[Sample], rolls: dict[str, Any] | None, most_s: float
) -> tuple[bool, str]:
    """How chaos begins along k: whether it is through a crisis, as the caption of the phase diagram says, and what speaks for it."""
    above = [one for one in samples if found and one.k > found.k_interval[1]]
    left, watched = sum(one.ended for one in above), sum(one.wheels for one in above)
    tested = [one for one in samples if one.likeness is not None]
    exponential = sum(one.likeness > LIKELY for one in tested if one.likeness is not None)
    words = [f"lives are exponentially distributed at {exponential} of {len(tested)} k"]
    holds = bool(found and watched and not left and exponential >= 0.8 * len(tested) > 0)
    begin = (
        "no crisis was found on the way to it"
        if found is None
        else f"going down in k it ends {'' if holds else 'perhaps '}in a crisis"
    )
    if found:
        begin += f" at {found.k:.2f} ({found.k_interval[0]:.2f} to {found.k_interval[1]:.2f})"
        power = (
            f"{found.power:.2f} ({found.power_interval[0]:.2f} to {found.power_interval[1]:.2f})"
        )
        words = [
            f"below, chaos is a transient with a mean life as (k_c - k)^-g, g = {power}",
            *words,
        ]
        words.append(f"above, {left} of {watched} wheels left it in {most_s:g} s")
    if rolls:
        words.append(
            f"going up in k, rolling stays stable as far as k = {rolls['k']:.3f}, where a pair of"
            f" exponents reaches 0 (Neimark-Sacker) and the wheel, by k = {rolls['leaves_by']:.3f},"
            f" is {rolls['for']}: a jump with hysteresis"
        )
    return holds, "; ".join([begin, *words])
