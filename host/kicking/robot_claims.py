"""The paper's claims about the robot that one log or a count of kicks decides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import NamedTuple

import numpy as np

from host.logs.log import Log
from host.runs.claim_sentences import SENTENCES
from host.runs.claims import Claim, too_few
from host.util.intervals import bootstrap_interval, fraction, wilson
from robot.kicks import WHEELS
from robot.params import TABLE

# The parameters of the paper's robot, for which its claims are made.
PAPER = {
    name: TABLE[name].default
    for name in ("a", "tau_s", "k", "tick_s", "rods", "rod_lag_s", "max_duty_pct")
}
# The LEGO wheel of 56 mm; 0.35 m/s at 2 turns a second give 27.9 mm.
WHEEL_RADIUS_M = 0.028
# Friction holds a wheel at torques below this one (paper, section 'Robot').
STALL_TORQUE = 0.1
# A wheel that turns more slowly does not roll.
MOVING_HZ = 0.1
# How often a kick must reverse the robot to show the paper's 'always'.
ALWAYS = 50
# A rate that is 100 % in whole percents, as the paper writes it.
ALL = 0.995
# The paper's quenched kicks, in words.
INVERTED = "inverting the positions (beta = 1)"
SHIFTED = "a phase shift of 3 pi/4, positive for forward wheels and negative for backward ones,"
# The rates at which a quenched kick is reliable, and fails; the lengths (ticks) at which it should
# be reliable; and the trials that it takes to decide.
RELIABLE, FAILS = 0.95, 0.1
SURE_LENGTHS = (3, 4, 5)
LEAST_TRIALS = 20
# Starts after which both directions have occurred almost surely.
LEAST_STARTS = 10
# The least step of a ramp; a torque that still settles changes by less.
_LEAST_STEP = 1e-3


@dataclass(frozen=True)
class Span:
    """The rows of a log from `first` to before `end`, such as a stretch of steady motion."""

    first: int
    end: int


class Steady(NamedTuple):
    """A wheel in steady motion.

    Attributes:
        hz: Turns per second, forward positive.
        duty_pct: The mean of |duty cycle|, %.
        ripple: std(M) / mean(|M|) of the torque M.
    """

    hz: float
    duty_pct: float
    ripple: float


def steady(log: Log, span: Span) -> list[Steady]:
    """The left and the right wheel in a span of steady motion."""
    rows = slice(span.first, span.end)
    found = []
    for side in WHEELS:
        torque = log.column(side + "_torque")[rows]
        hertz = float(log.omega(side)[rows].mean()) / (2 * pi)
        duty = float(np.abs(log.column(side + "_duty_pct")[rows]).mean())
        found.append(Steady(hertz, duty, float(torque.std() / np.abs(torque).mean())))
    return found


def coexistence(wheels: Sequence[Steady]) -> Claim:
    """R1: from random starts wheels roll in both directions, equally fast.

    Args:
        wheels: Wheels that started from random potentials.
    """
    speeds = np.array([wheel.hz for wheel in wheels])
    forward, backward = speeds[speeds > 0.0], -speeds[speeds < 0.0]
    both = len(forward) > 0 and len(backward) > 0
    asymmetry = float(abs(forward.mean() / backward.mean() - 1.0)) if both else 1.0
    claim = Claim(
        "R1",
        SENTENCES["R1"],
        "both from random starts, speeds equal within 3 %",
        asymmetry,
        "1",
        None,
        both and asymmetry <= 0.03,
        f"the relative difference of the two mean speeds; of {len(speeds)} wheels {len(forward)}"
        f" roll forward, {len(backward)} backward",
    )
    return claim.doubted(too_few(len(speeds), LEAST_STARTS, "wheels that started"))


def locomotion(wheels: Sequence[Steady]) -> list[Claim]:
    """R2 to R4: frequency, speed and duty cycle, and steadiness of the torque."""
    hertz = [abs(wheel.hz) for wheel in wheels]
    mean, interval = float(np.mean(hertz)), bootstrap_interval(hertz)
    duty, ripple = (
        float(np.mean([wheel.duty_pct for wheel in wheels])),
        max(wheel.ripple for wheel in wheels),
    )
    to_m_s = 2 * pi * WHEEL_RADIUS_M
    return [
        Claim(
            "R2",
            SENTENCES["R2"],
            "1.8 to 2.3 Hz",
            mean,
            "Hz",
            interval,
            1.8 <= mean <= 2.3,
            f"the mean of {len(wheels)} wheels",
        ),
        Claim(
            "R3",
            SENTENCES["R3"],
            "0.32 to 0.39 m/s, duty 80 to 90 %",
            mean * to_m_s,
            "m/s",
            (interval[0] * to_m_s, interval[1] * to_m_s) if interval else None,
            0.32 <= mean * to_m_s <= 0.39 and 80.0 <= duty <= 90.0,
            f"the mean speed, at a duty cycle of {duty:.0f} %",
        ),
        Claim(
            "R4",
            SENTENCES["R4"],
            "std(M) / mean(|M|) < 0.1",
            ripple,
            "1",
            None,
            ripple < 0.1 and min(hertz) > MOVING_HZ,
            f"the largest std(M) / mean(|M|) of {len(wheels)} wheels; the slowest"
            f" wheel makes {min(hertz):.2f} turns per second",
        ),
    ]


def break_away(log: Log, span: Span) -> Claim:
    """R5: a wheel at rest does not move until the torque rises above 0.1.

    Args:
        log: The log of a robot whose torque rises slowly.
        span: From rest until both wheels have moved.
    """
    rows = slice(span.first, span.end)
    stalls, moves = [], []
    for side in WHEELS:
        phi, torque = (
            log.column(side + "_phi_rad")[rows],
            np.abs(log.column(side + "_torque")[rows]),
        )
        moved = np.flatnonzero(phi != phi[0])
        first = int(moved[0]) if len(moved) else len(phi)
        steps = np.flatnonzero(np.diff(torque[:first]) > _LEAST_STEP) + 1
        last_step = int(steps[-1]) if len(steps) else first
        stalls.append(float(torque[:last_step].max(initial=0.0)))
        moves.append(float(torque[:first].max(initial=0.0)) if len(moved) else 1.0)
    return Claim(
        "R5",
        SENTENCES["R5"],
        "no motion from rest below, motion above",
        float(np.mean(moves)),
        "1",
        None,
        all(
            0.09 <= low <= 0.102 and 0.1 <= high <= 0.11
            for low, high in zip(stalls, moves, strict=True)
        ),
        "the mean |M| at which a wheel begins to move; "
        + "; ".join(
            f"{side}: rests at |M| = {low:.3f}, moves at {high:.3f}"
            for side, low, high in zip(WHEELS, stalls, moves, strict=True)
        ),
    )


def inversions(reversals: Sequence[bool]) -> Claim:
    """R8: inverting the membrane potentials always reverses the robot.

    Args:
        reversals: Whether each inversion reversed it.
    """
    done, tried = sum(reversals), len(reversals)
    claim = Claim(
        "R8",
        SENTENCES["R8"],
        f"{ALWAYS} of {ALWAYS}",
        done / max(1, tried),
        "1",
        wilson(done, tried),
        not tried or done / tried >= ALL,
        f"the share of inversions that reversed them: {done} of {tried}",
    )
    # An inversion that fails among few disproves it.
    return claim.doubted(too_few(tried, ALWAYS, "inversions")) if claim.holds else claim


def surest(found: Mapping[int, tuple[int, int]]) -> int:
    """The length in SURE_LENGTHS at which most kicks reverse; of equal ones the shortest.

    Args:
        found: (reversed, tried) for each length (ticks).
    """
    return max(SURE_LENGTHS, key=lambda ticks: fraction(*found[ticks]))


def quenched(
    number: str,
    claim: str,
    where: str,
    least_sure: Mapping[int, tuple[int, int]],
    rates: Mapping[int, float],
    fewest: int,
    of_what: str,
) -> Claim:
    """R9 and R10: a quenched kick is reliable at one of SURE_LENGTHS, and fails if short or long.

    Args:
        number: The claim's id.
        claim: The claim in words.
        where: Where the kick is least sure, in words.
        least_sure: (reversed, tried) there, for each length (ticks). Here it must be reliable.
        rates: The part that reverses, for each length. The kick must fail here at 1 tick and at
            some length above SURE_LENGTHS.
        fewest: The least number of trials that the claim rests on.
        of_what: What these trials are, in words.
    """
    best = surest(least_sure)
    rate = fraction(*least_sure[best])
    long = min(rates[ticks] for ticks in rates if ticks > SURE_LENGTHS[-1])
    found = Claim(
        number,
        claim,
        ">= 95 % somewhere in 3 to 5 ticks; fails for 1 tick; fails again for long kicks",
        rate,
        "1",
        wilson(*least_sure[best]),
        rate >= RELIABLE and rates[1] <= FAILS and long <= FAILS,
        f"the share of kicks of {best} ticks that reverse a wheel, {where}; of 1 tick:"
        f" {rates[1]:.0%}; of the worst length from {SURE_LENGTHS[-1] + 1} to {max(rates)} ticks:"
        f" {long:.0%}",
    )
    return found.doubted(too_few(fewest, LEAST_TRIALS, of_what))
