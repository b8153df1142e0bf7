"""The study `phase-diagram`: standard deviation and mean of omega over (k, tau).

k is swept up from rest and down from rolling. The phases say what a wheel does in the end: S it
rests, FB it rolls forth and back, LLM it rolls one way, C it is chaotic (see
host.theory.analysis.phases).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from host.runs.contract import Part, Row, Setting, as_rows
from host.theory.analysis.phases import phases
from host.theory.engine.ensemble import FINE, Averages, averages, require_loose
from host.theory.model.laws import require_friction
from host.theory.model.turning import rolling_states
from host.theory.model.wheel import PHI, Array, Wheel, resting, wheel_of
from host.theory.studies.phase_diagram_report import report
from host.theory.studies.phase_diagram_rows import (
    PANELS,
    BandCell,
    Panel,
    PhaseDiagramCell,
    Point,
    StepCheck,
    Way,
)

__all__ = ["cells", "report", "simulate"]

# The paper's inset.
INSET_K, INSET_TAU = 5.0, 0.5
# Time constants in a cell. Half of the work is at the shortest ones: a band of a few has too few
# blocks of wheels to share them out among the cores.
BAND = 256
# The k of a part of a cell: they take some seconds.
KS_OF_A_PART = 10
# Each wheel is pushed by this angle (rad): one that starts exactly at rest would stay there.
PUSH = 1e-3
# Points that are computed again, with steps FINER times smaller.
SAMPLE, FINER = 256, 1.6


def axis(most: float, points: int) -> Array:
    """The midpoints of `points` equal intervals from 0 to `most`, (points,)."""
    return (np.arange(points) + 0.5) * most / points


def axes_of(panel: Panel, options: dict[str, Any]) -> tuple[Array, Array]:
    """The axes of a panel: k, (points,), and tau in s, (points,)."""
    points = options["points"]
    if panel == "inset":
        return axis(INSET_K, points), axis(INSET_TAU, points)
    return axis(options["k_to"], points), axis(options["tau_to"], points)


def cells(options: dict[str, Any], *, batch: bool = True) -> list[PhaseDiagramCell]:
    """Bands of time constants, and a sample for the step size.

    Raises WrongUse if wheels never settle, or are too stiff to be followed.
    """
    require_friction(wheel_of(options))
    for panel in PANELS:
        ks, taus = axes_of(panel, options)
        stiffest = _parameters(options, taus, np.full(len(taus), ks[-1]))
        require_loose(stiffest, max(options["transient"], options["seconds"]))
    bands: list[PhaseDiagramCell] = [
        {"panel": panel, "first": first, "end": min(first + BAND, options["points"])}
        for panel in PANELS
        for first in range(0, options["points"], BAND)
    ]
    return [*bands, {"panel": "accuracy"}]


def simulate(cell: PhaseDiagramCell, setting: Setting) -> list[Row]:
    """The points of one band, or the sample."""
    return [row for part in parts(cell, setting, None) for row in part.rows]


def parts(cell: PhaseDiagramCell, setting: Setting, begun: Part | None) -> Iterator[Part]:
    """The points of one band, some k at a time, or the sample."""
    options = setting.options
    if cell["panel"] == "accuracy":
        yield Part(as_rows(_step_checks(options, setting.seed_of(cell))))
    elif options["start"] == "sweep":
        yield from _sweep(cell, options, begun)
    else:
        yield from _one_start(cell, options, begun)


def _sweep(cell: BandCell, options: dict[str, Any], begun: Part | None) -> Iterator[Part]:
    """k up and down. Each wheel starts, pushed, in the state in which it ended at the last k."""
    ks, all_taus = axes_of(cell["panel"], options)
    taus = all_taus[cell["first"] : cell["end"]]
    count = len(taus)
    both = np.concatenate([taus, taus])
    states = None if begun is None else np.array(begun.state)
    measured: list[tuple[Averages, Array]] = []
    ways = list(zip(ks.tolist(), ks[::-1].tolist(), strict=True))
    done = 0 if begun is None else len(begun.rows) // (2 * count)
    for number, (up, down) in enumerate(ways[done:], done + 1):
        parameters = _parameters(options, both, np.repeat([up, down], count))
        if states is None:
            at_rest = _at_rest(parameters[:, :count])
            states = np.hstack([at_rest, rolling_states(parameters[:, count:])])
        states[PHI] += PUSH
        measured.append((_averages(states, parameters, options), parameters))
        states = measured[-1][0].states.copy()
        if number % KS_OF_A_PART == 0 or number == len(ways):
            swept: list[Way] = [way for way in ("up", "down") for _ in range(count)]
            rows = as_rows(_points(swept * len(measured), *_together(measured)))
            yield Part(rows, states.tolist(), number / len(ways))
            measured = []


def _one_start(cell: BandCell, options: dict[str, Any], begun: Part | None) -> Iterator[Part]:
    """Many k at once, each wheel from rest or from rolling."""
    ks, all_taus = axes_of(cell["panel"], options)
    taus = all_taus[cell["first"] : cell["end"]]
    count = len(taus)
    way: Way = options["start"]
    done = 0 if begun is None else len(begun.rows) // count
    for first in range(done, len(ks), KS_OF_A_PART):
        own = ks[first : first + KS_OF_A_PART]
        parameters = _parameters(options, np.tile(taus, len(own)), np.repeat(own, count))
        start = _at_rest(parameters) if way == "rest" else rolling_states(parameters)
        result = _averages(start, parameters, options)
        found = _points(len(own) * count * [way], result, parameters)
        yield Part(as_rows(found), None, min(1.0, (first + KS_OF_A_PART) / len(ks)))


def _together(measured: list[tuple[Averages, Array]]) -> tuple[Averages, Array]:
    """Averages and parameters of all wheels: phases of many take little longer than of few."""
    found, parameters = zip(*measured, strict=True)
    joined = (np.concatenate(values, axis=-1) for values in zip(*found, strict=True))
    return Averages(*joined), np.hstack(parameters)


def _points(ways: list[Way], found: Averages, parameters: Array) -> list[Point]:
    """A row for each wheel."""
    taus, ks = (parameters[Wheel._fields.index(name)].tolist() for name in ("tau", "k"))
    columns = (found.omega_mean.tolist(), found.omega_std.tolist(), phases(found, parameters))
    return [
        {
            "way": way,
            "tau": tau,
            "k": k,
            "omega_mean": mean,
            "omega_std": std,
            "chaotic": float(name == "C"),
            "phase": name,
        }
        for way, tau, k, mean, std, name in zip(ways, taus, ks, *columns, strict=True)
    ]


def _step_checks(options: dict[str, Any], seed: int) -> list[StepCheck]:
    """Random points of the diagram, from rest, with the ordinary steps and with finer ones."""
    rng = np.random.default_rng(seed)
    random_taus = rng.uniform(0.0, options["tau_to"], SAMPLE)
    ks = rng.uniform(0.0, options["k_to"], SAMPLE)
    least_tau = axis(options["tau_to"], options["points"])[0]
    taus = np.maximum(random_taus, least_tau)
    parameters = _parameters(options, taus, ks)
    plain = _averages(_at_rest(parameters), parameters, options)
    fine = _averages(_at_rest(parameters), parameters, options, FINER * FINE)
    means_off = np.abs(np.abs(plain.omega_mean) - np.abs(fine.omega_mean))
    stds_off = np.abs(plain.omega_std - fine.omega_std)
    columns = (taus, ks, plain.omega_mean, plain.omega_std, means_off, stds_off)
    return [
        {
            "tau": tau,
            "k": k,
            "omega_mean": mean,
            "omega_std": std,
            "phase": name,
            "mean_off_by": mean_off,
            "std_off_by": std_off,
        }
        for tau, k, mean, std, mean_off, std_off, name in zip(
            *(column.tolist() for column in columns), phases(plain, parameters), strict=True
        )
    ]


def _parameters(options: dict[str, Any], taus: Array, ks: Array) -> Array:
    return wheel_of(options).columns(len(taus), tau=taus, k=ks)


def _at_rest(parameters: Array) -> Array:
    return resting(np.full(parameters.shape[1], PUSH))


def _averages(
    states: Array, parameters: Array, options: dict[str, Any], fineness: float = FINE
) -> Averages:
    return averages(states, parameters, options["transient"], options["seconds"], fineness)
