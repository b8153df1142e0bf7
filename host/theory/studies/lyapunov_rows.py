"""The cells and rows of the studies `lyapunov`, `lyapunov-line` and `lyapunov-plane`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.attractors import Kind
from host.theory.analysis.bifurcations import BifurcationType

# Wheels start in random states, or roll at constant velocity, a little disturbed.
StartKind = Literal["any", "rolls"]
ANY: StartKind = "any"
ROLLS: StartKind = "rolls"


class PointCell(TypedDict):
    """The whole spectrum at (k, tau), of a batch of wheels.

    Attributes:
        batch: number of the batch.
        seconds: how long each wheel is followed (s).
    """

    part: Literal["point"]
    batch: int
    seconds: float


class SeriesCell(TypedDict):
    """Time series of one wheel at (k, tau)."""

    part: Literal["series"]


class GridCell(TypedDict):
    """Attractors and largest exponents along k (line) or over the plane (k, tau).

    Attributes:
        part: line or plane.
        first: number of the first k of a line, or of the first tau of the plane.
    """

    part: Literal["line", "plane"]
    first: int


class RollingCell(TypedDict):
    """Where rolling loses its stability, along k."""

    part: Literal["rolling"]


class LivesCell(TypedDict):
    """How long wheels switch, close to the least k with chaos.

    Attributes:
        offset: k of these wheels, relative to the least k with chaos (1).
    """

    part: Literal["lives"]
    offset: float


class CheckCell(TypedDict):
    """Points of the plane, with ordinary steps and with half of these."""

    part: Literal["check"]


class Block(TypedDict):
    """Exponents of one wheel over one block of time.

    Attributes:
        wheel: number of the wheel in its batch.
        kind: its attractor before the measurement.
        kind_after: its attractor after the measurement.
        omega_mean: mean of omega after the measurement (rad/s).
        omega_std: standard deviation of omega after the measurement (rad/s).
        block: number of the block.
        along_flow: whether exponent_1 is that along the flow.
        exponent_1: Lyapunov exponent along the flow, 0 in the long run; of a wheel that rests,
            the largest (1/s).
        exponent_2: the largest of the other exponents (1/s).
        exponent_3: the next exponent (1/s).
        exponent_4: the least exponent (1/s).
        by_pairs: largest exponent, from pairs of close wheels (1/s).
    """

    wheel: int
    kind: Kind
    kind_after: Kind
    omega_mean: float
    omega_std: float
    block: int
    along_flow: bool
    exponent_1: float
    exponent_2: float
    exponent_3: float
    exponent_4: float
    by_pairs: float


class SeriesSample(TypedDict):
    """One moment of a time series.

    Attributes:
        t_s: time (s).
        phi_rad: angle (rad).
        omega: angular velocity (rad/s).
        force: tangential force of the rods (1).
    """

    t_s: float
    phi_rad: float
    omega: float
    force: float


class Attractor(TypedDict):
    """The attractor of one wheel.

    Attributes:
        kind: at rest, forth-and-back, rolling or chaotic.
        exponent: largest Lyapunov exponent (1/s).
        omega_mean: mean of omega (rad/s).
        omega_std: standard deviation of omega (rad/s).
    """

    kind: Kind
    exponent: float
    omega_mean: float
    omega_std: float


class GridPoint(Attractor):
    """The attractor of one wheel at a point of the line or the plane.

    Attributes:
        tau: time constant of the membrane potentials (s).
        k: spring constant.
        start: how the wheel starts, any or rolls.
    """

    tau: float
    k: float
    start: StartKind


class RollingEnd(TypedDict):
    """The last stable rotation as k rises.

    Attributes:
        k: spring constant.
        k_off_by: relative difference of k if located with shorter steps.
        type: of the bifurcation at which the rotation loses its stability.
        omega_mean: mean speed there (rad/s).
        above: what most wheels do a little above.
    """

    k: float
    k_off_by: float
    type: BifurcationType
    omega_mean: float
    above: Kind


class Life(TypedDict):
    """How long one wheel switches.

    Attributes:
        k: spring constant.
        life_s: when the wheel turned round for the last time (s).
        ended: whether it was followed long enough to see that it switches no more.
    """

    k: float
    life_s: float
    ended: bool


class StepCheck(Attractor):
    """An attractor with ordinary steps, and with half of these.

    Attributes:
        tau: time constant of the membrane potentials (s).
        k: spring constant.
        kind_finer: kind with half the step.
        exponent_finer: exponent with half the step (1/s).
        speed_off_by: difference of |omega_mean| (rad/s).
    """

    tau: float
    k: float
    kind_finer: Kind
    exponent_finer: float
    speed_off_by: float


class BlockRow(PointCell, Block):
    """A row of part `point`."""


class SeriesRow(SeriesCell, SeriesSample):
    """A row of part `series`."""


class GridRow(GridCell, GridPoint):
    """A row of parts `line` and `plane`."""


class RollingEndRow(RollingCell, RollingEnd):
    """A row of part `rolling`."""


class LifeRow(LivesCell, Life):
    """A row of part `lives`."""


class StepCheckRow(CheckCell, StepCheck):
    """A row of part `check`."""


LyapunovCell = PointCell | SeriesCell
LyapunovRow = BlockRow | SeriesRow
LineCell = GridCell | RollingCell | LivesCell
LineRow = GridRow | RollingEndRow | LifeRow
PlaneCell = GridCell | CheckCell
PlaneRow = GridRow | StepCheckRow


def blocks_of(rows: Iterable[LyapunovRow]) -> list[BlockRow]:
    """The rows of part `point`."""
    return [row for row in rows if row["part"] == "point"]


def series_of(rows: Iterable[LyapunovRow]) -> list[SeriesRow]:
    """The rows of part `series`, in the order of time."""
    return [row for row in rows if row["part"] == "series"]


def line_of(rows: Iterable[LineRow]) -> list[GridRow]:
    """The rows of part `line`."""
    return [row for row in rows if row["part"] == "line"]


def plane_of(rows: Iterable[PlaneRow]) -> list[GridRow]:
    """The rows of part `plane`."""
    return [row for row in rows if row["part"] == "plane"]


def rolling_end_of(rows: Iterable[LineRow]) -> RollingEndRow | None:
    """The row of part `rolling`; None if rolling does not end."""
    return next((row for row in rows if row["part"] == "rolling"), None)


def lives_of(rows: Iterable[LineRow]) -> dict[float, list[LifeRow]]:
    """The rows of part `lives`, by k."""
    found: dict[float, list[LifeRow]] = {}
    for row in rows:
        if row["part"] == "lives":
            found.setdefault(row["k"], []).append(row)
    return found


def step_checks(rows: Iterable[PlaneRow]) -> list[StepCheckRow]:
    """The rows of part `check`."""
    return [row for row in rows if row["part"] == "check"]
