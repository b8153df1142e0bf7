"""Lyapunov exponents of a wheel, how chaos begins along k, what coexists with it, and how long it lasts where it does not last (M8).

Kinds of pieces, told apart by `part`:

- point: the whole spectrum at (k, tau), block by block, and the largest exponent from pairs of near
  wheels.
- series: angle, speed and force of one wheel there.
- line: attractors and largest exponents along k, of wheels that start anyhow and of wheels that
  roll.
- plane: the same over (k, tau), one wheel of each start.
- rolling: along k, how fast what disturbs a rolling wheel dies out.
- lives: how long wheels switch, around the least k with chaos.
- check: some points of the plane with ordinary steps and with half of these.
"""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from host.errors import WrongUse
from host.runs.contract import Cell, Findings, Row, Setting
from host.theory.analysis.attractors import KINDS, ROLL, settled, starts, watch
from host.theory.analysis.tangent import divergence, growth, pair_growth, smooth_mean
from host.theory.analysis.transients import crisis, least_chaotic_k, lives, sample
from host.theory.engine.ensemble import rate_per_s
from host.theory.model.turning import begun_rolling
from host.theory.model.wheel import Array, Wheel, numpy_rates, wheel_of
from host.theory.studies.registry import PAPER
from host.theory.studies.route_to_chaos import (
    along,
    checked,
    of_series,
    rolling_end,
    route,
    spectrum,
    spectrum_claim,
    tally,
)

PARTS = ("point", "series", "line", "plane", "rolling", "lives", "check")
PAPER_K, PAPER_TAU_S = 15.0, 1.0
ANY, ROLLS = "any", "rolls"
SETTLE_S, WATCH_S, MEASURE_S = 200.0, 100.0, 100.0
# Steps for whatever needs no more than a kind and an exponent (see host.theory.engine.ensemble);
# `check` says how good that is.
FINENESS = 0.6
# The point: wheels, how long one is followed at most, and blocks, much longer than what a chaotic
# wheel remembers.
WHEELS, LONGEST_S, ALIGN_S, BLOCK_S = 64, 2000.0, 20.0, 100.0
SERIES_S, SAMPLE_S = 300.0, 0.03
# The axes end at these, or somewhat beyond the point.
LINE_KS, LINE_WHEELS, LINE_BAND = 160, 8, 16
PLANE, PLANE_BAND, MOST_K, MOST_TAU_S, BEYOND = 60, 4, 20.0, 1.5, 1.25
ROLLING_KS = 64
LIVES_AT, LIVES_WHEELS, LIVES_S = (
    (-0.1, -0.07, -0.045, -0.025, -0.01, 0.0, 0.005, 0.01, 0.015, 0.02),
    256,
    2000.0,
)
CHECKED = 256
# A wheel that changes faster (1/s) takes more than an hour.
FASTEST = 5000.0


def k_axis(options: dict[str, Any], points: int) -> Array:
    """The middles of `points` cells from 0 to the greatest k."""
    return np.asarray((np.arange(points) + 0.5) * max(MOST_K, BEYOND * options["k"]) / points)


def tau_axis(options: dict[str, Any]) -> Array:
    """The same of the plane's tau, s."""
    return np.asarray((np.arange(PLANE) + 0.5) * max(MOST_TAU_S, BEYOND * options["tau"]) / PLANE)


def cells(options: dict[str, Any], *, batch: bool = True) -> list[Cell]:
    """All pieces. Raises WrongUse of wheels that are too fast to be followed for long."""
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
    points: list[Cell] = [
        {"part": "point", "batch": batch, "seconds": options["seconds"] / batches}
        for batch in range(batches)
    ]
    lines: list[Cell] = [{"part": "line", "first": first} for first in range(0, LINE_KS, LINE_BAND)]
    planes: list[Cell] = [
        {"part": "plane", "first": first} for first in range(0, PLANE, PLANE_BAND)
    ]
    life: list[Cell] = [{"part": "lives", "offset": offset} for offset in LIVES_AT]
    return [
        {"part": "series"},
        *planes,
        *lines,
        {"part": "rolling"},
        {"part": "check"},
        *life,
        *points,
    ]


def simulate(cell: Cell, setting: Setting) -> list[Row]:
    """One of the pieces."""
    parts = {
        "point": _point,
        "series": _series,
        "line": _line,
        "plane": _plane,
        "rolling": _rolling,
        "lives": _lives,
        "check": _check,
    }
    wheel = wheel_of(setting.options)
    return parts[cell["part"]](
        cell, setting.options, wheel, np.random.default_rng(setting.seed_of(cell))
    )


def _settle_s(wheel: Wheel) -> float:
    """How long to wait for an attractor."""
    return max(SETTLE_S, 20 * wheel.tau_s)


