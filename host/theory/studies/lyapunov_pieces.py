"""What each piece of the studies `lyapunov`, `lyapunov-line` and `lyapunov-plane` computes."""

from __future__ import annotations

import numpy as np

from host.errors import NotDone, WrongUse
from host.theory.analysis.attractors import (
    AGREE,
    CHAOS,
    KINDS,
    REST,
    kinds_by_exponents,
    random_starts,
    settle,
    watch,
)
from host.theory.analysis.branches import last_stable, rotations
from host.theory.analysis.cycles import ROTATION
from host.theory.analysis.spectrum import exponents, largest_exponents
from host.theory.analysis.tangent import pair_growth
from host.theory.analysis.trajectories import SAMPLE_S, trajectory
from host.theory.analysis.transients import lives
from host.theory.engine.ensemble import FINE, rate_per_s
from host.theory.model.laws import array_rates, law_of, require_friction
from host.theory.model.turning import rolling_states
from host.theory.model.wheel import Array, Wheel
from host.theory.studies.lyapunov_rows import (
    ANY,
    ROLLS,
    Attractor,
    Block,
    GridPoint,
    Life,
    RollingEnd,
    SeriesSample,
    StartKind,
    StepCheck,
)

# How long wheels settle (at least), are watched, and are measured, s.
SETTLE_S, WATCH_S, MEASURE_S = 200.0, 100.0, 100.0
# Steps where a kind and an exponent are enough (see host.theory.engine.ensemble); `step_check`
# measures how good that is.
FINENESS = 0.6
# Wheels of the spectrum, how long their vectors turn into place, and the length of a block, s: much
# longer than a chaotic wheel remembers.
WHEELS, ALIGN_S, BLOCK_S = 32, 20.0, 100.0
# The series, as this number of stretches one after the other.
SERIES_S, STRETCHES = 300.0, 10
# Rotations are followed from this part of the greatest k on; wheels show what comes after the last
# stable one at this multiple of its k.
LEAST_K, BEYOND_END = 1e-3, 1.02
# Wheels whose lives are measured, and how long they are followed, s.
LIVES_WHEELS, LIVES_S = 256, 2000.0
CHECKED = 256
# A wheel that changes faster (1/s) takes more than an hour.
FASTEST = 5000.0


def midpoints(most: float, points: int) -> Array:
    """The midpoints of `points` equal intervals from 0 to `most`, (points,)."""
    return np.asarray((np.arange(points) + 0.5) * most / points)


def require_slow(wheel: Wheel) -> None:
    """Raise WrongUse for a wheel that never settles, or is too fast to be followed for minutes."""
    require_friction(wheel)
    fastest = float(rate_per_s(wheel.columns(1))[0])
    if not fastest <= FASTEST:
        raise WrongUse(
            f"a wheel with these constants and k = {wheel.k:g} changes within {1 / fastest:.1g} s:"
            " minutes of it take too long",
            "choose a larger tau, I or f, or a smaller k",
        )


def _settle_s(tau_s: float) -> float:
    """How long to wait for an attractor, s."""
    return max(SETTLE_S, 20 * tau_s)


def spectrum_in_blocks(wheel: Wheel, seconds: float, rng: np.random.Generator) -> list[Block]:
    """The spectrum of WHEELS wheels, each followed for some seconds."""
    parameters = wheel.columns(WHEELS)
    settled = settle(random_starts(WHEELS, rng), parameters, _settle_s(wheel.tau))
    before = watch(settled, parameters, WATCH_S)
    moving, regular = before.kinds() != REST, before.apart < AGREE
    blocks = max(1, round(seconds / BLOCK_S))
    # Means over chaotic motion have errors far above those of the steps.
    fineness = FINE if regular.any() else FINENESS
    found = exponents(
        before.states, parameters, ALIGN_S, seconds, blocks, moving, regular, fineness
    )
    pairs = pair_growth(before.states, parameters, ALIGN_S + seconds, fineness)[round(ALIGN_S) :]
    after = watch(found.states, parameters, WATCH_S)
    pair_means = np.array([block.mean(axis=0) for block in np.array_split(pairs, blocks)])
    largest = found.blocks.mean(axis=0).max(axis=0)
    # A wheel that repeats itself before or after has not been chaotic all the time.
    kinds, later = (
        kinds_by_exponents(seen, np.where(seen.apart < AGREE, 0.0, largest))
        for seen in (before, after)
    )
    return [
        {
            "wheel": own,
            "kind": KINDS[kinds[own]],
            "kind_after": KINDS[later[own]],
            "omega_mean": float(after.omega_mean[own]),
            "omega_std": float(after.omega_std[own]),
            "block": block,
            "along_flow": bool(moving[own]),
            "exponent_1": float(found.blocks[block, 0, own]),
            "exponent_2": float(found.blocks[block, 1, own]),
            "exponent_3": float(found.blocks[block, 2, own]),
            "exponent_4": float(found.blocks[block, 3, own]),
            "by_pairs": float(pair_means[block, own]),
        }
        for own in range(WHEELS)
        for block in range(blocks)
    ]


