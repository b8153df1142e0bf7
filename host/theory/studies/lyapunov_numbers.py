"""The numbers of the studies `lyapunov`, `lyapunov-line` and `lyapunov-plane`, as plain data."""

from __future__ import annotations

from typing import TypedDict

from host.theory.analysis.attractors import Kind
from host.theory.studies.lyapunov_rows import RollingEnd, StartKind


class Spectrum(TypedDict):
    """The four exponents (1/s) of one kind of attractor, in descending order.

    Attributes:
        wheels: how many wheels stayed on it.
        exponents: means over wheels and times.
        standard_errors: of the means: by wheels, if these are enough (see
            host.theory.analysis.spectrum), else the greater one of the following two.
        errors_by_wheels: from the spread between wheels; None for a single wheel.
        errors_by_blocks: from the spread between blocks of time; None for a single block.
        along_flow: the exponent along the flow, which is one of the four; it is 0 in the long run.
            None for wheels that rest.
        along_flow_error: its standard error.
        dimension: the Lyapunov dimension.
        by_pairs: the largest exponent by pairs of near wheels.
        by_pairs_error: its standard error.
        omega_mean_abs: mean of the wheels' |mean speed| (rad/s).
        omega_std: mean of their standard deviations of speed (rad/s).
    """

    wheels: int
    exponents: list[float]
    standard_errors: list[float]
    errors_by_wheels: list[float] | None
    errors_by_blocks: list[float] | None
    along_flow: float | None
    along_flow_error: float | None
    dimension: float
    by_pairs: float
    by_pairs_error: float
    omega_mean_abs: float
    omega_std: float


class Accuracy(TypedDict):
    """How well the exponents (1/s) at the point agree with what must hold, and with each other."""

    sum_of_exponents_exact: float
    sum_of_exponents_off_by: float
    two_algorithms_differ_by: float
    two_algorithms_standard_error: float


class Point(Spectrum):
    """The attractor that most wheels stayed on, beside all others, and how many changed.

    Attractors are named by their kind; a second one of the same kind is 'KIND (2)', and so on.
    """

    kind: Kind
    attractors: dict[str, Spectrum]
    of_wheels: int
    changed: int
    accuracy: Accuracy


class Series(TypedDict):
    """The largest exponent (1/s) of the force's time series, with its embedding."""

    per_s: float
    interval: tuple[float, float] | None
    lag_s: float
    dimension: int
    of_noise: float


class AtK(TypedDict):
    """How many wheels of each start ended on each kind at one k, and the exponent of chaos."""

    k: float
    counts: dict[StartKind, dict[Kind, int]]
    chaotic_exponent: float | None


class Line(TypedDict):
    """Where along k chaos, chaos beside rolling, and regular switching were seen."""

    chaos_seen_k: list[float] | None
    chaos_and_rolling_seen_k: list[float] | None
    regular_switching_k: list[float]
    at: list[AtK]


class Plane(TypedDict):
    """Shares of the plane, and the share of points at which the start decides."""

    shares: dict[StartKind, dict[Kind, float]]
    start_decides: float


class CrisisNumbers(TypedDict):
    """host.theory.analysis.transients.Crisis as plain data."""

    k: float
    k_interval: tuple[float, float]
    power: float
    power_interval: tuple[float, float]
    factor: float
    misfit: float


class Lives(TypedDict):
    """host.theory.analysis.transients.Sample as plain data."""

    k: float
    wheels: int
    ended: int
    mean_s: float | None
    likeness: float | None


class HalvedSteps(TypedDict):
    """What changes with half the step, at how many points."""

    points: int
    same_kind: int
    median_exponent_off_by: float | None
    median_speed_off_by_rad_s: float | None


class Constants(TypedDict):
    """The wheel's constants, by the paper's letters."""

    a: float
    tau: float
    k: float
    f: float
    I: float  # noqa: E741


class Numbers(TypedDict):
    """All numbers of the study `lyapunov`.

    Attributes:
        verdict: the kind of the attractor, or hyperchaotic with two positive exponents.
    """

    verdict: str
    exponents: list[float]
    standard_errors: list[float]
    dimension: float
    constants: Constants
    point: Point
    series: Series | None
    accuracy: Accuracy


class LineNumbers(TypedDict):
    """All numbers of the study `lyapunov-line`."""

    tau: float
    line: Line
    rolling_ends: RollingEnd | None
    crisis: CrisisNumbers | None
    through_a_crisis: bool
    lives: list[Lives]
    in_words: str


class PlaneNumbers(Plane):
    """All numbers of the study `lyapunov-plane`."""

    accuracy: HalvedSteps
