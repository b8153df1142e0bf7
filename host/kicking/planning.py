"""Which quenched kick reverses a wheel, and at which moment.

The choice from the kick map of its parameters.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import asdict, dataclass
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
from robot import __version__
from robot.params import Params

SURE = 0.99
# Of a plan's own map: enough to tell 99 % from 97 % in one direction. Small pieces, between which a
# link is kept alive.
_WHEELS, _WINDOW_WHEELS, _PIECE = 300, 4800, 300
_WINDOW_CANDIDATES = 3
_MAP_SEED = 1
_TURNS, _LEAST_STEP_RAD = 4, 0.01
# The parameters that the map depends on.
_MAPPED = ("a", "tau_s", "k", "rods", "max_duty_pct", "tick_s")

KickName = tuple[str, int, int]


@dataclass(frozen=True)
class Plan:
    """A kick for one wheel. shift_rad: of a phase kick; window_rad.

    At phases (mod 2 pi) from, and up to; None for any.

    tried, reversed: simulated kicks of this kind, in that window, and how many of them reversed; 0
    if it comes from no map.
    """

    mode: str
    ticks: int
    shift_rad: float | None = None
    window_rad: tuple[float, float] | None = None
    tried: int = 0
    reversed: int = 0

    def request(self) -> dict[str, Any]:
        """The kick, as robot.kicks.parse takes it."""
        return request(self.mode, self.ticks, self.shift_rad)

    def window_deg(self) -> list[float] | None:
        """The window in degrees."""
        return None if self.window_rad is None else [degrees(edge) for edge in self.window_rad]

    def meets(self, phi_rad: float) -> bool:
        """Whether the wheel's angle at the kick's begin lies in the window."""
        if self.window_rad is None:
            return True
        first, last = self.window_rad
        return (phi_rad - first) % tau <= (last - first) % tau

    def wait_ticks(self, phi_rad: float, step_rad: float) -> int | None:
        """How many ticks from now a wheel at phi that turns by a step each tick meets the window.

        None if not within some turns.
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

    At any phase if there is one, else at the right moment.

    Of the lengths that are sure at any phase, the one farthest from those that are not, as no robot
    is quite its model; of several the shortest. Else the kick with the widest window of sure
    phases. None if there is neither.
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
    """How many steps of length each sure kick is away from the next that is not.

    What was not tried is not sure.
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
    """The kick in the longest run of sure bins, around the circle.

    None if there is none of three bins or more.
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
    before: int, values: dict[str, Any], say: Callable[[str], None] = lambda words: None
) -> Plan | None:
    """The plan for a wheel that runs in this direction, at a robot's parameters by name.

    None if no quenched kick is sure.

    The map takes some seconds, once for these parameters, of which `say` is told: its plan is kept
    in ${XDG_CACHE_HOME:-~/.cache}/kickctl/plans.json.
    """
    chosen = tuple(values[name] for name in _MAPPED)
    key = json.dumps([__version__, before, *chosen])
    kept = _kept()
    if key not in kept:
        say("computing which kicks reverse a wheel at these parameters: some seconds, this once")
        plan = _planned(before, *chosen)
        _keep({**_kept(), key: plan and asdict(plan)})
        return plan
    return kept[key] and Plan(
        **{**kept[key], "window_rad": kept[key]["window_rad"] and tuple(kept[key]["window_rad"])}
    )


def _file() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "kickctl", "plans.json")


def _kept() -> dict[str, Any]:
    """The plans that were kept, by what they are for.

    None if there are none, or none that can be read.
    """
    try:
        kept = json.loads(_file().read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return kept if isinstance(kept, dict) else {}


def _keep(plans: dict[str, Any]) -> None:
    """Keep them, if there is room; without, the next plan takes its time again."""
    new = _file().with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        new.parent.mkdir(parents=True, exist_ok=True)
        new.write_text(json.dumps(plans), encoding="utf-8")
        new.replace(_file())


@cache
def _planned(before: int, *values: float) -> Plan | None:
    rows = _chart(*values)
    plan = choose(rows, before)
    if plan is not None and plan.window_rad is None:
        return plan
    kicks = _by_kick(rows, before)
    best = sorted(kicks, key=lambda kick: -count(kicks[kick])[0])[:_WINDOW_CANDIDATES]
    return choose(
        [row for kick in best for row in _mapped(*kick, _params(values), _WINDOW_WHEELS)], before
    )


@cache
def _chart(*values: float) -> list[Row]:
    params = _params(values)
    return [
        row
        for mode, sign in KINDS
        for ticks in lengths(params.tick_s)
        for row in _mapped(mode, sign, ticks, params, _WHEELS)
    ]


def _params(values: tuple[float, ...]) -> Params:
    params = Params()
    params.apply(dict(zip(_MAPPED, values, strict=True)))
    return params


def _mapped(mode: str, sign: int, ticks: int, params: Params, wheels: int) -> list[Row]:
    kick: KickCell = {"mode": mode, "sign": sign, "ticks": ticks}
    pieces = range(wheels // _PIECE)
    return [
        {**kick, **row}
        for piece in pieces
        for row in tally(mode, sign, ticks, _PIECE, _MAP_SEED + piece, params=params)
    ]
