"""What the study `edge` found, in numbers and as answers."""

from __future__ import annotations

from math import degrees, hypot, pi
from typing import TypedDict

import numpy as np

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.fixpoints import Kind, fixpoints
from host.theory.analysis.least_push import KINDS, POTENTIALS, PushKind
from host.theory.model.wheel import Wheel, wheel_of
from host.theory.studies.edge_rows import EDGE, EdgeRow, course_of, least_of, map_of

# A wheel on the edge has come to rest if it is no faster than this (rad/s) in the end.
STILL = 0.01
# The end of a course: its last part.
_END = 0.2


class Push(TypedDict):
    """The least push of a kind.

    Attributes:
        push: what is pushed: potentials or speed.
        amplitude: its size, without unit or in rad/s; None if no push reverses that was tried.
        error: how far it may be off.
        phase_deg: phase of rolling, degrees of a quarter turn.
        direction_deg: in the plane of x1 and x2; of the speed 0 is forward and 180 backward.
        map_least: the least amplitude on the map.
    """

    push: PushKind
    amplitude: float | None
    error: float | None
    phase_deg: float | None
    direction_deg: float | None
    map_least: float | None


class EdgeState(TypedDict):
    """Where the edge leads after the least push of the potentials.

    Attributes:
        rests: whether a wheel on the edge comes to rest.
        phi_deg: where it rests, degrees of a quarter turn; None if it does not.
        kind: the kind of that fixpoint; None without one.
        growth_per_s: how fast a wheel leaves it, 1/s; None without one.
        omega_from: the least angular velocity in the end, rad/s.
        omega_to: the greatest.
    """

    rests: bool
    phi_deg: float | None
    kind: Kind | None
    growth_per_s: float | None
    omega_from: float
    omega_to: float


class Numbers(TypedDict):
    """What the study found.

    Attributes:
        pushes: the least push of each kind.
        x1_alone: the least jump of the first potential alone, on the map; None without one.
        x2_alone: the least jump of the second alone.
        inversion_from: the least size of an inversion of both potentials, 1.
        inversion_to: the greatest.
        rolling_omega: mean speed of rolling, rad/s.
        edge: where the edge leads; None without a push that reverses.
    """

    pushes: list[Push]
    x1_alone: float | None
    x2_alone: float | None
    inversion_from: float
    inversion_to: float
    rolling_omega: float
    edge: EdgeState | None


def report(rows: list[EdgeRow], setting: Setting) -> Findings:
    """The least pushes and the edge state, as numbers and as answers."""
    wheel = wheel_of(setting.options)
    plane = map_of(rows, POTENTIALS)
    inversions = [2.0 * hypot(row["x1"], row["x2"]) for row in plane]
    numbers: Numbers = {
        "pushes": [_push(rows, push) for push in KINDS],
        "x1_alone": _alone(rows, 0.0),
        "x2_alone": _alone(rows, 90.0),
        "inversion_from": min(inversions),
        "inversion_to": max(inversions),
        "rolling_omega": float(np.mean([row["omega"] for row in plane])),
        "edge": _edge(rows, wheel),
    }
    return Findings([], numbers, answers=_answers(numbers))


def _push(rows: list[EdgeRow], push: PushKind) -> Push:
    found = least_of(rows, push)
    tried = [row["amplitude"] for row in map_of(rows, push) if row["amplitude"] is not None]
    return {
        "push": push,
        "amplitude": found and found["amplitude"],
        "error": found and found["error"],
        "phase_deg": found and found["phase_deg"],
        "direction_deg": found and found["direction_deg"],
        "map_least": min(tried, default=None),
    }


def _alone(rows: list[EdgeRow], direction_deg: float) -> float | None:
    """The least push on the map along an axis of the potentials, one way or the other."""
    found = [
        row["amplitude"]
        for row in map_of(rows, POTENTIALS)
        if row["amplitude"] is not None
        and abs((row["direction_deg"] - direction_deg + 90.0) % 180.0 - 90.0) < 1e-6
    ]
    return min(found, default=None)


def _edge(rows: list[EdgeRow], wheel: Wheel) -> EdgeState | None:
    course = course_of(rows, POTENTIALS, EDGE)
    if not course:
        return None
    end = course[-max(1, round(_END * len(course))) :]
    speeds = [row["omega"] for row in end]
    state: EdgeState = {
        "rests": max(abs(speed) for speed in speeds) < STILL,
        "phi_deg": None,
        "kind": None,
        "growth_per_s": None,
        "omega_from": min(speeds),
        "omega_to": max(speeds),
    }
    if state["rests"]:
        eighth = round(end[-1]["phi"] / (pi / 4))
        point = fixpoints(wheel)[eighth % 2]
        state["phi_deg"] = degrees(point.phi)
        state["kind"] = point.kind
        state["growth_per_s"] = float(point.eigenvalues[0].real)
    return state


def _answers(numbers: Numbers) -> list[Answer]:
    potentials, speed = numbers["pushes"]
    inversion = f"{numbers['inversion_from']:.4g} to {numbers['inversion_to']:.4g}"
    return [
        Answer(
            "least jump of x1 and x2 that reverses", potentials["amplitude"], potentials["error"]
        ),
        Answer("  at the phase", potentials["phase_deg"], None, "° of 90°"),
        Answer("  in the direction (x1 is 0°, x2 is 90°)", potentials["direction_deg"], None, "°"),
        Answer("  of x1 alone, on the map", numbers["x1_alone"]),
        Answer("  of x2 alone, on the map", numbers["x2_alone"]),
        Answer("  inversion of both, for comparison", inversion),
        Answer("least push of omega that reverses", speed["amplitude"], speed["error"], "rad/s"),
        Answer("  at the phase", speed["phase_deg"], None, "° of 90°"),
        Answer("  rolling, for comparison", numbers["rolling_omega"], None, "rad/s"),
        Answer("edge state", _in_words(numbers["edge"])),
    ]


def _in_words(edge: EdgeState | None) -> str | None:
    if edge is None:
        return None
    if edge["rests"]:
        return (
            f"rest at {edge['phi_deg']:.0f}° of 90°, a {edge['kind']} that a wheel leaves at"
            f" {edge['growth_per_s']:.6g}/s"
        )
    return f"moves, omega {edge['omega_from']:.4g} to {edge['omega_to']:.4g} rad/s"