def series(wheel: Wheel, rng: np.random.Generator) -> list[SeriesSample]:
    """One wheel, sampled every SAMPLE_S; a chaotic one if any is, else one of most wheels' kind."""
    parameters = wheel.columns(WHEELS)
    settled = settle(random_starts(WHEELS, rng), parameters, _settle_s(wheel.tau))
    seen = watch(settled, parameters, WATCH_S)
    kinds = seen.kinds()
    kind = CHAOS if CHAOS in kinds else np.bincount(kinds).argmax()
    start = seen.states[:, int(np.argmax(kinds == kind))]
    stretches = [start[None]]
    for _ in range(STRETCHES):
        stretches.append(trajectory(stretches[-1][-1], wheel, SERIES_S / STRETCHES)[1:])
    path = np.concatenate(stretches).T
    _, _, phi, omega = path
    times = SAMPLE_S * np.arange(len(phi))
    force = wheel.I * array_rates(law_of(wheel))(*path, *wheel)[3] + wheel.f * omega
    columns = (times.tolist(), phi.tolist(), omega.tolist(), force.tolist())
    return [
        {"t_s": time_s, "phi_rad": angle, "omega": speed, "force": own}
        for time_s, angle, speed, own in zip(*columns, strict=True)
    ]


def _attractors(parameters: Array, starts: Array, fineness: float = FINENESS) -> list[Attractor]:
    """The attractor of each wheel, after it has settled."""
    slowest = float(parameters[Wheel._fields.index("tau")].max())
    settled = settle(starts, parameters, _settle_s(slowest), fineness)
    seen = watch(settled, parameters, WATCH_S, fineness)
    moving = seen.kinds() != REST
    largest = largest_exponents(seen.states, parameters, MEASURE_S, moving, fineness)
    columns = (kinds_by_exponents(seen, largest), largest, seen.omega_mean, seen.omega_std)
    return [
        {"kind": KINDS[kind], "exponent": exponent, "omega_mean": mean, "omega_std": std}
        for kind, exponent, mean, std in zip(*(own.tolist() for own in columns), strict=True)
    ]


def from_both_starts(parameters: Array, wheels: int, rng: np.random.Generator) -> list[GridPoint]:
    """The attractors of these parameters, (constants, points), `wheels` of either start each."""
    columns = np.repeat(parameters, wheels, axis=1)
    count = columns.shape[1]
    anywhere = random_starts(count, rng)
    rolling_ones = rolling_states(columns) + 1e-3 * rng.normal(size=(4, count))
    both = np.tile(columns, (1, 2))
    found = _attractors(both, np.hstack([anywhere, rolling_ones]))
    taus, ks = (both[Wheel._fields.index(name)].tolist() for name in ("tau", "k"))
    starts: list[StartKind] = [ANY] * count + [ROLLS] * count
    return [
        {"tau": tau, "k": k, "start": start, **own}
        for tau, k, start, own in zip(taus, ks, starts, found, strict=True)
    ]


def rolling(wheel: Wheel, most_k: float, rng: np.random.Generator) -> list[RollingEnd]:
    """Where the rotation loses its stability as k rises, and what wheels do a little above.

    No row if there is no rotation, or none that loses its stability.
    """
    if wheel.a == 0.0:
        return []
    try:
        found = last_stable(rotations(wheel, "k", LEAST_K * most_k, most_k))
    except NotDone:
        return []
    if found is None:
        return []
    x1, x2, omega, quarter_s, k = found.point.unknowns.tolist()
    above = wheel._replace(k=BEYOND_END * k).columns(WHEELS)
    starts = np.array([x1, x2, 0.0, omega])[:, None] * (1 + 0.05 * rng.normal(size=(4, WHEELS)))
    settled = settle(starts, above, 2 * _settle_s(wheel.tau), FINENESS)
    kinds = watch(settled, above, WATCH_S, FINENESS).kinds()
    return [
        {
            "k": k,
            "k_off_by": found.off_by,
            "type": found.type,
            "omega_mean": ROTATION.turn / quarter_s,
            "above": KINDS[int(np.bincount(kinds).argmax())],
        }
    ]


def lives_near_chaos(
    wheel: Wheel, offset: float, least: float | None, rng: np.random.Generator
) -> list[Life]:
    """How long wheels switch at the least k with chaos, times 1 + offset; none without chaos."""
    if least is None:
        return []
    k = least * (1 + offset)
    parameters = wheel._replace(k=k).columns(LIVES_WHEELS)
    found = lives(random_starts(LIVES_WHEELS, rng), parameters, LIVES_S, FINENESS)
    columns = (found.life_s.tolist(), found.ended.tolist())
    return [
        {"k": k, "life_s": life_s, "ended": ended} for life_s, ended in zip(*columns, strict=True)
    ]


def step_check(wheel: Wheel, ks: Array, taus_s: Array, rng: np.random.Generator) -> list[StepCheck]:
    """Random points of the plane with these axes, with ordinary steps and with half of these."""
    own_ks, own_taus = rng.choice(ks, CHECKED), rng.choice(taus_s, CHECKED)
    parameters = wheel.columns(CHECKED, k=own_ks, tau=own_taus)
    starts = random_starts(CHECKED, rng)
    plain = _attractors(parameters, starts)
    finer = _attractors(parameters, starts, 2 * FINENESS)
    columns = (own_taus.tolist(), own_ks.tolist(), plain, finer)
    return [
        {
            "tau": tau,
            "k": k,
            **own,
            "kind_finer": other["kind"],
            "exponent_finer": other["exponent"],
            "speed_off_by": abs(abs(own["omega_mean"]) - abs(other["omega_mean"])),
        }
        for tau, k, own, other in zip(*columns, strict=True)
    ]
