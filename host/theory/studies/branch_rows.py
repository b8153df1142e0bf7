"""The cell and rows of the study `branch`, with the meaning of each column.

`value` is everywhere the value of the constant that is followed, in the paper's units.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypedDict

from host.theory.analysis.bifurcations import BifurcationType, End

Part = Literal["fixpoints", "merging", "FB", "LLM", "dry", "line", "turning"]
# The parts that follow cycles: forth-and-back cycles, rotations, and rotations with dry friction.
CyclePart = Literal["FB", "LLM", "dry"]
CYCLE_PARTS: tuple[CyclePart, ...] = ("FB", "LLM", "dry")
# A branch that begins in the middle is followed down and up, another one way only (None).
Way = Literal["down", "up"] | None
WAYS: tuple[Way, ...] = ("down", "up", None)
# Complex numbers as (real part, imaginary part).
Pairs = list[list[float]]


class BranchCell(TypedDict):
    """One part of the study.

    Attributes:
        part: fixpoints; merging, the heteroclinic connection; FB, forth-and-back cycles; LLM,
            rotations; dry, rotations with dry friction; line, the merging over tau; turning, the
            potentials of a turning wheel.
    """

    part: Part


class Rest(TypedDict):
    """A fixpoint at one value of the constant.

    Attributes:
        value: of the constant that is followed (in its unit).
        phi: angle (rad).
        stable: whether every small disturbance dies out.
        eigenvalues: the leading one first (1/s).
        formula: omega of the constant-velocity formula (rad/s); None where it has none.
    """

    kind: Literal["fixpoint"]
    value: float
    phi: float
    stable: bool
    eigenvalues: Pairs
    formula: float | None


class HopfPoint(TypedDict):
    """A Hopf bifurcation of the fixpoint at phi = 0.

    Attributes:
        value: of the constant that is followed (in its unit).
        period: of the cycles that are born (s).
        omega_mean: their mean speed, 0 (rad/s).
        amplitude: their amplitude, 0 (rad).
        l1: first Lyapunov coefficient; negative if the cycles are born stable.
        multipliers: their Floquet multipliers, without the trivial one.
        off_by: relative difference of k to the closed form.
    """

    kind: Literal["special"]
    type: Literal["hopf"]
    value: float
    period: float
    omega_mean: float
    amplitude: float
    l1: float
    multipliers: Pairs
    off_by: float


class MergingPoint(TypedDict):
    """A merging: a heteroclinic connection of neighbouring saddles.

    Attributes:
        value: of the constant that is followed (in its unit).
        omega_mean: mean speed of the cycles that end here, 0 (rad/s).
        multipliers: none.
        saddle_quantity: sum of the two leading real parts (1/s); negative if cycles close to
            the merging are stable.
        eigenvalues: of the saddle, the leading one first (1/s).
        passes_above: whether wheels roll above the merging, not below.
        off_by: relative difference to the same with another start and shorter steps.
    """

    kind: Literal["special"]
    type: Literal["merging"]
    value: float
    omega_mean: float
    multipliers: Pairs
    saddle_quantity: float
    eigenvalues: Pairs
    passes_above: bool
    off_by: float | None


class CycleColumns(TypedDict):
    """A cycle, stable or not.

    Attributes:
        value: of the constant that is followed (in its unit).
        x1: potential at phi = 0 (1).
        x2: potential at phi = 0 (1).
        omega: angular velocity at phi = 0 (rad/s).
        period: of the whole cycle (s).
        omega_mean: mean of omega (rad/s).
        omega_std: standard deviation of omega (rad/s).
        omega_min: least omega (rad/s).
        omega_max: greatest |omega| (rad/s).
        formula: omega of the constant-velocity formula (rad/s); None where it has none.
        amplitude: greatest |phi| of a forth-and-back cycle (rad); None for a rotation.
        stable: whether all multipliers are inside the unit circle.
        reduced_multipliers: of the reduced map (see host.theory.analysis.cycles).
        multipliers: Floquet multipliers of the whole period, without the trivial one.
        off_by: error of the product of the reduced multipliers; in a row of a bifurcation,
            relative difference of its value if located with shorter steps.
    """

    value: float
    x1: float
    x2: float
    omega: float
    period: float
    omega_mean: float
    omega_std: float
    omega_min: float
    omega_max: float
    formula: float | None
    amplitude: float | None
    stable: bool
    reduced_multipliers: Pairs
    multipliers: Pairs
    off_by: float


class Cycle(CycleColumns):
    """A cycle of a branch.

    Attributes:
        way: the direction in which the branch is followed.
    """

    way: Way
    kind: Literal["cycle"]


class CyclePoint(CycleColumns):
    """A bifurcation of a cycle.

    Attributes:
        way: the direction in which the branch is followed.
        type: fold, pitchfork or Neimark-Sacker.
    """

    way: Way
    kind: Literal["special"]
    type: BifurcationType


class BranchEnd(TypedDict):
    """Where a branch ends.

    Attributes:
        way: the direction in which the branch is followed.
        type: why it ends (see host.theory.analysis.bifurcations).
        value: of the constant that is followed (in its unit).
        period: of the last cycle (s).
    """

    way: Way
    kind: Literal["end"]
    type: End
    value: float
    period: float


class FormulaEdge(TypedDict):
    """A rotation whose mean speed the constant-velocity formula just misses by 5 %.

    Attributes:
        way: the direction in which the branch is followed.
        value: of the constant that is followed (in its unit).
    """

    way: Way
    kind: Literal["edge"]
    value: float


class NoBranch(TypedDict):
    """A branch that does not exist.

    Attributes:
        why: the reason in words.
    """

    kind: Literal["end"]
    type: Literal["none"]
    why: str


class SteppedCycle(TypedDict):
    """A stable cycle compared with time stepping.

    Attributes:
        way: the direction in which the branch is followed.
        value: of the constant that is followed (in its unit).
        period: of the cycle (s).
        omega_mean: mean of omega (rad/s).
        omega_std: standard deviation of omega (rad/s).
        stepped_mean: mean of omega by time stepping (rad/s).
        stepped_std: standard deviation of omega by time stepping (rad/s).
        off_by: the greater of the two differences (rad/s).
    """

    way: Way
    kind: Literal["check"]
    value: float
    period: float
    omega_mean: float
    omega_std: float
    stepped_mean: float
    stepped_std: float
    off_by: float


class LinePoint(TypedDict):
    """The merging of least k at another time constant.

    Attributes:
        tau: time constant of the membrane potentials (s).
        k: spring constant of the merging.
        k_hopf: spring constant of the Hopf bifurcation.
        saddle_quantity: at the merging (1/s).
    """

    kind: Literal["line"]
    tau: float
    k: float
    k_hopf: float
    saddle_quantity: float


class NeutralPoint(TypedDict):
    """Where the saddle quantity at the merging changes its sign.

    Attributes:
        tau: time constant of the membrane potentials (s).
    """

    kind: Literal["neutral"]
    tau: float | None


class Turned(TypedDict):
    """Potentials of a turning wheel at one angle.

    Attributes:
        k: spring constant (1).
        omega_mean: speed at which it is turned (rad/s).
        phi: angle (rad).
        x1: potential of the first neuron by the formula (1).
        x1_numeric: the same by integration (1).
        x1_rolling: that of the wheel that rolls by itself (1); None if it does not.
        x2: potential of the second neuron by the formula (1).
        x2_numeric: the same by integration (1).
        x2_rolling: that of the wheel that rolls by itself (1); None if it does not.
    """

    kind: Literal["turning"]
    k: float
    omega_mean: float
    phi: float
    x1: float
    x1_numeric: float
    x1_rolling: float | None
    x2: float
    x2_numeric: float
    x2_rolling: float | None


CycleMeasured = Cycle | CyclePoint | BranchEnd | FormulaEdge | NoBranch | SteppedCycle
Measured = Rest | HopfPoint | MergingPoint | CycleMeasured | LinePoint | NeutralPoint | Turned


def pairs(numbers: Iterable[complex]) -> Pairs:
    """Complex numbers as (real part, imaginary part), which JSON can hold."""
    return [[float(z.real), float(z.imag)] for z in map(complex, numbers)]
