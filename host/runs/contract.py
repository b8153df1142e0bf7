"""What an experiment is, and what its cells share.

An experiment is a module with the functions of `Experiment`, and a module in figures/ with
draw(rows, findings), which returns a Figure. Its work is a list of independent cells. A cell is
plain data that says what to do; a row is plain data that results from it. Both survive JSON
unchanged, and None stands for what is unknown.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

from host.client.robot import Robot
from host.logs.log import Log
from host.runs.answers import Answer
from host.runs.claims import Claim
from host.runs.presets import OPTION, ORDINARY, PRESETS, Preset
from host.runs.robot_options import params_of, params_with
from robot.params import Params
from sim_motor.constants import Constants, load

Cell = dict[str, Any]
Row = dict[str, Any]
Options = dict[str, Any]
# Where a cell of a sweep says at which options it is, and which cell of the experiment.
POINT, OWN = "at", "cell"


class Part(NamedTuple):
    """A part of a cell that is complete. A cell of more than some seconds has several.

    Attributes:
        rows: Its rows. Those of all parts, one after the other, are the cell's.
        state: What the next part begins with, as plain data.
        share: How much of the cell is complete with it; 1 for the last part.
    """

    rows: list[Row]
    state: Any = None
    share: float = 1.0


def as_rows(found: Iterable[Mapping[str, Any]]) -> list[Row]:
    """Rows of any kind as plain dictionaries."""
    return [dict(row) for row in found]


# Computes a cell part by part, on from the rows and the last state of those that are complete; None
# for a cell that has not begun.
Parts = Callable[[Cell, "Setting", Part | None], Iterator[Part]]


@dataclass(frozen=True)
class Setting:
    """What all cells of a run share: plain data, which can go to another process.

    Attributes:
        seed: The random seed of the run.
        options: The run's own options by name.
        motor: The motor of the simulated brick, as in sim://?motor=NAME.
        battery_v: The open-circuit voltage of its battery, V; None for the motor's nominal one.
        constants: The constants of this motor, looked up where the setting was made. Cells use
            these: on another computer the user's own motor of this name may be another one.

    Raises:
        ValueError: There is no such motor.
    """

    seed: int
    options: Options
    motor: str = "pybricks"
    battery_v: float | None = None
    constants: Constants = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "constants", load(self.motor))

    @property
    def preset(self) -> Preset:
        """What differs from the ordinary setting."""
        return PRESETS[self.options.get(OPTION.name, ORDINARY)]

    def at(self, cell: Mapping[str, Any]) -> Setting:
        """The setting of a cell. In a sweep it has the options of the cell's point."""
        if POINT not in cell:
            return self
        setting = copy(self)  # with these constants: another computer's may differ
        object.__setattr__(setting, "options", {**self.options, **cell[POINT]})
        return setting

    def own_params(self) -> dict[str, float]:
        """The robot's parameters that this setting chooses, by name."""
        return {**self.preset.params, **params_of(self.options)}

    def params(self) -> Params:
        """The robot's parameters in this setting. Raises WrongUse if it would refuse them."""
        return params_with(**self.own_params())

    def seed_of(self, cell: Mapping[str, Any]) -> int:
        """The random seed of a cell. It does not depend on other cells or on the machine.

        A cell of a sweep has that of the same cell in a run of its own.
        """
        own = cell[OWN] if POINT in cell else cell
        text = json.dumps([self.seed, own], allow_nan=False, sort_keys=True)
        return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")

    def elsewhere(self, **own: Any) -> str:
        """Why this run cannot decide a claim: the claim is made for other parameters.

        Args:
            own: The options at which the claim is made, as far as the run has them. A claim about
                a simulated robot is made for the default motor and a battery of nominal voltage;
                one about the model has neither.

        Returns:
            Words that name the claim's parameters; empty if this run is at them.
        """
        made_for = [
            f"{name} = {_word(value)} (here {_word(self.options[name])})"
            for name, value in own.items()
            if self.options.get(name, value) != value
        ]
        if self.motor != Setting.motor:
            made_for.append(f"motor = {Setting.motor} (here {self.motor})")
        if self.battery_v not in (None, nominal_v := self.constants.battery_v):
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
    """What an experiment found.

    Attributes:
        claims: The paper's claims that it measured.
        numbers: Other numbers: a dictionary of plain data, or a list of dictionaries.
        files: Texts to keep as files, by the name of the file.
        answers: The main numbers, as a table for people.
    """

    claims: list[Claim]
    numbers: Any
    files: dict[str, str] = field(default_factory=dict)
    answers: list[Answer] = field(default_factory=list)


class Experiment(Protocol):
    """The module of an experiment.

    `simulate` computes a cell. It is None if the experiment runs a robot's whole loop on the
    simulated brick too. An experiment with long cells also has `parts`, of the type Parts. An
    experiment on simulated bodies and a study of the analytic model need no robot: they have
    neither `world` nor `trial`.
    """

    simulate: Callable[[Cell, Setting], list[Row]] | None

    def cells(self, options: Options, *, batch: bool) -> list[Cell]:
        """The cells, in the order of the table.

        Args:
            options: The run's own options.
            batch: Whether `simulate` does them; its cells may be larger than those of a robot.
        """

    def world(self, cell: Cell) -> dict[str, str]:
        """What surrounds the robot in this cell, as options of sim://.

        A person has to provide it for a real robot.
        """

    def trial(self, cell: Cell, robot: Robot, log: Log, setting: Setting) -> list[Row]:
        """Do one cell on a robot that runs. `log` records it meanwhile. Raises KickctlError."""

    def report(self, rows: list[Row], setting: Setting) -> Findings:
        """The findings from all rows, each with the fields of its cell."""