def _point(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    parameters, seconds = wheel.columns(WHEELS), cell["seconds"]
    before = watch(settled(starts(WHEELS, rng), parameters, _settle_s(wheel)), parameters, WATCH_S)
    aligned = growth(before.states, parameters, ALIGN_S, 4)
    spectrum = growth(aligned.states, parameters, seconds, 4, aligned.vectors)
    pairs = pair_growth(aligned.states, parameters, seconds)
    after = watch(spectrum.states, parameters, WATCH_S)
    blocks = max(1, round(seconds / BLOCK_S))
    means = np.array([block.mean(axis=0) for block in np.array_split(spectrum.rates, blocks)])
    pair_means = np.array([block.mean(axis=0) for block in np.array_split(pairs, blocks)])
    return [
        {
            "wheel": own,
            "kind": KINDS[before.kinds()[own]],
            "kind_after": KINDS[after.kinds()[own]],
            "omega_mean": float(after.omega_mean[own]),
            "omega_std": float(after.omega_std[own]),
            "block": block,
            **{f"exponent_{order + 1}": float(means[block, order, own]) for order in range(4)},
            "by_pairs": float(pair_means[block, own]),
        }
        for own in range(WHEELS)
        for block in range(blocks)
    ]


def _series(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    """One wheel; a chaotic one if there is."""
    parameters = wheel.columns(WHEELS)
    seen = watch(settled(starts(WHEELS, rng), parameters, _settle_s(wheel)), parameters, WATCH_S)
    begin, times = (
        seen.states[:, int(seen.kinds().argmax())],
        SAMPLE_S * np.arange(round(SERIES_S / SAMPLE_S)),
    )
    path = solve_ivp(
        lambda _, state: numpy_rates(*state, *wheel),
        (0.0, SERIES_S),
        begin,
        "DOP853",
        times,
        rtol=1e-9,
        atol=1e-9,
    ).y
    _, _, phi, omega = path
    force = wheel.inertia * numpy_rates(*path, *wheel)[3] + wheel.friction * omega
    names = ("t_s", "phi_rad", "omega", "force")
    return [
        dict(zip(names, values, strict=True))
        for values in zip(times.tolist(), phi.tolist(), omega.tolist(), force.tolist(), strict=True)
    ]


def _measured(parameters: Array, begin: Array, fineness: float = FINENESS) -> list[Row]:
    """Kind, largest exponent, and mean and deviation of omega of each wheel, after it has settled."""
    slowest = float(parameters[Wheel._fields.index("tau_s")].max())
    seen = watch(
        settled(begin, parameters, max(SETTLE_S, 20 * slowest), fineness),
        parameters,
        WATCH_S,
        fineness,
    )
    exponents = smooth_mean(growth(seen.states, parameters, MEASURE_S, fineness=fineness).rates)[0]
    values = (
        seen.kinds().tolist(),
        exponents.tolist(),
        seen.omega_mean.tolist(),
        seen.omega_std.tolist(),
    )
    return [
        {"kind": KINDS[kind], "exponent": exponent, "omega_mean": mean, "omega_std": std}
        for kind, exponent, mean, std in zip(*values, strict=True)
    ]


def _both_starts(parameters: Array, wheels: int, rng: np.random.Generator) -> list[Row]:
    """Measure each column from so many starts of either kind."""
    columns = np.repeat(parameters, wheels, axis=1)
    count = columns.shape[1]
    begin = np.hstack(
        [starts(count, rng), begun_rolling(columns) + 1e-3 * rng.normal(size=(4, count))]
    )
    found = _measured(np.tile(columns, (1, 2)), begin)
    taus, ks = (columns[Wheel._fields.index(name)].tolist() for name in ("tau_s", "k"))
    labels = [
        {"tau": tau, "k": k, "start": start}
        for start in (ANY, ROLLS)
        for tau, k in zip(taus, ks, strict=True)
    ]
    return [{**label, **row} for label, row in zip(labels, found, strict=True)]


def _line(cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator) -> list[Row]:
    ks = k_axis(options, LINE_KS)[cell["first"] : cell["first"] + LINE_BAND]
    return _both_starts(wheel.columns(len(ks), k=ks), LINE_WHEELS, rng)


def _plane(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    taus, ks = tau_axis(options)[cell["first"] : cell["first"] + PLANE_BAND], k_axis(options, PLANE)
    return _both_starts(
        wheel.columns(PLANE * len(taus), k=np.tile(ks, len(taus)), tau_s=np.repeat(taus, PLANE)),
        1,
        rng,
    )


def _rolling(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    """Along the whole line, and again around the last k at which a wheel that rolls goes on to roll."""
    ks = k_axis(options, ROLLING_KS)
    rows = _damping(wheel, ks)
    last = next((row["k"] for row in reversed(rows) if row["kind"] == KINDS[ROLL]), None)
    if last is None:
        return rows
    step = ks[1] - ks[0]
    return [
        *rows,
        *_damping(wheel, np.linspace(max(step / 2, last - 2 * step), last + step, ROLLING_KS)),
    ]


def _damping(wheel: Wheel, ks: Array) -> list[Row]:
    """How fast disturbances die out. Of the four exponents of a cycle one is 0 and one fast.

    `pair` is the mean of the other two.

    They are known together from the fast one and the sum of all, and far better so than one by one
    if they are a complex pair.
    """
    parameters = wheel.columns(len(ks), k=ks)
    seen = watch(
        settled(begun_rolling(parameters), parameters, 2 * _settle_s(wheel)), parameters, WATCH_S
    )
    exponents = smooth_mean(growth(seen.states, parameters, MEASURE_S, 4).rates)
    pairs = (divergence(wheel) - exponents[3]) / 2
    values = (
        ks.tolist(),
        seen.kinds().tolist(),
        seen.apart.tolist(),
        pairs.tolist(),
        exponents[1].tolist(),
        exponents[2].tolist(),
    )
    return [
        {
            "k": k,
            "kind": KINDS[kind],
            "apart": apart,
            "pair": pair,
            "exponent_2": second,
            "exponent_3": third,
        }
        for k, kind, apart, pair, second, third in zip(*values, strict=True)
    ]


def _lives(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    least = least_chaotic_k(wheel, float(k_axis(options, LINE_KS)[-1]), FINENESS)
    if least is None:
        return []
    k = least * (1 + cell["offset"])
    found = lives(
        starts(LIVES_WHEELS, rng), wheel._replace(k=k).columns(LIVES_WHEELS), LIVES_S, FINENESS
    )
    ends = zip(found.life_s.tolist(), found.ended.tolist(), strict=True)
    return [{"k": k, "life_s": life_s, "ended": ended} for life_s, ended in ends]


def _check(
    cell: Cell, options: dict[str, Any], wheel: Wheel, rng: np.random.Generator
) -> list[Row]:
    ks, taus = rng.choice(k_axis(options, PLANE), CHECKED), rng.choice(tau_axis(options), CHECKED)
    parameters, begin = wheel.columns(CHECKED, k=ks, tau_s=taus), starts(CHECKED, rng)
    plain, finer = (_measured(parameters, begin, fineness) for fineness in (FINENESS, 2 * FINENESS))
    return [
        {
            "tau": tau,
            "k": k,
            **own,
            "kind_finer": other["kind"],
            "exponent_finer": other["exponent"],
            "speed_off_by": abs(abs(own["omega_mean"]) - abs(other["omega_mean"])),
        }
        for tau, k, own, other in zip(taus.tolist(), ks.tolist(), plain, finer, strict=True)
    ]


def report(rows: list[Row], setting: Setting) -> Findings:
    """The spectrum, the route to chaos at this tau, and M8."""
    wheel = wheel_of(setting.options)
    parts = {part: [row for row in rows if row["part"] == part] for part in PARTS}
    point, series, rolls = (
        spectrum(parts["point"], wheel),
        of_series(parts["series"], SAMPLE_S),
        rolling_end(parts["rolling"]),
    )
    by_k = {
        k: [row for row in parts["lives"] if row["k"] == k]
        for k in dict.fromkeys(row["k"] for row in parts["lives"])
    }
    samples = [
        sample(k, *(np.array([row[name] for row in own]) for name in ("life_s", "ended")))
        for k, own in by_k.items()
    ]
    found = crisis(samples)
    through_a_crisis, words = route(found, samples, rolls, LIVES_S)
    numbers: dict[str, Any] = {
        "exponents": point["exponents"],
        "standard_errors": point["standard_errors"],
        "dimension": point["dimension"],
        "constants": {name: setting.options[name] for name in ("a", "tau", "k", "f", "I")},
        "point": point,
        "series": series,
        "line": along(parts["line"]),
        "plane": tally(parts["plane"]),
        "rolling_ends": rolls,
        "crisis": None if found is None else found._asdict(),
        "through_a_crisis": through_a_crisis,
        "lives": [one._asdict() for one in samples],
        "accuracy": {**point["accuracy"], **checked(parts["check"])},
    }
    claim = spectrum_claim(point, series, words)
    # The interval of the exponent says whether a short run is enough, if it is above zero.
    short = "" if claim.holds else setting.short_of(seconds=LONGEST_S)
    foreign = setting.elsewhere(**PAPER | {"tau": PAPER_TAU_S, "k": PAPER_K})
    return Findings([claim.doubted(foreign, short)], numbers)
