"""kickctl plan."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from host.commands._motor import add_motor
from host.commands._terminal import robot_of, show

if TYPE_CHECKING:
    from host.client.robot import Robot
    from sim_motor.constants import Constants

HELP = "say which kick would turn each wheel to a direction, and when; nothing is kicked"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The direction."""
    parser.add_argument(
        "--to", choices=("forward", "backward"), required=True, help="the direction"
    )
    parser.add_argument(
        "--search",
        choices=("shortest", "least-effort"),
        help="search for the smallest pulse of any parameter that does it, and compare it with the"
        " paper's kicks (10 to 60 s)",
    )
    add_motor(parser)


def run(options: argparse.Namespace) -> int:
    """Watch the wheels, and say the plan for each; or search for the smallest kick."""
    if options.search:
        return _search(options)
    from host.errors import NotDone
    from host.kicking.outcome import OTHER_PARAMETERS, UNSETTLED, require_running, wait_settled
    from host.kicking.robot_motor import motor_of
    from robot.kicks import WHEELS

    with robot_of(options, observe=True) as robot:
        motor = motor_of(robot, options.motor)
        require_running(robot)
        if not wait_settled(robot):
            raise NotDone(f"{UNSETTLED}, so there is no steady motion to reverse", OTHER_PARAMETERS)
        wheels = {side: _plan(robot, side, options.to, motor) for side in WHEELS}
        origin = {
            "params": robot.status()["params"],
            "brick": robot.link.uri,
            "seed": robot.hello["seed"],
        }
    if options.json:
        show({"to": options.to, "wheels": wheels, **origin})
    else:
        for side, found in wheels.items():
            print(_sentence(side, options.to, found, origin["params"]["k"]))
    return 0


def _search(options: argparse.Namespace) -> int:
    from host.commands._plan_search import search_kicks, sentences
    from host.kicking.robot_motor import motor_of
    from robot.params import TABLE, Params

    with robot_of(options, observe=True) as robot:
        motor = motor_of(robot, options.motor)
        values = robot.status()["params"]
        origin = {"params": values, "brick": robot.link.uri, "seed": robot.hello["seed"]}
    params = Params()
    params.apply(params.check({name: values[name] for name in TABLE if name in values}))
    result = search_kicks(options.search, options.to, params, motor)
    if options.json:
        show({"to": options.to, **result, **origin})
    else:
        print("\n".join(sentences(result, options.to, params)))
    return 0


def _plan(robot: Robot, side: str, wanted: str, motor: Constants) -> dict[str, Any]:
    """A wheel's heading, phase and speed, and its kick; None if it already goes as wanted."""
    from math import pi

    from host.kicking.primitives import course, plan
    from host.logs.motion import heading_of
    from host.util.intervals import wilson

    present = heading_of([getattr(record, side + "_phi_rad") for record in robot.recent()])
    params = robot.status()["params"]
    chosen = None if present == wanted else plan(robot, present, wanted, params, motor)
    phi, step = course(robot, side)
    state = {
        "heading": present,
        "phase_rad": phi % (2 * pi),
        "turns_per_s": step / params["tick_s"] / (2 * pi),
    }
    if chosen is None:
        return {**state, "kick": None}
    return {
        **state,
        "kick": chosen.request(),
        "window_rad": chosen.window_rad,
        "wait_ticks": chosen.wait_ticks(phi, step),
        "rate": chosen.reversed / chosen.tried if chosen.tried else None,
        "interval": wilson(chosen.reversed, chosen.tried) if chosen.tried else None,
        "simulated": chosen.tried,
    }


def _sentence(side: str, wanted: str, found: dict[str, Any], k: float) -> str:
    from math import degrees

    state = (
        f"The {side} wheel is {found['heading']} ({found['turns_per_s']:+.2f} turns/s, phase"
        f" {degrees(found['phase_rad']):.0f}°)"
    )
    kick = found["kick"]
    if kick is None:
        return f"{state}, as wanted: no kick."
    shift = f" by {degrees(kick['shift']):+.0f}°" if "shift" in kick else ""
    moment = "at any phase"
    if found["window_rad"] is not None:
        first, last = (degrees(edge) for edge in found["window_rad"])
        moment = f"at a phase from {first:.0f}° to {last:.0f}°"
        moment += (
            " (the wheel does not come there)"
            if found["wait_ticks"] is None
            else f", {found['wait_ticks']} ticks from now"
        )
    reason = "no kick of several ticks is reliable at these parameters"
    if found["heading"] == "stopped":
        reason = (
            f"pushes a resting wheel {wanted}; it rolls on only if k is large enough (k = {k:g})"
        )
    elif found["rate"] is not None:
        low, high = found["interval"]
        reason = (
            f"reversed {found['rate']:.1%} of {found['simulated']} simulated wheels (95 %:"
            f" {low:.1%} to {high:.1%})"
        )
    ticks = f"{kick['ticks']} tick{'s' if kick['ticks'] > 1 else ''}"
    return f"{state}: {kick['mode']} kick{shift} of {ticks}, {moment}; {reason}."
