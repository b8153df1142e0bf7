"""What the study `lyapunov` finds at its point, and the claim M8."""

from __future__ import annotations

import numpy as np

from host.errors import NotDone
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.attractors import CHAOS, KINDS, REST, Kind
from host.theory.analysis.series_exponents import from_series, of_noise
from host.theory.analysis.tangent import divergence, kaplan_yorke
from host.theory.analysis.transients import crisis, sample
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies.lyapunov_numbers import Numbers, Point, Series, Spectrum, StepAccuracy
from host.theory.studies.lyapunov_pieces import LIVES_S, SAMPLE_S
from host.theory.studies.lyapunov_rows import (
    BlockRow,
    LyapunovRow,
    SeriesRow,
    StepCheckRow,
    blocks_of,
    line_of,
    lives_of,
    plane_of,
    rolling_end_of,
    series_of,
    step_checks,
)
from host.theory.studies.registry import PAPER
from host.theory.studies.route_to_chaos import (
    NEAR_ZERO,
    along,
    crisis_numbers,
    disagreement,
    lives_numbers,
    rolling_end_numbers,
    route,
    tally,
)
from host.util.intervals import wilson

# The point of the claim.
PAPER_K, PAPER_TAU_S = 15.0, 1.0
# A wheel of the spectrum is followed for at most this long (s); longer runs take more wheels.
LONGEST_S = 2000.0
# A normal distribution's 95 % and 99.7 %, in standard errors.
SURE, VERY_SURE = 1.96, 3.0
# A period of the motion in the series, s.
APART_S = 2.0


def report(rows: list[LyapunovRow], setting: Setting) -> Findings:
    """The spectrum, the route to chaos at this tau, and M8."""
    wheel = wheel_of(setting.options)
    point = spectrum(blocks_of(rows), wheel)
    series = of_series(series_of(rows))
    rolls = rolling_end_numbers(rolling_end_of(rows))
    samples = [
        sample(k, np.array([row["life_s"] for row in own]), np.array([row["ended"] for row in own]))
        for k, own in lives_of(rows).items()
    ]
    found = crisis(samples)
    through_a_crisis, words = route(found, samples, rolls, LIVES_S)
    options = setting.options
    numbers: Numbers = {
        "exponents": point["exponents"],
        "standard_errors": point["standard_errors"],
        "dimension": point["dimension"],
        "constants": {
            "a": options["a"],
            "tau": options["tau"],
            "k": options["k"],
            "f": options["f"],
            "I": options["I"],
        },
        "point": point,
        "series": series,
        "line": along(line_of(rows)),
        "plane": tally(plane_of(rows)),
        "rolling_ends": rolls,
        "crisis": None if found is None else crisis_numbers(found),
        "through_a_crisis": through_a_crisis,
        "lives": [lives_numbers(one) for one in samples],
        "accuracy": {**point["accuracy"], **halved_steps(step_checks(rows))},
    }
    claim = spectrum_claim(point, series, words)
    # The interval of the exponent says whether a short run is enough, if it is above zero.
    short = "" if claim.holds else setting.short_of(seconds=LONGEST_S)
    foreign = setting.elsewhere(**PAPER | {"tau": PAPER_TAU_S, "k": PAPER_K})
    return Findings([claim.doubted(foreign, short)], numbers)


