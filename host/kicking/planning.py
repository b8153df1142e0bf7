"""Plans: which quenched kick reverses a wheel, and at which moment.

A plan is chosen from the kick map of the robot's parameters.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import asdict, astuple, dataclass
from functools import cache
from math import degrees, tau
from pathlib import Path
from typing import Any

from host.kicking.kick_map import (
    KINDS,
    PHASE_BINS,
    KickCell,
    Row,
    bin_edges_rad,
    count,
    lengths,
    request,
    shift_of,
    tally,
)
from host.util.provenance import sources, unchanged
from host.util.whole_files import write_text
from robot.params import Params
from robot.user_folders import cache_folder
from sim_motor.constants import Constants, load

SURE = 0.99
# The wheels of a plan's own map: enough to tell 99 % from 97 % in one direction. Between small
# batches the link to the robot is kept alive.
_WHEELS, _WINDOW_WHEELS, _BATCH = 300, 4800, 300
_WINDOW_CANDIDATES = 3
_MAP_SEED = 1
_TURNS, _LEAST_STEP_RAD = 4, 0.01
# How many plans are kept.
_KEPT = 200
# The parameters that the map depends on.
_MAPPED = ("a", "tau_s", "k", "rods", "rod_lag_s", "max_duty_pct", "tick_s")

KickName = tuple[str, int, int]


@dataclass(frozen=True)
class Plan:
    """A kick for one wheel.

    Attributes:
        mode: The kick's mode.
        ticks: Its length, control periods.
        shift_rad: The shift of a phase kick; None for other modes.
        window_rad: The kick begins at a phase from the first to the second angle (mod 2 pi); None
            for any phase.
        tried: How many simulated kicks of this kind began in the window; 0 without a map.
        reversed: How many of these reversed their wheel.
    """

    mode: str
    ticks: int
    shift_rad: float | None = None
    window_rad: tuple[float, float] | None = None
    tried: int = 0
    reversed: int = 0

    def request(self) -> dict[str, Any]:
        """The kick, as robot.kick_requests.parse takes it."""
        return request(self.mode, self.ticks, self.shift_rad)

    def window_deg(self) -> list[float] | None:
        """The window in degrees."""
        return None if self.window_rad is None else [degrees(edge) for edge in self.window_rad]

    def meets(self, phi_rad: float) -> bool:
        """Whether a kick that begins at this angle (rad) of the wheel is in the window."""
        if self.window_rad is None:
            return True
        first, last = self.window_rad
        return (phi_rad - first) % tau <= (last - first) % tau

    def wait_ticks(self, phi_rad: float, step_rad: float) -> int | None:
        """When to kick: how many ticks from now the wheel is in the window.

        Args:
            phi_rad: The wheel's angle.
            step_rad: How far it turns in a tick.

        Returns:
            Ticks; None if the wheel does not meet the window within some turns.
        """
        most = 1 + int(_TURNS * tau / max(abs(step_rad), _LEAST_STEP_RAD))
        return next(
            (ticks for ticks in range(1, most + 1) if self.meets(phi_rad + ticks * step_rad)), None
        )


def _is_sure(rows: Iterable[Row]) -> bool:
    done, tried = count(rows)
    return tried > 0 and done >= SURE * tried


def choose(rows: Iterable[Row], before: int) -> Plan | None:
    """The kick that reverses a wheel of this direction most safely.

    If some kicks are sure at any phase, it is the one whose length is farthest from lengths that
    are not sure, because no robot is exactly its model; of several the shortest. Otherwise it is
    the kick with the widest window of sure phases.

    Args:
        rows: The rows of a kick map.
        before: The direction of the wheel, 1 or -1.

    Returns:
        The plan; None if no kick is sure.
    """
    kicks = _by_kick(rows, before)
    margins = _margins(kicks)
    if margins:
        mode, sign, ticks = max(margins, key=lambda kick: (margins[kick], -kick[2]))
        done, tried = count(kicks[mode, sign, ticks])
        return Plan(mode, ticks, shift_of(sign), None, tried, done)
    windows = [
        plan
        for (mode, sign, ticks), own in kicks.items()
        if (plan := _window(mode, sign, ticks, own))
    ]
    return max(windows, key=_width, default=None)


def _by_kick(rows: Iterable[Row], before: int) -> dict[KickName, list[Row]]:
    kicks: dict[KickName, list[Row]] = {}
    for row in rows:
        if row["before"] == before:
            kicks.setdefault((row["mode"], row["sign"], row["ticks"]), []).append(row)
    return kicks


def _margins(kicks: dict[KickName, list[Row]]) -> dict[KickName, int]:
    """How many steps of length lie between each sure kick and the next that is not sure.

    A kick that was not tried is not sure.
    """
    margins: dict[KickName, int] = {}
    for mode, sign in KINDS:
        tried = sorted(ticks for kind, own, ticks in kicks if (kind, own) == (mode, sign))
        unsure = [
            -1,
            *(i for i, ticks in enumerate(tried) if not _is_sure(kicks[mode, sign, ticks])),
            len(tried),
        ]
        for place, ticks in enumerate(tried):
            margin = min(abs(place - other) for other in unsure)
            if margin:
                margins[mode, sign, ticks] = margin
    return margins


def _window(mode: str, sign: int, ticks: int, rows: list[Row]) -> Plan | None:
    """The plan for the longest run of sure bins around the circle.

    None if no run has three bins or more.
    """
    bins: dict[int, list[Row]] = {}
    for row in rows:
        bins.setdefault(row["phase"], []).append(row)
    sure = [_is_sure(bins.get(number, [])) for number in range(PHASE_BINS)]
    first, length = 0, 0
    for begin in range(PHASE_BINS):
        run_length = next(
            (size for size in range(PHASE_BINS) if not sure[(begin + size) % PHASE_BINS]),
            PHASE_BINS,
        )
        if run_length > length:
            first, length = begin, run_length
    # The outermost bins border on failure.
    inner = [(first + place) % PHASE_BINS for place in range(1, length - 1)]
    if not inner:
        return None
    done, tried = count(row for number in inner for row in bins[number])
    window = bin_edges_rad(inner[0])[0], bin_edges_rad(inner[-1])[1]
    return Plan(mode, ticks, shift_of(sign), window, tried, done)


def _width(plan: Plan) -> float:
    first, last = plan.window_rad or (0.0, 0.0)
    return (last - first) % tau


def reversal(
    before: int,
    values: dict[str, Any],
    say: Callable[[str], None] = lambda words: None,
    motor: Constants | None = None,
) -> Plan | None:
    """The plan for a wheel that runs in this direction.

    A map takes some seconds to compute. The plan is then kept in
    ${XDG_CACHE_HOME:-~/.cache}/kickctl/plans.json for these parameters, this motor and these
    sources.

    Args:
        before: The direction, 1 or -1.
        values: The robot's parameters by name.
        say: Called with a message before a map is computed.
        motor: The constants of the robot's motors; by default those published for the EV3.

    Returns:
        The plan; None if no quenched kick is sure.
    """
    chosen = tuple(values[name] for name in _MAPPED)
    motor = motor or load()
    # By value: the motor of this name may have other constants tomorrow.
    key = json.dumps([sources(), before, *chosen, astuple(motor)], allow_nan=False)
    kept = _kept()
    if key not in kept:
        way = "forward" if before > 0 else "backward"
        say(f"computing which kicks reverse a wheel that rolls {way}: some seconds, only once")
        plan = _compute_plan(before, motor, *chosen)
        if unchanged():
            _keep({**_kept(), key: plan and asdict(plan)})
        return plan
    return kept[key] and Plan(
        **{**kept[key], "window_rad": kept[key]["window_rad"] and tuple(kept[key]["window_rad"])}
    )


def _file() -> Path:
    # Without a home folder nothing is kept, for this is where no file can be.
    return Path(cache_folder() or os.devnull, "plans.json")


def _kept() -> dict[str, Any]:
    """The kept plans by key; none if the file does not exist or cannot be read."""
    try:
        kept = json.loads(_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return kept if isinstance(kept, dict) else {}


def _keep(plans: dict[str, Any]) -> None:
    """Keep the newest plans if the disk has room. If not, the next command computes its plan."""
    with suppress(OSError):
        _file().parent.mkdir(parents=True, exist_ok=True)
        write_text(_file(), json.dumps(dict(list(plans.items())[-_KEPT:]), allow_nan=False))


@cache
def _compute_plan(before: int, motor: Constants, *values: float) -> Plan | None:
    rows = _kick_map(motor, *values)
    plan = choose(rows, before)
    if plan is not None and plan.window_rad is None:
        return plan
    kicks = _by_kick(rows, before)
    best = sorted(kicks, key=lambda kick: -count(kicks[kick])[0])[:_WINDOW_CANDIDATES]
    return choose(
        [
            row
            for kick in best
            for row in _kick_wheels(*kick, _params(values), motor, _WINDOW_WHEELS)
        ],
        before,
    )


@cache
def _kick_map(motor: Constants, *values: float) -> list[Row]:
    params = _params(values)
    return [
        row
        for mode, sign in KINDS
        for ticks in lengths(params.tick_s)
        for row in _kick_wheels(mode, sign, ticks, params, motor, _WHEELS)
    ]


def _params(values: tuple[float, ...]) -> Params:
    params = Params()
    params.apply(dict(zip(_MAPPED, values, strict=True)))
    return params


def _kick_wheels(
    mode: str, sign: int, ticks: int, params: Params, motor: Constants, wheels: int
) -> list[Row]:
    kick: KickCell = {"mode": mode, "sign": sign, "ticks": ticks}
    batches = range(wheels // _BATCH)
    return [
        {**kick, **row}
        for batch in batches
        for row in tally(mode, sign, ticks, _BATCH, _MAP_SEED + batch, params=params, motor=motor)
    ]
