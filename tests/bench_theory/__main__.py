"""`make bench-theory`: kickctl's engine for the analytic model against its peers, equally accurate.

Every engine gets the equations from host.theory.model.wheel, the same points, both cores, and
computes the same two averages.
"""

import os
import statistics
import time

import numpy as np

from host.theory.engine.ensemble import averages as ours
from tests.bench_theory import by_heyoka, by_jax, by_numba, by_scipy
from tests.bench_theory.problem import (
    MEASURED_S,
    TRANSIENT_S,
    WORKERS,
    Averages,
    Contestant,
    difference,
    random_points,
    starts,
)

# Half of the plane is chaotic, where no two engines agree; so more points are drawn than are used.
DRAWN, POINTS, SEED, REGULAR = 2560, 1024, 1, 1e-8
# The reference takes long, so only some points have one.
JUDGED = 4
RUNS = 3
FINENESSES = (0.4, 0.45, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2)
GOALS = {"scipy solve_ivp": 200.0}


def main():
    """Print everything."""
    load = os.getloadavg()[0]
    print(
        f"{os.cpu_count()} cores, {WORKERS} for each engine; load when this began: {load:.1f}",
        flush=True,
    )
    parameters = regular_points()
    reference = by_heyoka.exact(parameters[:, ::JUDGED])
    kinds = "k 0 to 20, tau 0.02 to 1.5 s, regular motion only"
    print(
        f"{POINTS} points ({kinds}), {TRANSIENT_S:g} s of transient and {MEASURED_S:g} s measured;"
        f" errors of every {JUDGED}th"
    )
    print("reference: heyoka.py in extended precision, tolerance 1e-18\n", flush=True)
    found = measured(
        [
            *our_contestants(),
            *(c for peer in (by_heyoka, by_numba, by_jax, by_scipy) for c in peer.contestants()),
        ],
        parameters,
        reference,
    )
    show(found)
    finest = next(result for result in reversed(found) if result.contestant.name == "kickctl")
    print(f"\nkickctl's finest and the reference differ by {finest.errors.max():.0e} rad/s at most")
    compare(found)
    print(f"\nload when this ended: {os.getloadavg()[0]:.1f}")


def regular_points():
    """Parameters (6, POINTS) of wheels whose averages two fine runs agree upon.

    Neither is of kickctl's own engine.
    """
    drawn = random_points(DRAWN, SEED)
    one, other = (by_heyoka.batches(tolerance, drawn)() for tolerance in (1e-15, 1e-13))
    regular = np.flatnonzero((difference(one, other) < REGULAR).all(axis=0))
    chosen = np.sort(np.random.default_rng(SEED).choice(regular, POINTS, replace=False))
    return np.ascontiguousarray(drawn[:, chosen])


def our_contestants():
    """kickctl's engine with all finenesses."""

    def prepare(fineness, parameters):
        states = starts(parameters.shape[1])
        ours(states[:, :2], parameters[:, :2], 0.1, 0.1, fineness)

        def run():
            found = ours(states, parameters, TRANSIENT_S, MEASURED_S, fineness)
            return Averages(np.abs(found.omega_mean), found.omega_std)

        return run

    for fineness in FINENESSES:
        yield Contestant(
            "kickctl",
            f"fineness {fineness:g}",
            1,
            lambda parameters, fineness=fineness: prepare(fineness, parameters),
        )


class Result:
    """A contestant's speed (points x simulated seconds per second) and errors, (2, judged)."""

    def __init__(self, contestant, parameters, reference):
        own = np.ascontiguousarray(parameters[:, :: contestant.every])
        self.contestant, self.points = contestant, own.shape[1]
        start_s = time.perf_counter()
        self._run = contestant.prepare(own)
        self.compile_s = time.perf_counter() - start_s
        self._times, self._reference = [], reference
        self.errors = None

    def run(self):
        """Once more."""
        start_s = time.perf_counter()
        found = self._run()
        self._times.append(time.perf_counter() - start_s)
        every = self.contestant.every
        judged = Averages(*(values[:: max(1, JUDGED // every)] for values in found))
        self.errors = difference(
            judged, Averages(*(values[:: max(1, every // JUDGED)] for values in self._reference))
        )

    @property
    def speed(self):
        """Points x simulated seconds per second, the median of all runs."""
        return self.points * (TRANSIENT_S + MEASURED_S) / statistics.median(self._times)

    def worst(self, every):
        """The 99th percentile of the errors, (2,), at the judged points."""
        own = max(self.contestant.every, JUDGED)
        return np.percentile(self.errors[:, :: max(1, every // own)], 99, axis=1)


def measured(contestants, parameters, reference):
    """Results of all. Their runs take turns, so that other work on the machine slows all alike."""
    results = [Result(contestant, parameters, reference) for contestant in contestants]
    for _ in range(RUNS):
        for result in results:
            result.run()
    return results


def show(results):
    """Print how fast and how exact each was."""
    print(
        f"{'engine':<16} {'setting':<14} {'points':>6} {'compiled':>8} {'point s/s':>11}   error of"
        " mean       error of std"
    )
    print(f"{'':<16} {'':<14} {'':>6} {'s':>8} {'':>11}   median   99 %     median   99 %")
    for result in results:
        errors = " ".join(
            f"  {median:.1e}  {worst:.1e}"
            for median, worst in zip(np.median(result.errors, axis=1), result.worst(0), strict=True)
        )
        who = f"{result.contestant.name:<16} {result.contestant.setting:<14} {result.points:>6}"
        print(f"{who} {result.compile_s:>8.1f} {result.speed:>11,.0f} {errors}")


def compare(results):
    """Print for each peer and setting how many times faster kickctl is with the same accuracy."""
    print(
        "\nat equal accuracy: kickctl's coarsest fineness whose 99th percentiles of both errors are"
        " no worse, at the same points"
    )
    own = [result for result in results if result.contestant.name == "kickctl"]
    least = {}
    for result in results:
        if result in own:
            continue
        name, setting, every = (
            result.contestant.name,
            result.contestant.setting,
            result.contestant.every,
        )
        enough = [one for one in own if (one.worst(every) <= result.worst(every)).all()]
        ratio = enough[0].speed / result.speed if enough else 0.0
        least[name] = min(ratio, least.get(name, np.inf))
        print(
            f"{name:<16} {setting:<14} "
            + (
                f"{enough[0].contestant.setting:<14} {ratio:>9.2f} times"
                if enough
                else "more exact than all"
            )
        )
    print()
    for name, ratio in least.items():
        goal = GOALS.get(name, 1.0)
        print(
            f"{name}: at least {ratio:.2f} times as fast ({'PASS' if ratio > goal else 'FAIL'}:"
            f" more than {goal:g})"
        )


if __name__ == "__main__":
    main()
