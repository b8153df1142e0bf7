"""The phase diagram: standard deviation and mean of omega over (k, tau), with k swept up from rest and down from rolling.

The phases, by what a wheel does in the end: S it rests, FB it rolls forth and back, LLM it rolls
one way, C chaos.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from host.runs.claims import Claim
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.hopf import critical_k, estimate
from host.theory.engine.ensemble import FINE, Averages, averages
from host.theory.model.turning import begun_rolling
from host.theory.model.wheel import PHI, Array, Wheel, resting, wheel_of
from host.theory.studies.registry import PAPER

# The paper's inset.
INSET_K, INSET_TAU = 5.0, 0.5
# Time constants that one cell does together: with both ways enough for both cores, and little to
# lose.
BAND = 128
# Each wheel is pushed so far (rad), or one that begins exactly at rest would stay there for ever.
PUSH = 1e-3
# Slower and steadier than this (rad/s), a wheel rests; the mean of one that rolls one way is
# larger, its deviation a part of its mean.
STILL, ROLLING_MEAN, ROLLING_SPREAD = 0.02, 0.1, 0.6
# Cycles around a resting angle end below this multiple of the k at which they are born.
NEAR_HOPF = 2.0
PHASES = ("S", "FB", "LLM", "C")
# Near the line, decay takes longer than the transient.
MISJUDGED = 0.01
# How many points are done again with smaller steps.
SAMPLE, FINER = 256, 1.6


def axis(most: float, points: int) -> Array:
    """The middles of `points` cells from 0 to `most`."""
    return (np.arange(points) + 0.5) * most / points


def planes(options: dict[str, Any]) -> dict[str, tuple[Array, Array]]:
    """(k, tau) axes of the diagram and of its inset."""
    points = options["points"]
    return {
        "plane": (axis(options["k_to"], points), axis(options["tau_to"], points)),
        "inset": (axis(INSET_K, points), axis(INSET_TAU, points)),
    }


def ways(options: dict[str, Any]) -> tuple[str, ...]:
    """How the states begin."""
    return ("up", "down") if options["start"] == "sweep" else (options["start"],)


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """Bands of time constants, and a sample that is done twice."""
    bands: list[Cell] = [
        {"panel": panel, "first": first, "end": min(first + BAND, options["points"])}
        for panel in planes(options)
        for first in range(0, options["points"], BAND)
    ]
    return [*bands, {"panel": "accuracy"}]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """One band. In a sweep each wheel begins, pushed a little, in the state in which it ended at the k before."""
    options = setting.options
    if cell["panel"] == "accuracy":
        return _sample(options, setting.seed_of(cell))
    ks, all_taus = planes(options)[cell["panel"]]
    taus = all_taus[cell["first"] : cell["end"]]
    count = len(taus)
    begin = {"up": _at_rest, "down": begun_rolling, "rest": _at_rest, "roll": begun_rolling}
    found: list[tuple[str, float, Averages]] = []
    if options["start"] != "sweep":
        way = options["start"]
        parameters = _parameters(options, np.tile(taus, len(ks)), np.repeat(ks, count))
        result = _averages(begin[way](parameters), parameters, options)
        split = [
            Averages(*(values[..., i * count : (i + 1) * count] for values in result))
            for i in range(len(ks))
        ]
        found = [(way, float(k), part) for k, part in zip(ks, split, strict=True)]
    else:
        both = np.concatenate([taus, taus])
        states = None
        for up, down in zip(ks, ks[::-1], strict=True):
            parameters = _parameters(options, both, np.repeat([up, down], count))
            if states is None:
                states = np.hstack(
                    [begin["up"](parameters[:, :count]), begin["down"](parameters[:, count:])]
                )
            states[PHI] += PUSH
            result = _averages(states, parameters, options)
            states = result.states
            for way, k, own in (("up", up, slice(None, count)), ("down", down, slice(count, None))):
                found.append((way, float(k), Averages(*(values[..., own] for values in result))))
    return [
        {"way": way, "tau": tau, "k": k, "omega_mean": mean, "omega_std": std}
        for way, k, part in found
        for tau, mean, std in zip(
            taus.tolist(), part.omega_mean.tolist(), part.omega_std.tolist(), strict=True
        )
    ]


def _sample(options: dict[str, Any], seed: int) -> list[Row]:
    """Points anywhere in the diagram, from rest, with the ordinary steps and with finer ones."""
    rng = np.random.default_rng(seed)
    taus, ks = (
        rng.uniform(0.0, options["tau_to"], SAMPLE),
        rng.uniform(0.0, options["k_to"], SAMPLE),
    )
    parameters = _parameters(
        options, np.maximum(taus, axis(options["tau_to"], options["points"])[0]), ks
    )
    plain, fine = (
        _averages(_at_rest(parameters), parameters, options, fineness)
        for fineness in (FINE, FINER * FINE)
    )
    means, stds = (
        np.abs(np.abs(plain.omega_mean) - np.abs(fine.omega_mean)),
        np.abs(plain.omega_std - fine.omega_std),
    )
    return [
        {
            "tau": tau,
            "k": k,
            "omega_mean": mean,
            "omega_std": std,
            "mean_off_by": off,
            "std_off_by": off_too,
        }
        for tau, k, mean, std, off, off_too in zip(
            *(
                v.tolist()
                for v in (parameters[1], ks, plain.omega_mean, plain.omega_std, means, stds)
            ),
            strict=True,
        )
    ]


def _parameters(options: dict[str, Any], taus: Array, ks: Array) -> Array:
    return wheel_of(options).columns(len(taus), tau_s=taus, k=ks)


def _at_rest(parameters: Array) -> Array:
    return resting(np.full(parameters.shape[1], PUSH))


def _averages(
    states: Array, parameters: Array, options: dict[str, Any], fineness: float = FINE
) -> Averages:
    return averages(states, parameters, options["transient"], options["seconds"], fineness)


def phase(row: Row, k_hopf: float) -> str:
    """S, FB, LLM or C, by mean and deviation of omega.

    What neither rests nor rolls goes forth and back near the Hopf line, where the cycles of the
    resting angles are, and else is chaotic.
    """
    mean, std = abs(row["omega_mean"]), row["omega_std"]
    if mean < STILL and std < STILL:
        return "S"
    if mean > ROLLING_MEAN and std < ROLLING_SPREAD * mean:
        return "LLM"
    return "FB" if row["k"] < NEAR_HOPF * k_hopf else "C"


def phases(rows: list[Row], options: dict[str, Any]) -> list[str]:
    """The phase of each row."""
    lines = {tau: critical_k(_wheel(options, tau)) for tau in {row["tau"] for row in rows}}
    return [phase(row, lines[row["tau"]]) for row in rows]


def _wheel(options: dict[str, Any], tau_s: float) -> Wheel:
    return wheel_of(options)._replace(tau_s=tau_s)


def report(rows: list[Row], setting: Setting) -> Findings:
    """M7."""
    options = setting.options
    diagram = [row for row in rows if row["panel"] in ("plane", "inset")]
    of_row = dict(zip(map(id, diagram), phases(diagram, options), strict=True))
    numbers: dict[str, Any] = {
        "constants": {name: options[name] for name in ("a", "f", "I")},
        "shares": {},
        "rest_misjudged": {},
    }
    numbers["accuracy"] = _accuracy([row for row in rows if row["panel"] == "accuracy"], options)
    for panel in planes(options):
        for way in ways(options):
            own = [row for row in diagram if row["panel"] == panel and row["way"] == way]
            found = [of_row[id(row)] for row in own]
            numbers["shares"][f"{panel}, {way}"] = {
                name: found.count(name) / len(found) for name in PHASES
            }
            numbers["rest_misjudged"][f"{panel}, {way}"] = {
                name: (
                    sum(
                        (row["k"] < k) != (of_row[id(row)] == "S")
                        for row, k in zip(own, line, strict=True)
                    )
                    / len(own)
                )
                for name, line in (
                    ("by the Hopf line", [critical_k(_wheel(options, row["tau"])) for row in own]),
                    ("by 2 f / (a tau)", [estimate(_wheel(options, row["tau"])) for row in own]),
                )
            }
    if options["start"] == "sweep":
        numbers["hysteresis"] = {
            panel: _hysteresis([row for row in diagram if row["panel"] == panel], of_row)
            for panel in planes(options)
        }
    constants = {name: value for name, value in PAPER.items() if name in options}
    foreign = setting.elsewhere(**constants, k_to=20.0, tau_to=1.5, start="sweep")
    coarse = setting.short_of(points=200, transient=100.0, seconds=100.0)
    return Findings([_claim(numbers, ways(options)[0]).doubted(foreign, coarse)], numbers)


def _accuracy(sample: list[Row], options: dict[str, Any]) -> dict[str, Any]:
    """How much the averages of points change if steps are FINER times smaller, chaotic ones apart.

    These never come out the same.
    """
    regular = [
        row for row, name in zip(sample, phases(sample, options), strict=True) if name != "C"
    ]
    changes = np.array([max(row["mean_off_by"], row["std_off_by"]) for row in regular])
    return {
        "points": len(regular),
        "median_rad_s": float(np.median(changes)) if regular else None,
        "p90_rad_s": float(np.quantile(changes, 0.9)) if regular else None,
        "share_not_reproduced": float(np.mean(changes > STILL)) if regular else None,
    }


def _hysteresis(rows: list[Row], of_row: dict[int, str]) -> dict[str, float]:
    """The share of points that are in one phase with k going up and in another with k going down, by the two phases."""
    pairs: dict[tuple[float, float], dict[str, str]] = {}
    for row in rows:
        pairs.setdefault((row["tau"], row["k"]), {})[row["way"]] = of_row[id(row)]
    found = [
        f"{pair['up']} up, {pair['down']} down"
        for pair in pairs.values()
        if pair["up"] != pair["down"]
    ]
    return {name: found.count(name) / len(pairs) for name in sorted(set(found))}


def _claim(numbers: dict[str, Any], way: str) -> Claim:
    shares, misjudged = numbers["shares"], numbers["rest_misjudged"]
    wanted = {"plane": PHASES, "inset": ("S", "FB", "LLM")}
    missing = [
        f"{name} in the {panel}"
        for panel, names in wanted.items()
        for name in names
        if not shares[f"{panel}, {way}"][name]
    ]
    exact, rough = (
        misjudged[f"inset, {way}"][name] for name in ("by the Hopf line", "by 2 f / (a tau)")
    )
    return Claim(
        "M7",
        "four phases in (k, tau): S, FB, LLM and C; rest ends near k tau = 2 f / a",
        "std(omega), |mean(omega)|, the inset, the numeric and the analytic line",
        exact,
        "of the inset's points rest otherwise than the exact Hopf line says",
        None,
        not missing and exact < MISJUDGED,
        (f"not found: {', '.join(missing)}; " if missing else "")
        + f"{rough:.2%} otherwise than k tau = 2 f / a says; of the plane "
        + ", ".join(f"{share:.1%} {name}" for name, share in shares[f"plane, {way}"].items()),
    )
