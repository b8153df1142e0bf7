"""What an experiment is: a module with these functions, and one among the figures with draw(rows, findings), which returns a Figure.

Its work is a list of cells, each of which can be done by itself.

A cell is plain data that says what to do, a row plain data that came of it; both survive JSON
unchanged, and what is unknown is None.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

from host.client.robot import Robot
from host.logs.log import Log
from host.runs.claims import Claim
from sim_motor.constants import load

Cell = dict[str, Any]
Row = dict[str, Any]
Options = dict[str, Any]


@dataclass(frozen=True)
class Setting:
    """What all cells of a run share; plain data, which can go to another process.

    motor, battery_v: of the simulated brick, as in sim://?motor=NAME&battery=V.
    """

    seed: int
    options: Options
    motor: str = "pybricks"
    battery_v: float | None = None

    def seed_of(self, cell: Mapping[str, Any]) -> int:
        """A cell's own seed: the same whatever else is done before it, or by whom."""
        text = json.dumps([self.seed, cell], sort_keys=True)
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")

    def elsewhere(self, **own: Any) -> str:
        """Why this run cannot decide a claim: it is not at the parameters that the claim is made for.

        Args:
            own: The options at which the claim is made. A claim about a simulated robot is made for
                the default motor and a battery of nominal voltage; one about the model has neither.

        Returns:
            Words that name the claim's parameters; empty if this run is at them.
        """
        made_for = [
            f"{name} = {_word(value)} (here {_word(self.options[name])})"
            for name, value in own.items()
            if self.options[name] != value
        ]
        if self.motor != Setting.motor:
            made_for.append(f"motor = {Setting.motor} (here {self.motor})")
        if self.battery_v not in (None, nominal_v := load(self.motor).battery_v):
            made_for.append(f"battery = {nominal_v:g} V (here {self.battery_v:g} V)")
        return "the claim is made for " + ", ".join(made_for) if made_for else ""

    def short_of(self, **least: float) -> str:
        """Why this run cannot decide a claim: it is too short, or has too few trials.

        Args:
            least: The options on which the claim depends, and what each must be at least.

        Returns:
            Words that name what it takes; empty if this run is long enough.
        """
        missing = [
            f"{name} = {value:g} or more (here {self.options[name]:g})"
            for name, value in least.items()
            if self.options[name] is not None and self.options[name] < value
        ]
        return "to decide takes " + ", ".join(missing) if missing else ""


def _word(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float | int) else str(value)


@dataclass(frozen=True)
class Findings:
    """What an experiment found: the paper's claims it speaks to, other numbers worth telling, and texts to keep as files by name.

    numbers: a dictionary, or a list of them, of plain data.
    """

    claims: list[Claim]
    numbers: Any
    files: dict[str, str] = field(default_factory=dict)


class Experiment(Protocol):
    """The module of an experiment.

    simulate is None if the experiment runs through a robot's whole loop on the simulated brick too.
    An experiment on simulated bodies, and a study of the analytic model, is for no robot and has
    neither world nor trial.
    """

    simulate: Callable[[Cell, Setting], list[Row]] | None

    def cells(self, options: Options, *, batch: bool) -> list[Cell]:
        """The work in pieces, in the order of the table. batch.

        For `simulate`, whose pieces may be larger than a robot's.
        """

    def world(self, cell: Cell) -> dict[str, str]:
        """What a simulated brick needs for this cell: options of sim://.

        What a person has to see to on a real one.
        """

    def trial(self, cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
        """Do one cell on a robot that runs; `log` taps it meanwhile. Raises KickctlError."""

    def report(self, rows: list[Row], setting: Setting) -> Findings:
        """What the rows, each with its cell's fields, come to."""
