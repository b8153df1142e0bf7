"""The cells and rows of the study `tick`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

# The order within a tick: the torque follows from the new potentials, or from those of the tick
# before.
Order = Literal["new", "old"]
NEW: Order = "new"
OLD: Order = "old"
ORDERS: tuple[Order, ...] = (NEW, OLD)
Continuous = Literal["continuous"]
CONTINUOUS: Continuous = "continuous"


class LimitCell(TypedDict):
    """The continuous model."""

    part: Literal["limit"]
    order: Continuous


class GrowthCell(TypedDict):
    """Growth rates along k.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before; continuous, without ticks.
    """

    part: Literal["growth"]
    order: Order | Continuous


class PointCell(TypedDict):
    """Thresholds at the study's own tick and latency.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before.
    """

    part: Literal["point"]
    order: Order


class ShortCell(TypedDict):
    """k_c at ticks that approach zero, without latency.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before.
    """

    part: Literal["short"]
    order: Order


class CheckCell(TypedDict):
    """Other methods, at the study's own tick and latency.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before.
    """

    part: Literal["check"]
    order: Order


class TickCell(TypedDict):
    """One order, with another tick.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before.
        tick_s: length of the tick (s).
    """

    part: Literal["tick"]
    order: Order
    tick_s: float


class LatencyCell(TypedDict):
    """One order, with another latency.

    Attributes:
        order: new, the torque follows from the new potentials; old, from those of the tick
            before.
        latency_s: how long after the start of its tick a torque acts (s).
    """

    part: Literal["latency"]
    order: Order
    latency_s: float


class Motion(TypedDict):
    """Thresholds of rolling, and its speed. What does not exist is None.

    Attributes:
        k_rolls: spring constant at which swinging turns into rolling as k rises.
        k_stops: spring constant at which rolling ends as k falls.
        hz: turns per second at k = 8 (Hz).
    """

    k_rolls: float | None
    k_stops: float | None
    hz: float | None


class Limit(Motion):
    """Thresholds of the continuous model.

    Attributes:
        k_c: spring constant of the Hopf bifurcation.
        note: why there is no motion in this row; None if there is.
    """

    k_c: float
    note: str | None


class Thresholds(Motion):
    """Thresholds of a sampled wheel.

    Attributes:
        k_c: spring constant at which rest becomes unstable; 0 if it always is, None if it never is
            or the neurons run away.
        modulus: of the leading multiplier at k_c (1).
        angle: of the leading multiplier at k_c (rad per tick).
    """

    k_c: float | None
    modulus: float | None
    angle: float | None


class Growth(TypedDict):
    """How a small swing grows.

    Attributes:
        k: spring constant.
        growth_per_s: growth rate (1/s).
        hz: frequency (Hz).
    """

    k: float
    growth_per_s: float
    hz: float


class ShortTick(TypedDict):
    """A tick much shorter than tau.

    Attributes:
        tick_s: length of the tick (s).
        k_c: spring constant at which rest becomes unstable.
    """

    tick_s: float
    k_c: float | None


class Check(TypedDict):
    """Relative differences to other methods; None where there is nothing to compare.

    Attributes:
        jacobian_off: greatest difference of the Jacobian to central differences (SI).
        k_c_off: of k_c to time courses (1).
        onset_off: of k_rolls and k_stops if wheels are followed twice as long (1).
    """

    jacobian_off: float | None
    k_c_off: float | None
    onset_off: float | None


class LimitRow(LimitCell, Limit):
    """The row of the continuous model."""


class GrowthRow(GrowthCell, Growth):
    """A row of a growth rate's curve."""


class PointRow(PointCell, Thresholds):
    """The row at the study's own tick and latency."""


class TickRow(TickCell, Thresholds):
    """A row of another tick."""


class LatencyRow(LatencyCell, Thresholds):
    """A row of another latency."""


class ShortTickRow(ShortCell, ShortTick):
    """A row of a tick that approaches zero."""


class CheckRow(CheckCell, Check):
    """The row of other methods."""


TickStudyCell = LimitCell | GrowthCell | PointCell | ShortCell | CheckCell | TickCell | LatencyCell
TickStudyRow = LimitRow | GrowthRow | PointRow | ShortTickRow | CheckRow | TickRow | LatencyRow
Measured = list[Limit] | list[Growth] | list[Thresholds] | list[ShortTick] | list[Check]


def limit_of(rows: Iterable[TickStudyRow]) -> LimitRow:
    """The row of the continuous model."""
    return next(row for row in rows if row["part"] == "limit")


def motions(rows: list[TickStudyRow]) -> list[Motion]:
    """All rows with the thresholds and the speed of rolling."""
    found: list[Motion] = [limit_of(rows)]
    for order in ORDERS:
        found += [point_of(rows, order), *over_ticks(rows, order), *over_latencies(rows, order)]
    return found


def growth_of(rows: Iterable[TickStudyRow], order: Order | Continuous) -> list[GrowthRow]:
    """The growth rates along k."""
    return [row for row in rows if row["part"] == "growth" and row["order"] == order]


def point_of(rows: Iterable[TickStudyRow], order: Order) -> PointRow:
    """The row at the study's own tick and latency."""
    return next(row for row in rows if row["part"] == "point" and row["order"] == order)


def check_of(rows: Iterable[TickStudyRow], order: Order) -> CheckRow:
    """The row of other methods."""
    return next(row for row in rows if row["part"] == "check" and row["order"] == order)


def short_ticks(rows: Iterable[TickStudyRow], order: Order) -> list[ShortTickRow]:
    """The rows of ticks that approach zero, each half as long as the one before."""
    return [row for row in rows if row["part"] == "short" and row["order"] == order]


def over_ticks(rows: Iterable[TickStudyRow], order: Order) -> list[TickRow]:
    """The rows of other ticks, the shortest first."""
    return [row for row in rows if row["part"] == "tick" and row["order"] == order]


def over_latencies(rows: Iterable[TickStudyRow], order: Order) -> list[LatencyRow]:
    """The rows of other latencies, the shortest first."""
    return [row for row in rows if row["part"] == "latency" and row["order"] == order]