def spectrum(rows: list[BlockRow], wheel: Wheel) -> Point:
    """Exponents (1/s) with standard errors, of each kind of attractor that wheels stayed on.

    The attractor that most wheels are on stands at the top.

    Raises:
        NotDone: No wheel stayed on its attractor.
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


def _of_kind(rows: list[BlockRow], kind: Kind) -> Spectrum:
    """Means over blocks, with standard errors from blocks and from whole wheels.

    Wheels are independent of each other.
    """
    values = np.array(
        [
            [row["exponent_1"] for row in rows],
            [row["exponent_2"] for row in rows],
            [row["exponent_3"] for row in rows],
            [row["exponent_4"] for row in rows],
        ]
    )
    wheels = [(row["batch"], row["wheel"]) for row in rows]
    of_wheels = np.array(
        [
            values[:, [own == wheel for own in wheels]].mean(axis=1)
            for wheel in dict.fromkeys(wheels)
        ]
    ).T
    pairs = np.array([row["by_pairs"] for row in rows])
    # Within a short time two equal exponents may come out in the wrong order.
    order = np.argsort(-values.mean(axis=1))
    values, of_wheels = values[order], of_wheels[order]
    exponents, errors = values.mean(axis=1), _error(values)
    # Except at rest one exponent, along the flow, is 0. An exponent of rest may be close to 0 and
    # yet not 0.
    least = 0.0 if kind == KINDS[REST] else float(max(NEAR_ZERO, VERY_SURE * errors.max()))
    return {
        "wheels": of_wheels.shape[1],
        "exponents": exponents.tolist(),
        "standard_errors": errors.tolist(),
        "errors_by_wheels": _error(of_wheels).tolist() if of_wheels.shape[1] > 1 else None,
        "dimension": kaplan_yorke(exponents, least),
        "by_pairs": float(pairs.mean()),
        "by_pairs_error": float(_error(pairs[None])[0]),
        "omega_mean_abs": float(np.mean([abs(row["omega_mean"]) for row in rows])),
        "omega_std": float(np.mean([row["omega_std"] for row in rows])),
    }


def _error(values: Array) -> Array:
    """Standard errors of the means over the last axis, (rows,)."""
    count = values.shape[1]
    if count < 2:
        return np.zeros(len(values))
    return np.asarray(values.std(axis=1, ddof=1) / np.sqrt(count))


def of_series(rows: list[SeriesRow]) -> Series | None:
    """The largest exponent from the force alone, by neighbours in delay coordinates.

    None for a wheel that does not move enough.
    """
    force = np.array([row["force"] for row in rows])
    found = from_series(force, SAMPLE_S, APART_S) if np.ptp(force) > 1e-6 else None
    if found is None:
        return None
    exponent, embedded = found
    return {
        "per_s": exponent.rate,
        "interval": exponent.interval,
        "lag_s": embedded.lag * SAMPLE_S,
        "dimension": embedded.dimension,
        "of_noise": of_noise(),
    }


def halved_steps(rows: list[StepCheckRow]) -> StepAccuracy:
    """What changes with half the step. Chaotic wheels are compared by their kind only."""
    regular = [row for row in rows if row["kind"] == row["kind_finer"] != KINDS[CHAOS]]
    changes = [abs(row["exponent"] - row["exponent_finer"]) for row in regular]
    speeds = [row["speed_off_by"] for row in regular]
    return {
        "halved_steps": {
            "points": len(rows),
            "same_kind": sum(row["kind"] == row["kind_finer"] for row in rows),
            "median_exponent_off_by": float(np.median(changes)) if regular else None,
            "median_speed_off_by_rad_s": float(np.median(speeds)) if regular else None,
        },
        "kind_against_exponent": disagreement(rows),
    }


def spectrum_claim(point: Point, series: Series | None, route: str) -> Claim:
    """M8: the largest exponent is positive by two algorithms, which have to agree."""
    rate, error = point["exponents"][0], point["standard_errors"][0]
    off = point["accuracy"]["two_algorithms_differ_by"]
    most_off = point["accuracy"]["two_algorithms_standard_error"]
    positive = rate > VERY_SURE * error and point["kind"] == KINDS[CHAOS]
    attractors = point["attractors"]
    chaotic = attractors[KINDS[CHAOS]]["wheels"] if KINDS[CHAOS] in attractors else 0
    low, high = wilson(chaotic, point["of_wheels"])
    from_force = "none"
    if series is not None:
        from_force = f"{series['per_s']:.2f}/s, and of noise {series['of_noise']:.2f}/s"
    others = ", ".join(f"{exponent:.3f}" for exponent in point["exponents"])
    return Claim(
        "M8",
        "at k = 15 and tau = 1 s a wheel is chaotic: its largest Lyapunov exponent is positive",
        "series and Lyapunov spectrum",
        rate,
        "1/s",
        (rate - SURE * error, rate + SURE * error),
        positive and off < VERY_SURE * most_off,
        f"the largest exponent. By pairs of near wheels it is {point['by_pairs']:.3f} +-"
        f" {point['by_pairs_error']:.3f}/s, from the time series of the force {from_force}; all"
        f" exponents: {others} 1/s, dimension {point['dimension']:.3f}; {chaotic} of"
        f" {point['of_wheels']} wheels are chaotic ({low:.0%} to {high:.0%}); {route}",
    )
