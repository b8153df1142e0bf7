"""Runs a study of the analytic model: computes its cells, here or on a cluster, and puts them together."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from host.entries import checked
from host.experiments.experiment import Setting
from host.experiments.work import begun, finish, simulate
from host.origin import commit
from host.theory.model import Wheel
from host.theory.table import TABLE
from robot import __version__

DEFAULT_SEED = 1


def perform(
    name: str,
    seed: int | None = None,
    *,
    out: str | Path = "results",
    scheduler: str | None = None,
    say: Callable[[str], None] = lambda words: None,
    **arguments: Any,
) -> dict[str, Any]:
    """Run a study, or the rest of one that was cut short, and return its summary, which also stands in its folder below `out`.

    seed: of all chances. scheduler: address of a Dask scheduler. arguments: the study's own options. Raises KickctlError; what was
    computed until then is kept.

    A study is the module host.theory.NAME with `cells(options)`, `simulate(cell, setting)` and `report(rows, setting)` as
    host.experiments.experiment has them, and a figure host.figures.NAME.
    """
    options = checked("study", TABLE, name, arguments)
    study_of = importlib.import_module("host.theory." + name.replace("-", "_"))
    setting = Setting(DEFAULT_SEED if seed is None else seed, options)
    settings = {"experiment": name, "seed": setting.seed, "options": options, "version": __version__, "commit": commit()}
    cells = study_of.cells(options)
    with begun(Path(out) / "theory", settings, cells, say) as study:
        simulate(name, study_of.simulate, cells, setting, study, scheduler)
        rows = study.rows(cells)
        return finish(name, rows, study_of.report(rows, setting), study, settings)


def wheel_of(options: dict[str, Any]) -> Wheel:
    """The wheel with the constants that the options name by the paper's letters, the others being the paper's."""
    named = {"a": "a", "tau": "tau_s", "k": "k", "I": "inertia", "f": "friction"}
    return Wheel(**{named[letter]: options[letter] for letter in named if options.get(letter) is not None}).checked()
