"""The cells and rows of the study `fixpoints`, with the meaning of each column."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.fixpoints import Kind


class OneWheelCell(TypedDict):
    """The fixpoints of one wheel."""

    part: Literal["one wheel"]


class TwoWheelsCell(TypedDict):
    """The pairs of fixpoints of two wheels."""

    part: Literal["two wheels"]


class ForceCell(TypedDict):
    """The force of the rods on a resting wheel."""

    part: Literal["force"]


class Force(TypedDict):
    """The force at an angle.

    Attributes:
        phi: angle (rad).
        force: F_tan, in units of the spring constant (1).
    """

    phi: float
    force: float


class Rest(TypedDict):
    """A fixpoint of one wheel.

    Attributes:
        n: number of the fixpoint, from 0.
        phi: angle (rad); with two rods n pi / 4.
        kind: saddle, or stable or unstable node or focus.
        stable: whether every small disturbance dies out.
        re_0: real part of the leading eigenvalue (1/s).
        im_0: imaginary part of the leading eigenvalue (rad/s).
        re_1: real part of the second eigenvalue, in descending order (1/s).
        im_1: imaginary part of the second eigenvalue (rad/s).
        re_2: real part of the third eigenvalue, in descending order (1/s).
        im_2: imaginary part of the third eigenvalue (rad/s).
        re_3: real part of the fourth eigenvalue, in descending order (1/s).
        im_3: imaginary part of the fourth eigenvalue (rad/s).
        jacobian_off_by: greatest difference between the Jacobian and central differences (SI).
        growth_off_by: difference between re_0 and the growth in a time course (1/s).
    """

    n: int
    phi: float
    kind: Kind
    stable: bool
    re_0: float
    im_0: float
    re_1: float
    im_1: float
    re_2: float
    im_2: float
    re_3: float
    im_3: float
    jacobian_off_by: float
    growth_off_by: float


class PairOfRests(TypedDict):
    """A fixpoint of the left wheel beside one of the right wheel.

    Attributes:
        phi: angle of the left wheel (rad).
        right_phi: angle of the right wheel (rad).
        stable: whether both fixpoints are stable.
    """

    phi: float
    right_phi: float
    stable: bool


class OneWheelRow(OneWheelCell, Rest):
    """A row for one wheel."""


class TwoWheelsRow(TwoWheelsCell, PairOfRests):
    """A row for two wheels."""


class ForceRow(ForceCell, Force):
    """A row for an angle."""


FixpointsCell = OneWheelCell | TwoWheelsCell | ForceCell
FixpointsRow = OneWheelRow | TwoWheelsRow | ForceRow


def of_one_wheel(rows: Iterable[FixpointsRow]) -> list[OneWheelRow]:
    """The fixpoints of one wheel."""
    return [row for row in rows if row["part"] == "one wheel"]


def of_two_wheels(rows: Iterable[FixpointsRow]) -> list[TwoWheelsRow]:
    """The pairs of fixpoints of two wheels."""
    return [row for row in rows if row["part"] == "two wheels"]


def of_force(rows: Iterable[FixpointsRow]) -> list[ForceRow]:
    """The force by the angle."""
    return [row for row in rows if row["part"] == "force"]


def eigenvalues(row: Rest) -> list[list[float]]:
    """The four eigenvalues as (real part in 1/s, imaginary part in rad/s)."""
    return [
        [row["re_0"], row["im_0"]],
        [row["re_1"], row["im_1"]],
        [row["re_2"], row["im_2"]],
        [row["re_3"], row["im_3"]],
    ]


def of_one_kind(one: Iterable[OneWheelRow]) -> list[list[OneWheelRow]]:
    """The fixpoints that have the same eigenvalues together, in the order of the first angles."""
    groups: dict[str, list[OneWheelRow]] = {}
    for row in one:
        name = " ".join(f"{real:.6g}" for real, _ in eigenvalues(row))
        groups.setdefault(name, []).append(row)
    return list(groups.values())
