"""`kickctl plan --search`: the smallest pulses beside the paper's kicks, as data and in words."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees
from typing import TYPE_CHECKING, Any

from host.errors import NotDone

if TYPE_CHECKING:
    from host.kicking.rolling_wheels import RollingWheels
    from host.kicking.search import Found
    from host.kicking.search_margins import Odds, Safety
    from robot.params import Params
    from sim_motor.constants import Constants

_NAMES = {"tau_s": "tau", "battery_v": "battery"}


def search_kicks(goal: str, wanted: str, params: Params, motor: Constants) -> dict[str, Any]:
    """The smallest pulses that turn a wheel to a direction, and the paper's kicks.

    Args:
        goal: One of host.kicking.search.GOALS.
        wanted: The direction to turn to, forward or backward.
        params: The robot's parameters.
        motor: The constants of the robot's motors.

    Raises:
        NotDone: No wheel rolls at these parameters.
    """
    from host.kicking.outcome import DIRECTIONS, OTHER_PARAMETERS
    from host.kicking.rolling_wheels import roll
    from host.kicking.search import paper_kicks, search
    from host.kicking.search_margins import assess
    from host.util.progress import progress

    wheels = roll(params, motor, -DIRECTIONS[wanted])
    if wheels is None:
        raise NotDone(
            f"at k = {params.k:g} and tau_s = {params.tau_s:g} no simulated wheel rolls steadily,"
            " so there is nothing to reverse",
            OTHER_PARAMETERS,
        )
    with progress("searching for kicks", 100.0) as tell:
        found = search(wheels, goal, lambda part: tell(60.0 * part))
        papers = paper_kicks(wheels)
        safe = assess([*found, *papers], wheels, lambda part: tell(60.0 + 40.0 * part))
    rows = [_as_data(*pair, wheels) for pair in zip([*found, *papers], safe, strict=True)]
    return {
        "search": goal,
        "period_rad": wheels.period_rad,
        "found": rows[: len(found)],
        "paper": rows[len(found) :],
    }


def _as_data(found: Found, safety: Safety, wheels: RollingWheels) -> dict[str, Any]:
    window, phase_off_rad = None, 0.0
    if found.window is not None:
        window = [found.window.first_rad, found.window.first_rad + found.window.width_rad]
        phase_off_rad = found.window.width_rad / 2
    return {
        "kick": found.request,
        "length_s": found.request["ticks"] * wheels.params.tick_s,
        "effort_s": found.effort_s,
        "window_rad": window,
        "in_window": _odds(safety.in_window),
        "at_any_phase": _odds(safety.at_any_phase),
        "phase_may_be_off_rad": phase_off_rad,
        "may_be_off": {name: list(ends) for name, ends in safety.margins.items()},
    }


def _odds(odds: Odds) -> dict[str, Any]:
    return {**odds._asdict(), "interval": odds.interval() if odds.tried else None}


def sentences(result: dict[str, Any], wanted: str, params: Params) -> Iterator[str]:
    """The result in words, line by line."""
    from host.kicking.search import SHORTEST
    from host.kicking.search_margins import STEPS

    way = {"forward": "backward", "backward": "forward"}[wanted]
    order = "the shortest" if result["search"] == SHORTEST else "the least effort"
    yield (
        f"Pulses that reverse a wheel that rolls {way}, {order} first"
        f" (k = {params.k:g}, tau = {params.tau_s:g} s, a = {params.a:g}, tick = {params.tick_s:g}"
        " s):"
    )
    yield from _blocks(result["found"], result["period_rad"])
    if not result["found"]:
        yield "  none of the pulses that were tried does it"
    yield "The paper's kicks:"
    yield from _blocks(result["paper"], result["period_rad"])
    yield (
        "An effort of 1 s inverts for 1 s what the neurons see, or changes a, tau or k for 1 s by"
        f" as much as they are. Phases are angles within {degrees(result['period_rad']):.0f}°,"
        " after which a wheel looks the same. Parameters and battery were tried up to"
        f" {max(STEPS):.0%} off, one at a time."
    )


def _blocks(rows: list[dict[str, Any]], period_rad: float) -> Iterator[str]:
    for row in rows:
        effort = "" if row["effort_s"] is None else f", effort {row['effort_s']:.3g} s"
        yield f"  {_name(row['kick'])} ({1000 * row['length_s']:.0f} ms){effort}"
        odds = row["at_any_phase"]
        if row["window_rad"] is None:
            yield f"    reversed {_share(odds)}; sure at no phase"
            continue
        first, last = row["window_rad"]
        timed, phase = "", "any phase"
        if last - first >= period_rad:
            yield f"    at any phase: reversed {_share(odds)}"
        else:
            phase = f"phase ±{degrees(row['phase_may_be_off_rad']):.0f}°"
            timed = f" --wheel left --window {degrees(first):.0f},{degrees(last):.0f}"
            yield (
                f"    at a phase from {degrees(first):.0f}° to {degrees(last):.0f}°: reversed"
                f" {_share(row['in_window'])}; at any phase {_share(odds)}"
            )
        ends = ", ".join(
            f"{_NAMES.get(name, name)} -{low:.0%} to +{high:.0%}"
            for name, (low, high) in row["may_be_off"].items()
        )
        yield f"    still does with {phase}, {ends}"
        yield f"    kickctl kick{_as_options(row['kick'])}{timed}"


def _name(kick: dict[str, Any]) -> str:
    ticks = f"{kick['ticks']} tick{'s' if kick['ticks'] > 1 else ''}"
    if "param" in kick:
        shape = "smooth pulse" if "shape" in kick else "pulse"
        return f"{shape} of {kick['param']} to {kick['value']:.4g}, {ticks}"
    shift = f" by {degrees(kick['shift']):+.0f}°" if "shift" in kick else ""
    return f"{kick['mode']} kick{shift}, {ticks}"


def _share(odds: dict[str, Any]) -> str:
    if not odds["tried"]:
        return "none of 0"
    low, high = odds["interval"]
    return f"{odds['reversed']} of {odds['tried']} simulated wheels (95 %: {low:.1%} to {high:.1%})"


def _as_options(kick: dict[str, Any]) -> str:
    # A frozen kick has no length to give.
    given = {name: value for name, value in kick.items() if name != "ticks" or value > 1}
    return "".join(
        f" --{name} {f'{value:.6g}' if isinstance(value, float) else value}"
        for name, value in given.items()
    )
