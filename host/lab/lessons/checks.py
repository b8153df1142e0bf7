"""What a pupil has found out in a guided exercise, judged by the robot's log alone."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Iterator
from itertools import groupby, pairwise, product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from host.experiments.robot.wall_hits import bounces
from host.kicking.kick_watch import KickWatch
from host.lab.lessons.expected import reversal_share
from host.logs.log import Log
from host.logs.motion import HEADINGS, heading_of
from host.logs.replay import replay
from host.logs.tap import Event
from host.util.intervals import wilson
from robot.blackbox import Snapshot
from robot.kicks import MEMBRANE, PHASE, WHEELS
from robot.params import Params
from robot.record import STATES

_RUNNING = STATES.index("running")
FORWARD, BACKWARD, STOPPED = HEADINGS[1], HEADINGS[-1], HEADINGS[0]
STARTS = 10
# Shorter runs do not tell where a robot goes (s).
_RUN_S = 1.0
# How far a wheel has to be turned by hand, forward and back (rad); an arrow key pulls 1 rad.
_BY_HAND_RAD = 0.7
# In one tick, this many times as fast as in any of the ticks before is a jump; less than the other
# factor is none.
_JUMP, _SMOOTH = 2.0, 1.7
_BEFORE = 12
KICKS, LENGTHS = 10, 4
# Kicks that would fit the simulation less often than this by chance do not fit it.
_RARE = 1e-3
# A k counts if it was held for this time (s); the speed is that of its last part (s).
_HELD_S, _MEAN_S = 1.5, 1.0
# What somebody does to a robot. Between these it turns by itself, at least this many times.
_DISTURBING = ("start", "stop", "kick", "params", "snapshot")
_TURNS = 2
# How many ticks before a turn are compared: most of them are from before the wall.
_APPROACH = 80
# Slower wheels rest (rad/s).
_REST_RAD_S = 0.5


class Finding(NamedTuple):
    """One thing that a check has looked at: whether it is as it should be, and words about it."""

    ok: bool
    words: str


def check(name: str, log: Log) -> list[Finding]:
    """Check an exercise.

    Args:
        name: The exercise's.
        log: All that the robot did in it.

    Returns:
        What was looked at; the exercise is done if all of it is as it should be.
    """
    return [*CHECKS[name](log), _honest(log)]


def _start(log: Log) -> list[Finding]:
    ways = Counter(heading_of(phis) for phis in _runs(log))
    moved = ways[FORWARD] + ways[BACKWARD]
    low, high = wilson(ways[FORWARD], moved)
    return [
        Finding(moved >= STARTS, f"starts after which it rolled: {moved}, needed: {STARTS}"),
        Finding(
            min(ways[FORWARD], ways[BACKWARD]) > 0,
            f"the left wheel went forward {_times(ways[FORWARD])} and backward"
            f" {_times(ways[BACKWARD])}. So few starts tell only this: of 100 starts, probably"
            f" {100 * low:.0f} to {100 * high:.0f} go forward",
        ),
    ]


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"


def _runs(log: Log) -> Iterator[list[float]]:
    """The angles of the left wheel (rad) in each run that was long enough."""
    for first, end in _spans(log, ("start",)):
        running = [one for one in log.records[first:end] if one.state == _RUNNING]
        if running and running[-1].t_s - running[0].t_s >= _RUN_S:
            yield [one.left_phi_rad for one in running]


def _spans(log: Log, names: Collection[str]) -> Iterator[tuple[int, int]]:
    """The places of records from each event of these names to the next one, or to the end."""
    places = [place for event, place in _events(log) if event["event"] in names]
    return pairwise([*places, len(log.records)])


def _trace(log: Log) -> list[Finding]:
    still = log.column("state") != _RUNNING
    far_rad, side = max(
        (_there_and_back_rad(log.column(f"{side}_phi_rad")[still]), side) for side in WHEELS
    )
    words = f"with the motors off, the {side} wheel went forward and back by {far_rad:.1f} rad"
    return [Finding(far_rad >= _BY_HAND_RAD, f"{words}, needed: {_BY_HAND_RAD:g} rad")]


def _there_and_back_rad(phi_rad: NDArray[np.float64]) -> float:
    """How far a wheel went forward and then came back."""
    if not len(phi_rad):
        return 0.0
    there = phi_rad - np.minimum.accumulate(phi_rad)
    back = phi_rad - np.minimum.accumulate(phi_rad[::-1])[::-1]
    return float(np.minimum(there, back).max())


def _jump(log: Log) -> list[Finding]:
    steps = {mode: _steps(log, mode) for mode in (MEMBRANE, PHASE)}
    findings = [
        Finding(bool(steps[mode]), f"a {mode} kick while the wheels rolled") for mode in steps
    ]
    if not all(one.ok for one in findings):
        return findings
    (flip, turn), (creep, way) = (max(steps[mode]) for mode in (MEMBRANE, PHASE))
    return [
        *findings,
        Finding(
            min(one for one, _ in steps[MEMBRANE]) >= _JUMP,
            f"in one tick of a membrane kick the memory moved {flip:.1f} times as far as in a tick"
            " before the kick",
        ),
        Finding(
            creep <= _SMOOTH,
            f"in a phase kick it moved at most {creep:.1f} times as far in a tick",
        ),
        Finding(
            max(turn, way) <= _SMOOTH,
            f"the wheel itself moved at most {max(turn, way):.1f} times as far in a tick",
        ),
    ]


def _steps(log: Log, mode: str) -> list[tuple[float, float]]:
    """How fast memory and angle went in the ticks of each kick, compared with those before it."""
    found = []
    seconds = np.diff(log.column("t_s"))
    for place, kick in log.kicks():
        if kick["mode"] != mode or place < _BEFORE:
            continue
        for side in kick["wheels"]:
            columns = [log.column(f"{side}_{name}") for name in ("x1", "x2", "phi_rad")]
            memory = np.hypot(np.diff(columns[0]), np.diff(columns[1])) / seconds
            angle = np.abs(np.diff(columns[2])) / seconds
            usual = slice(place - _BEFORE, place - 1)
            during = slice(place - 1, place - 1 + kick["ticks"])
            if heading_of(columns[2][place - _BEFORE : place].tolist()) == STOPPED:
                continue
            far, turn = (
                float(steps[during].max() / steps[usual].max()) for steps in (memory, angle)
            )
            found.append((far, turn))
    return found


def _longer(log: Log) -> list[Finding]:
    phase = [(kick, results) for kick, results in _outcomes(log) if kick["mode"] == PHASE]
    tried: dict[int, list[bool]] = defaultdict(list)
    for kick, results in phase:
        tried[kick["ticks"]] += [result == "reverses" for result in results]
    shares = ", ".join(
        f"{ticks}: {sum(done)} of {len(done)}" for ticks, done in sorted(tried.items())
    )
    findings = [
        Finding(
            len(phase) >= KICKS,
            f"phase kicks with an outcome: {len(phase)}, needed: {KICKS}",
        ),
        Finding(
            len(tried) >= LENGTHS
            and min(tried) <= 2
            and any(3 <= ticks <= 6 for ticks in tried)
            and max(tried) >= 10,
            f"different lengths: {len(tried)}, needed: {LENGTHS}, and among them 1 or 2 ticks, 3 to"
            f" 6 ticks, and 10 ticks. Wheels reversed, by length: {shares or 'none'}",
        ),
    ]
    if all(one.ok for one in findings):
        findings.append(_fit(tried, _params(log)))
    return findings


def _fit(tried: dict[int, list[bool]], params: Params) -> Finding:
    """Whether the kicks reversed as many wheels as the simulation does."""
    # Imported where it is used: scipy.stats takes a second.
    from scipy.stats import binomtest

    odd = []
    for ticks, done in sorted(tried.items()):
        share = reversal_share(ticks, params)
        if binomtest(sum(done), len(done), share).pvalue < _RARE:
            odd.append(f"{ticks} ticks should reverse {100 * share:.0f} %")
    words = "the shares fit those of hundreds of simulated wheels"
    return Finding(not odd, f"{words}, but not here: {'; '.join(odd)}" if odd else words)


def _outcomes(log: Log) -> Iterator[tuple[dict[str, Any], list[str]]]:
    """Each kick with what it did to each kicked wheel, as far as that is clear."""
    kicks: list[tuple[int, Any]] = [*log.kicks(), (len(log.records), None)]
    for (place, kick), (end, _) in pairwise(kicks):
        watch = KickWatch(kick, log.records[max(0, place - 2 * _BEFORE) : end])
        if watch.outcome is not None:
            yield kick, [watch.outcome.results[side] for side in kick["wheels"]]


def _there_and_back(log: Log) -> list[Finding]:
    ways = {side: _way(holds) for side, holds in _holds(log).items()}
    best = max(ways.values(), key=len)
    findings = [
        Finding(len(best) > 0, "a wheel rolled at a k that you held"),
        Finding(len(best) > 1, "you lowered k, in steps that you held, until it rested"),
        Finding(len(best) > 2, "you raised k again, until it rolled"),
    ]
    for side, way in ways.items():
        if len(way) == 3:
            rolled, rested, begun = way
            words = (
                f"the {side} wheel rolled down to k = {rolled:g}, still rested at k = {rested:g},"
                f" and began again at k = {begun:g}"
            )
            findings.append(Finding(rested >= rolled, words))
    if any(one.ok for one in findings[3:]):  # a wheel by itself may rest where it begins easily
        return findings[:3] + [one for one in findings[3:] if one.ok]
    return findings


def _way(holds: list[tuple[float, float]]) -> list[float]:
    """How far a wheel came on its way there and back, by (k, its speed) of each k that was held.

    Returns:
        The least k at which it rolled before its first rest, the greatest at which it rested after
        it, and that at which it rolled again; as many of them as there are.
    """
    rolls = [speed >= _REST_RAD_S for _, speed in holds]
    parts = [list(part) for _, part in groupby(zip(rolls, holds, strict=True), lambda one: one[0])]
    if not rolls or not rolls[0]:
        return []
    ks = [[k for _, (k, _) in part] for part in parts]
    return [min(ks[0]), *map(max, ks[1:2]), *(part[0] for part in ks[2:3])]


def _holds(log: Log) -> dict[str, list[tuple[float, float]]]:
    """Each k that was held while the robot ran, with the speed of each wheel (rad/s)."""
    ends = dict(_spans(log, ("params", "snapshot", "start")))
    speeds = {side: np.abs(log.omega(side)) for side in WHEELS}
    snapshot = Snapshot(Params().values())
    found: dict[str, list[tuple[float, float]]] = {side: [] for side in WHEELS}
    for event, place in _events(log):
        snapshot = _after(snapshot, event)
        if event["event"] not in ("params", "snapshot", "start"):
            continue
        span = log.records[place : ends[place]]
        if not span or span[-1].t_s - span[0].t_s < _HELD_S:
            continue
        late = [place + n for n, one in enumerate(span) if one.t_s >= span[-1].t_s - _MEAN_S]
        if all(log.records[n].state == _RUNNING for n in late):
            for side, speed in speeds.items():
                found[side].append((float(snapshot.params["k"]), float(speed[late].mean())))
    return found


def _wall(log: Log) -> list[Finding]:
    leads = [lead for first, end in _spans(log, _DISTURBING) for lead in _leads(log, first, end)]
    turns = len(leads) // len(WHEELS)
    findings = [
        Finding(
            turns >= _TURNS,
            f"turns at a wall while nobody touched anything: {turns}, needed: {_TURNS}",
        )
    ]
    if leads:
        slow_s, close_s = np.median(leads, axis=0)
        words = (
            f"the wheels had lost half their speed {slow_s:.2f} s before M changed its sign, and"
            f" the lag had shrunk to half {close_s:.2f} s before it"
        )
        findings.append(Finding(all(slow > close > 0.0 for slow, close in leads), words))
    return findings


def _leads(log: Log, first: int, end: int) -> Iterator[tuple[float, float]]:
    """What came before M changed its sign, in each lasting reversal of both wheels among records.

    Yields:
        For each wheel, how long before that it had lost half its speed, and how long before that
        its lag had shrunk to half (s).
    """
    times = log.column("t_s")[first:end]
    angles, torques = (
        np.stack([log.column(f"{side}_{name}")[first:end] for side in WHEELS], axis=1)
        for name in ("phi_rad", "torque")
    )
    for turned, wheel in product(bounces(times, angles, torques), range(len(WHEELS))):
        x1, x2 = (log.column(f"{WHEELS[wheel]}_{name}")[first:end] for name in ("x1", "x2"))
        phi, torque = angles[:, wheel], torques[:, wheel]
        lag = np.abs(np.angle(np.exp(1j * phi) / (x1 + 1j * x2)))
        speed = np.abs(np.convolve(np.gradient(phi, times), np.full(3, 1 / 3), "same"))
        changed = _last(torque[:turned] * torque[turned] < 0.0) + 1
        before = slice(max(0, changed - _APPROACH), changed)
        slow, close = (
            before.start + _last(one[before] >= np.percentile(one[before], 75) / 2) + 1
            for one in (speed, lag)
        )
        if changed < len(times):
            yield float(times[changed] - times[slow]), float(times[changed] - times[close])


def _last(where: NDArray[np.bool_]) -> int:
    """The last place at which something holds; -1 if nowhere."""
    places = np.flatnonzero(where)
    return int(places[-1]) if len(places) else -1


def _params(log: Log) -> Params:
    """The parameters at the end of a log."""
    snapshot, params = Snapshot(Params().values()), Params()
    for event in log.events:
        snapshot = _after(snapshot, event)
    params.apply(params.check(snapshot.params))
    return params


def _after(snapshot: Snapshot, event: Event) -> Snapshot:
    """What is in force after an event."""
    if event["event"] == "snapshot":
        return Snapshot(event["params"])
    snapshot.take(event)
    return snapshot


def _events(log: Log) -> Iterator[tuple[Event, int]]:
    return zip(log.events, log.places, strict=True)


def _honest(log: Log) -> Finding:
    """Whether the robot did what its parameters and kicks say, in each tick."""
    result = replay(log)
    if result.beyond is not None:
        return Finding(
            False,
            f"the robot did not do what its parameters and kicks say: in tick {result.beyond.tick},"
            f" {result.beyond.channel} should be {result.beyond.replayed:.3g}",
        )
    if not result.compared:
        return Finding(False, "the log has no tick yet that could be checked")
    words = f"the log is sound: {result.compared} ticks compared, all follow the robot's equations"
    return Finding(True, words)


CHECKS: dict[str, Callable[[Log], list[Finding]]] = {
    "start": _start,
    "trace": _trace,
    "jump": _jump,
    "longer": _longer,
    "there-and-back": _there_and_back,
    "wall": _wall,
}
