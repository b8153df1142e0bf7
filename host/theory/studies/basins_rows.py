"""The cells and rows of the study `basins`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.outcomes import Outcome
from host.theory.engine.sampled import Clock
from robot.params import Params

ModelName = Literal["continuous", "sampled"]
CONTINUOUS: ModelName = "continuous"
SAMPLED: ModelName = "sampled"
MODEL_NAMES: tuple[ModelName, ...] = (CONTINUOUS, SAMPLED)
# The clock of the sampled model.
CLOCK = Clock(Params().tick_s)
# The lengths of kicks, s, and the phases of rolling at which each is tried.
LENGTHS_S: dict[ModelName, list[float]] = {
    CONTINUOUS: [round(0.005 * number, 3) for number in range(81)],
    SAMPLED: [CLOCK.tick_s * ticks for ticks in range(13)],
}
PHASES = 180


class StartsCell(TypedDict):
    """A band of the grid of starts.

    Attributes:
        model: continuous or sampled.
        band: number of the band's first line of equal omega.
    """

    part: Literal["starts"]
    model: ModelName
    band: int


class KicksCell(TypedDict):
    """One kind of kick, at all lengths and phases.

    Attributes:
        model: continuous or sampled.
        mode: the kick's mode, see robot/kicks.py.
        sign: sign of a phase kick's shift; 0 for kicks without one.
    """

    part: Literal["kicks"]
    model: ModelName
    mode: str
    sign: int


class SureCell(TypedDict):
    """The lengths of one kind of quenched kick that reverse the continuous wheel at every phase.

    Attributes:
        model: continuous.
        mode: the kick's mode, see robot/kicks.py.
        sign: sign of a phase kick's shift; 0 for kicks without one.
    """

    part: Literal["sure"]
    model: ModelName
    mode: str
    sign: int


class CheckCell(TypedDict):
    """Some starts, computed by other means.

    Attributes:
        model: continuous or sampled.
    """

    part: Literal["check"]
    model: ModelName


class Start(TypedDict):
    """What a wheel comes to from a start with the potentials of rest.

    Attributes:
        phi: angle at the start (rad).
        omega: angular velocity at the start (rad/s).
        outcome: what the wheel does in the end.
        quarters: number of the well that the wheel ends in, in quarter turns from phi = 0, full
            turns included; None if it ends in none, and without springs, which make the wells.
    """

    phi: float
    omega: float
    outcome: Outcome
    quarters: int | None


class Kick(TypedDict):
    """What a wheel that rolls forward comes to after a kick.

    Attributes:
        length_s: length of the kick (s); 0 for a kick without a length.
        phase_deg: phase of rolling at which it comes: the angle within a quarter turn (degrees).
        outcome: what the wheel does in the end.
    """

    length_s: float
    phase_deg: float
    outcome: Outcome


class Sure(TypedDict):
    """A range of lengths of a kick that reverse the wheel at every phase.

    Attributes:
        from_s: the least length (s).
        to_s: the greatest length (s).
    """

    from_s: float
    to_s: float


class Check(TypedDict):
    """The share of starts on the grid that come to the same by other means.

    Attributes:
        turned: of wheels a quarter turn ahead (1).
        mirrored: of wheels in the mirror (1).
        finer: with half the step (1); None for the sampled model, which has no step.
        angle_off: by how much the angles of some wheels differ after a short time if another
            program computes them (rad).
    """

    turned: float
    mirrored: float
    finer: float | None
    angle_off: float


class StartRow(StartsCell, Start):
    """A row of a start."""


class KickRow(KicksCell, Kick):
    """A row of a kick."""


class SureRow(SureCell, Sure):
    """A row of sure lengths."""


class CheckRow(CheckCell, Check):
    """A row of a check."""


BasinsCell = StartsCell | KicksCell | SureCell | CheckCell
BasinsRow = StartRow | KickRow | SureRow | CheckRow
Measured = list[Start] | list[Kick] | list[Sure] | list[Check]


def starts_of(rows: Iterable[BasinsRow], model: ModelName) -> list[StartRow]:
    """The starts of a model, the slowest first."""
    return [row for row in rows if row["part"] == "starts" and row["model"] == model]


def kicks_of(rows: Iterable[BasinsRow], model: ModelName, mode: str, sign: int) -> list[KickRow]:
    """The kicks of one kind, sorted by length and phase."""
    return [
        row
        for row in rows
        if row["part"] == "kicks"
        and (row["model"], row["mode"], row["sign"]) == (model, mode, sign)
    ]


def sure_of(rows: Iterable[BasinsRow], mode: str, sign: int) -> list[SureRow]:
    """The sure lengths of a kick of the continuous wheel, ascending."""
    return [
        row for row in rows if row["part"] == "sure" and (row["mode"], row["sign"]) == (mode, sign)
    ]


def check_of(rows: Iterable[BasinsRow], model: ModelName) -> CheckRow:
    """The check of a model."""
    return next(row for row in rows if row["part"] == "check" and row["model"] == model)
