"""What the study `lyapunov` finds, and the claim M8."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from host.errors import NotDone
from host.runs.answers import Answer, share
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim
from host.runs.contract import Findings, Setting
from host.theory.analysis.attractors import CHAOS, KINDS, Kind
from host.theory.analysis.series_exponents import from_series, of_noise
from host.theory.analysis.spectrum import mean
from host.theory.analysis.tangent import divergence, kaplan_yorke
from host.theory.analysis.trajectories import SAMPLE_S
from host.theory.model.wheel import Array, Wheel, wheel_of
from host.theory.studies.lyapunov_numbers import Numbers, Point, Series, Spectrum
from host.theory.studies.lyapunov_rows import (
    BlockRow,
    LyapunovRow,
    SeriesRow,
    blocks_of,
    series_of,
)
from host.theory.studies.registry import PAPER
from host.util.intervals import wilson

# The point of the claim.
PAPER_K, PAPER_TAU_S = 15.0, 1.0
# A claim that does not hold takes this much time (s) to say so.
LONG_S = 250.0
# A normal distribution's 95 % and 99.7 %, in standard errors; and what makes a second exponent
# positive.
SURE, VERY_SURE, CERTAIN = 1.96, 3.0, 5.0
# Regular motions are the same if speeds (rad/s) and exponents (1/s) differ by less, or relatively.
# The exponents are those of ALIKE_S (s) or more: of two that belong together, as those of a complex
# pair of multipliers, the error falls as 1 / time.
ALIKE, ALIKE_S = 0.02, 250.0
# A period of the motion in the series, s.
APART_S = 2.0


def report(rows: list[LyapunovRow], setting: Setting) -> Findings:
    """The spectrum, and M8."""
    wheel, options = wheel_of(setting.options), setting.options
    point, series = spectrum(blocks_of(rows), wheel), of_series(series_of(rows))
    verdict = verdict_of(point)
    numbers: Numbers = {
        "verdict": verdict,
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
        "accuracy": point["accuracy"],
    }
    claim = spectrum_claim(point, series)
    # The interval of the exponent says whether a short run is enough, if it is above zero.
    short = "" if claim.holds else setting.short_of(seconds=LONG_S)
    foreign = setting.elsewhere(**PAPER | {"tau": PAPER_TAU_S, "k": PAPER_K})
    return Findings([claim.doubted(foreign, short)], numbers, answers=_answers(numbers))


def _answers(numbers: Numbers) -> list[Answer]:
    point = numbers["point"]
    pairs = zip(numbers["exponents"], numbers["standard_errors"], strict=True)
    return [
        Answer("the wheel is", in_words(point)),
        *(Answer(f"exponent {n}", value, error, "/s") for n, (value, error) in enumerate(pairs, 1)),
        Answer("exponent 1, by pairs of wheels", point["by_pairs"], point["by_pairs_error"], "/s"),
        Answer("Lyapunov dimension", numbers["dimension"]),
        Answer("|mean of omega|", round(point["omega_mean_abs"], 9), None, "rad/s"),
        Answer("standard deviation of omega", round(point["omega_std"], 9), None, "rad/s"),
        *_starts(point),
    ]


def _starts(point: Point) -> list[Answer]:
    """Where starts lead, and the exponents of each attractor if there are several."""
    count, (_, *others) = point["of_wheels"], point["attractors"].items()
    answers = [
        share(f"starts that lead to: {name}", own["wheels"], count)
        for name, own in point["attractors"].items()
    ]
    if point["changed"]:
        answers.append(share("starts that have not settled", point["changed"], count))
    for name, own in others:
        pairs = zip(own["exponents"], own["standard_errors"], strict=True)
        answers += [
            Answer(f"{name}: exponent {n}", value, error, "/s")
            for n, (value, error) in enumerate(pairs, 1)
        ]
    return answers


def verdict_of(point: Point) -> str:
    """What the exponents say: the kind of attractor, or hyperchaotic."""
    second, error = point["exponents"][1], point["standard_errors"][1]
    if point["kind"] == KINDS[CHAOS] and second > CERTAIN * error:
        return "hyperchaotic"
    return point["kind"]


def in_words(point: Point) -> str:
    """What the wheel is; where starts lead to several attractors, all of them."""
    _, *others = point["attractors"]
    return " or ".join([verdict_of(point), *others]) + ("; its start decides" if others else "")


def spectrum(rows: list[BlockRow], wheel: Wheel) -> Point:
    """Exponents (1/s) with standard errors, of each attractor that wheels stayed on.

    The attractor that most wheels are on stands at the top.

    Raises:
        NotDone: No wheel stayed on its attractor.
    """
    found = {
        name: _spectrum_of(own)
        for kind in KINDS
        for name, own in _attractors(
            kind, [row for row in rows if row["kind"] == row["kind_after"] == kind]
        )
    }
    if not found:
        raise NotDone(
            "no wheel stayed on an attractor while its exponents were measured",
            "measure longer or shorter, with --seconds",
        )
    main = max(found, key=lambda name: found[name]["wheels"])
    wheels = len({(row["batch"], row["wheel"]) for row in rows})
    own = found[main]
    error = float(np.hypot(own["standard_errors"][0], own["by_pairs_error"]))
    return {
        **own,
        "kind": next(kind for kind in KINDS if main.startswith(kind)),
        "attractors": dict(sorted(found.items(), key=lambda pair: -pair[1]["wheels"])),
        "of_wheels": wheels,
        "changed": wheels - sum(entry["wheels"] for entry in found.values()),
        "accuracy": {
            "sum_of_exponents_exact": divergence(wheel),
            "sum_of_exponents_off_by": abs(sum(own["exponents"]) - divergence(wheel)),
            "two_algorithms_differ_by": abs(own["exponents"][0] - own["by_pairs"]),
            "two_algorithms_standard_error": error,
        },
    }


def _by_wheel(rows: list[BlockRow]) -> list[list[BlockRow]]:
    """The blocks of each wheel."""
    found: dict[tuple[int, int], list[BlockRow]] = {}
    for row in rows:
        found.setdefault((row["batch"], row["wheel"]), []).append(row)
    return list(found.values())


def _exponents_of(row: BlockRow) -> list[float]:
    return [row["exponent_1"], row["exponent_2"], row["exponent_3"], row["exponent_4"]]


def _attractors(kind: Kind, rows: list[BlockRow]) -> Iterator[tuple[str, list[BlockRow]]]:
    """The attractors of one kind, by name, and the rows of their wheels.

    Regular motions are the same if their speeds and exponents are; wheels that turn opposite ways
    are on the same one. Chaotic wheels are taken together.
    """
    groups: list[tuple[Array, list[BlockRow]]] = []
    for own in _by_wheel(rows):
        speeds = [abs(own[0]["omega_mean"]), own[0]["omega_std"]]
        place = np.array([*speeds, *np.mean([_exponents_of(row) for row in own], axis=0)])
        shorter = max(1.0, ALIKE_S / own[0]["seconds"])
        within = ALIKE * np.array([1.0] * len(speeds) + [shorter] * 4)
        for other, same in groups:
            if kind == KINDS[CHAOS] or np.allclose(place, other, ALIKE, within):
                same.extend(own)
                break
        else:
            groups.append((place, own))
    groups.sort(key=lambda group: -len(group[1]))
    for number, (_, same) in enumerate(groups, 1):
        yield (kind if number == 1 else f"{kind} ({number})"), same


def _spectrum_of(rows: list[BlockRow]) -> Spectrum:
    """Means over wheels and blocks, with their errors."""
    by_wheel = _by_wheel(rows)
    values = np.array([[_exponents_of(row) for row in own] for own in by_wheel])
    pairs = mean(np.array([[row["by_pairs"] for row in own] for own in by_wheel]))
    means = [mean(values[:, :, number]) for number in range(4)]
    flow = means[0] if rows[0]["along_flow"] else None
    means.sort(key=lambda one: -one.value)
    # Along the flow the exponent is 0.
    exact = [0.0 if one is flow else one.value for one in means]
    return {
        "wheels": len(by_wheel),
        "exponents": [one.value for one in means],
        "standard_errors": [one.error for one in means],
        "errors_by_wheels": _known([one.by_wheels for one in means]),
        "errors_by_blocks": _known([one.by_blocks for one in means]),
        "along_flow": flow and flow.value,
        "along_flow_error": flow and flow.error,
        "dimension": kaplan_yorke(np.array(exact)),
        "by_pairs": pairs.value,
        "by_pairs_error": pairs.error,
        "omega_mean_abs": float(np.mean([abs(row["omega_mean"]) for row in rows])),
        "omega_std": float(np.mean([row["omega_std"] for row in rows])),
    }


def _known(errors: list[float | None]) -> list[float] | None:
    """The errors; None if they are not known."""
    known = [error for error in errors if error is not None]
    return known or None


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


def spectrum_claim(point: Point, series: Series | None) -> Claim:
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
    pairs = zip(point["exponents"], point["standard_errors"], strict=True)
    all_four = ", ".join(Answer("", exponent, own).in_words() for exponent, own in pairs)
    return Claim(
        "M8",
        SENTENCES["M8"],
        "series and Lyapunov spectrum",
        rate,
        "1/s",
        (rate - SURE * error, rate + SURE * error),
        positive and off < VERY_SURE * most_off,
        f"the largest exponent. By pairs of near wheels it is {point['by_pairs']:.3f} +-"
        f" {point['by_pairs_error']:.3f}/s, from the time series of the force {from_force}; all"
        f" exponents: {all_four} 1/s, dimension {point['dimension']:.3f}: the wheel is"
        f" {in_words(point)}; {chaotic} of {point['of_wheels']} wheels are chaotic ({low:.0%} to"
        f" {high:.0%})",
    )
