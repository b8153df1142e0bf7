"""The table of the experiment `timeline`: its rows, and the rows of each kind."""

from __future__ import annotations

from typing import Literal, NamedTuple, TypedDict


class Cell(TypedDict):
    """One round of all kicks, each there and back.

    Attributes:
        trial: number of the round, from 0.
    """

    trial: int


class Slip(TypedDict):
    """How the wheels settled after a kick, and how their relative phase changed.

    The relative phase is the left wheel's angle less the right wheel's. Where a wheel did not
    settle, what depends on it is None.

    Attributes:
        settling_left_s: time from the kick's beginning until the left wheel settled (s).
        settling_right_s: the same for the right wheel (s).
        relative_before_rad: relative phase before the kick (rad), from -pi to pi.
        relative_after_rad: relative phase after both wheels settled (rad), from -pi to pi.
        slip_rad: change of the relative phase from before to after (rad).
        drift_rad: its change in a time as long before the kick (rad).
    """

    settling_left_s: float | None
    settling_right_s: float | None
    relative_before_rad: float
    relative_after_rad: float | None
    slip_rad: float | None
    drift_rad: float | None


class Kick(Slip):
    """One kick.

    Attributes:
        mode: membrane, position or phase.
        turn: 1 for there, 2 for back.
        ticks: length in ticks.
        kick_s: length (s).
        reversed: whether the robot ran the other way afterwards.
    """

    kind: Literal["kick"]
    mode: str
    turn: int
    ticks: int
    kick_s: float
    reversed: bool


class Tick(TypedDict):
    """One tick around the two kicks of a mode, in the first round only.

    Attributes:
        mode: mode of the kicks.
        t_s: time since the first of the two kicks (s).
        kicked: whether a kick acted in this tick.
        relative_rad: relative phase of the wheels (rad).
        left_x1: membrane potential of the left wheel's first neuron (1).
        left_x2: membrane potential of the left wheel's second neuron (1).
        left_torque: relative torque M of the left wheel (1).
        right_x1: membrane potential of the right wheel's first neuron (1).
        right_x2: membrane potential of the right wheel's second neuron (1).
        right_torque: relative torque M of the right wheel (1).
    """

    kind: Literal["tick"]
    mode: str
    t_s: float
    kicked: bool
    relative_rad: float
    left_x1: float
    left_x2: float
    left_torque: float
    right_x1: float
    right_x2: float
    right_torque: float


class KickRow(Cell, Kick):
    """A row of kind `kick`."""


class TickRow(Cell, Tick):
    """A row of kind `tick`."""


class SettledKick(NamedTuple):
    """A kick that reversed the robot and after which both wheels settled.

    Attributes:
        kick_s: length of the kick (s).
        settling_s: time from the kick's beginning until the slower wheel settled (s).
        before_rad: relative phase before the kick (rad).
        after_rad: relative phase after both wheels settled (rad).
        slip_rad: change of the relative phase (rad).
        drift_rad: its change in a time as long before the kick (rad).
    """

    kick_s: float
    settling_s: float
    before_rad: float
    after_rad: float
    slip_rad: float
    drift_rad: float


TimelineRow = KickRow | TickRow


def kick_rows(rows: list[TimelineRow], mode: str | None = None) -> list[KickRow]:
    """The kicks, of one mode or of all."""
    kicks = [row for row in rows if row["kind"] == "kick"]
    return [row for row in kicks if mode in (None, row["mode"])]


def settled_kicks(kicks: list[KickRow]) -> list[SettledKick]:
    """Those of the kicks that reversed the robot and after which both wheels settled."""
    found = []
    for row in kicks:
        left_s, right_s = row["settling_left_s"], row["settling_right_s"]
        after, slip, drift = row["relative_after_rad"], row["slip_rad"], row["drift_rad"]
        if not row["reversed"] or left_s is None or right_s is None:
            continue
        if after is None or slip is None or drift is None:
            continue
        before = row["relative_before_rad"]
        settling_s = max(left_s, right_s)
        found.append(SettledKick(row["kick_s"], settling_s, before, after, slip, drift))
    return found


def tick_rows(rows: list[TimelineRow], mode: str) -> list[TickRow]:
    """The ticks around the kicks of a mode."""
    return [row for row in rows if row["kind"] == "tick" and row["mode"] == mode]
