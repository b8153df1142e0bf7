"""The table of the experiment `bifurcation`: its cells, its rows, and the rows of each part."""

from __future__ import annotations

from typing import Literal, TypedDict

# A point of the branch counts if k stayed, and the wheel had the speed asked for, to this share.
HELD_WITHIN = 0.04


class SweepCell(TypedDict):
    """k goes from high to low and back.

    Attributes:
        motion: forward or backward.
        trial: number of the repetition, from 0.
    """

    part: Literal["sweep"]
    motion: str
    trial: int


class FoldCell(TypedDict):
    """k goes down until both wheels rest.

    Attributes:
        motion: forward or backward.
        trial: number of the repetition, from 0.
    """

    part: Literal["fold"]
    motion: str
    trial: int


class BranchCell(TypedDict):
    """Feedback on k holds one wheel at a speed.

    Attributes:
        motion: forward or backward.
        held_hz: the speed (turns per second), without sign.
    """

    part: Literal["branch"]
    motion: str
    held_hz: float


class RampCell(TypedDict):
    """The torque of a robot at rest rises until both wheels have moved.

    Attributes:
        trial: number of the repetition, from 0.
    """

    part: Literal["ramp"]
    trial: int


class WheelMotion(TypedDict):
    """One wheel over a stretch of time.

    Attributes:
        side: left or right.
        hz: mean speed (turns per second), forward positive.
        torque: mean relative torque M (1).
        torque_sd: standard deviation of M (1).
        duty_pct: mean duty cycle (%).
        rests: whether the wheel rested.
    """

    side: str
    hz: float
    torque: float
    torque_sd: float
    duty_pct: float
    rests: bool


class SettledMotion(WheelMotion):
    """One wheel that had time to become steady.

    Attributes:
        steady: whether the wheel became steady in that time.
    """

    steady: bool


class Step(SettledMotion):
    """One wheel at one step of a sweep.

    Attributes:
        way: `down` or `up`, the direction in which k goes.
        k: spring constant (1).
    """

    way: Literal["down", "up"]
    k: float


class LastStep(SettledMotion):
    """The last step at which a wheel turned steadily.

    Attributes:
        k: spring constant there (1).
    """

    k: float


class Fall(LastStep):
    """A wheel's last steady step before it came to rest.

    Attributes:
        k_after: spring constant at which it rested (1).
        torque_after: mean relative torque M there (1).
    """

    k_after: float
    torque_after: float


class HeldCycle(WheelMotion):
    """A limit cycle that feedback on k held.

    Attributes:
        k: mean of k while the cycle was measured (1).
        k_sd: standard deviation of k (1).
        free_hz: speed (turns per second) some time after k was frozen at its mean.
        free_torque: mean relative torque M then (1).
    """

    k: float
    k_sd: float
    free_hz: float
    free_torque: float


class Ramp(TypedDict):
    """What the torque's rise showed.

    Attributes:
        torque: mean |M| at which the wheels moved (1).
        holds: whether R5 holds for this rise.
        note: at which |M| each wheel rested and moved, in words.
    """

    torque: float
    holds: bool
    note: str


class SweepRow(SweepCell, Step):
    """A row of part `sweep`."""


class FoldRow(FoldCell, Fall):
    """A row of part `fold`."""


class BranchRow(BranchCell, HeldCycle):
    """A row of part `branch`."""


class RampRow(RampCell, Ramp):
    """A row of part `ramp`."""


BifurcationCell = SweepCell | FoldCell | BranchCell | RampCell
BifurcationRow = SweepRow | FoldRow | BranchRow | RampRow
CellRows = list[Step] | list[Fall] | list[HeldCycle] | list[Ramp]


def sweep_rows(rows: list[BifurcationRow]) -> list[SweepRow]:
    """The rows of part `sweep`."""
    return [row for row in rows if row["part"] == "sweep"]


def fold_rows(rows: list[BifurcationRow]) -> list[FoldRow]:
    """The rows of part `fold`."""
    return [row for row in rows if row["part"] == "fold"]


def branch_rows(rows: list[BifurcationRow]) -> list[BranchRow]:
    """The rows of part `branch`."""
    return [row for row in rows if row["part"] == "branch"]


def ramp_rows(rows: list[BifurcationRow]) -> list[RampRow]:
    """The rows of part `ramp`."""
    return [row for row in rows if row["part"] == "ramp"]


def is_held(row: BranchRow) -> bool:
    """Whether the feedback held the wheel at its speed, with k at rest."""
    held_hz = row["held_hz"]
    k_rests = row["k_sd"] <= HELD_WITHIN * row["k"]
    return k_rests and abs(abs(row["hz"]) - held_hz) <= HELD_WITHIN * held_hz


def held_cycles(rows: list[BifurcationRow]) -> list[BranchRow]:
    """The points of the branch of limit cycles."""
    return [row for row in branch_rows(rows) if is_held(row)]


def least_k(cycles: list[BranchRow]) -> BranchRow | None:
    """The point of least k, the saddle-node; None without points. Slower points are unstable."""
    return min(cycles, key=lambda row: row["k"], default=None)


def restarts(rows: list[BifurcationRow]) -> list[float]:
    """The least k at which each wheel ran again in each upward sweep."""
    least: dict[tuple[int, str, str], float] = {}
    for row in sweep_rows(rows):
        if row["way"] == "up" and not row["rests"]:
            wheel = row["trial"], row["motion"], row["side"]
            least[wheel] = min(row["k"], least.get(wheel, row["k"]))
    return [least[wheel] for wheel in sorted(least)]
