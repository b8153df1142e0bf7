"""Finds an experiment or study by its name: its entry, its module and its figure."""

from __future__ import annotations

import importlib
from typing import NamedTuple, cast

from host.experiments.registry import BODIES, ROBOT, SIMULATED
from host.runs.contract import Cell, Experiment, Options, Parts
from host.runs.registry import Entry, entry_of
from host.runs.robot_options import params_of, params_with
from host.theory.studies.registry import TABLE as STUDIES

# The kinds by the name that people know: entries, the package of the modules, that of the figures.
EXPERIMENT, BODY, STUDY = "experiment", "experiment on bodies", "study"
SIMULATION = "experiment on the simulated robot"
KINDS = {
    EXPERIMENT: (ROBOT, "host.experiments.robot", "host.figures.robot"),
    SIMULATION: (SIMULATED, "host.experiments.robot", "host.figures.robot"),
    BODY: (BODIES, "host.experiments.bodies", "host.figures.bodies"),
    STUDY: (STUDIES, "host.theory.studies", "host.figures.theory"),
}


class Found(NamedTuple):
    """An experiment or study.

    Attributes:
        kind: A key of KINDS.
        entry: Its options and claims.
        work: Its module.
        figures: The name of the module that draws its figure.
    """

    kind: str
    entry: Entry
    work: Experiment
    figures: str

    @property
    def parts(self) -> Parts | None:
        """Computes a cell part by part; None if its cells are short."""
        return getattr(self.work, "parts", None)

    def cells(self, options: Options, *, batch: bool) -> list[Cell]:
        """The cells of a run. Raises WrongUse if it makes no sense, or no robot could do it."""
        if self.kind == EXPERIMENT:
            params_with(**params_of(options))
        return self.work.cells(options, batch=batch)


def find(name: str) -> Found:
    """The experiment or study of this name. Raises WrongUse if there is none."""
    entry = entry_of("experiment or study", {**ROBOT, **SIMULATED, **BODIES, **STUDIES}, name)
    kind = next(kind for kind, (table, _, _) in KINDS.items() if name in table)
    _, works, figures = KINDS[kind]
    module = "." + name.replace("-", "_")
    work = cast("Experiment", importlib.import_module(works + module))
    return Found(kind, entry, work, figures + module)
