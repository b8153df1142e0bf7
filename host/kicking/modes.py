"""Modes of the paper's robot that parameters make, and the way there and back.

`enter` sets a mode's parameters, and `leave` gives the robot its own ones back, also from another
program on the same machine: a small file keeps them for as long as the robot's program runs.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlencode

from host.client.robot import Robot
from host.errors import KickctlError, NotDone
from host.kicking.outcome import Outcome, kick_and_watch, require_running
from host.kicking.primitives import drive, headings
from host.link.addresses import SIM
from host.logs.log import Log
from host.logs.motion import directions
from host.runs.presets import PAPER, PRESETS
from host.util.installation import deploy_command
from host.util.whole_files import write_text
from robot.kicks import PHASE, WHEELS
from robot.params import TABLE
from robot.user_folders import cache_folder
from sim_motor.constants import Constants


class Mode(NamedTuple):
    """Parameters under a name.

    Attributes:
        params: What the paper's robot needs for it, by name. All others stay.
        advice: What a real robot needs, and what to watch.
        address: A simulated robot with which it works at its best.
    """

    params: dict[str, float]
    advice: str
    address: str


CHAOS, WALL_TURNER = "chaos", "wall-turner"
MODES = {
    CHAOS: Mode(
        {"k": 15.0, "tau_s": 1.0, **PRESETS[PAPER].params},
        "both wheels turn to and fro without a rhythm. A real robot needs room on all sides, and a"
        " battery of 7.2 to 7.5 V: far below that its wheels roll steadily",
        "sim://?grip=1.7",
    ),
    WALL_TURNER: Mode(
        {"k": 2.0},
        "at a wall the wheels turn round by themselves. A real robot needs a carpet, on which the"
        " tyres do not spin, long axles from motors to wheels, which spring back, and a battery of"
        " 7.2 to 7.5 V",
        SIM + "?" + urlencode({"walls": "2", **PRESETS[PAPER].scene}),
    ),
}
# How long the robot is watched in chaos, and how often each wheel must change its direction to
# count. It does so about once in 1.1 s.
CHAOS_S, LEAST_TURNS = 12.0, 3
MOST_KICKS = 4
# How many robots' own parameters are kept.
_KEPT = 50


class Way(NamedTuple):
    """The way back from a mode.

    Attributes:
        params: What was set, by name; empty if the robot was in no mode.
        known: Whether this machine knew what the robot had before; else these are the defaults.
    """

    params: dict[str, Any]
    known: bool


def enter(robot: Robot, log: Log, name: str, motor: Constants | None = None) -> dict[str, Any]:
    """Bring a robot that runs into a mode. Its own parameters are kept for `leave`.

    Args:
        robot: The robot.
        log: A log that records it already.
        name: A key of MODES.
        motor: As in `host.kicking.primitives.drive`.

    Returns:
        {primitive, reached, before, after, kicks, k, k_before, params, own, kept}: as
        `host.kicking.primitives.drive` does, with the mode's parameters, those of the robot that
        stood in their place, and whether a file keeps these.

    Raises:
        KickctlError: The robot does not run, or cannot be reached. If it can, it has its own
            parameters back.
    """
    in_force = robot.status()["params"]
    wanted = {key: value for key, value in MODES[name].params.items() if key in in_force}
    if missing := sorted(set(MODES[name].params) - set(wanted)):
        raise NotDone(
            f"the robot's program has no parameter {', '.join(missing)}",
            f"bring this release to it: {deploy_command()}",
        )
    back = _way_back(robot, in_force).params
    own = {**{key: in_force[key] for key in wanted}, **back}
    kept = _keep(robot, name, own)
    before = headings(robot, log)
    try:
        robot.set(**{**own, **wanted})
        found = _into_chaos(robot, log) if name == CHAOS else drive(robot, log, "forward", motor)
        require_running(robot)
        in_the_end = robot.status()["params"]
        if any(in_the_end[key] != value for key, value in wanted.items()):
            raise NotDone(
                "the robot lost the parameters meanwhile: its program has restarted, or somebody"
                " else has set them",
                "try again",
            )
    except BaseException:
        with suppress(KickctlError):
            leave(robot)
        raise
    return {
        **found,
        "primitive": name,
        "before": before,
        "k": wanted["k"],
        "k_before": float(in_force["k"]),
        "params": wanted,
        "own": own,
        "kept": kept,
    }


def leave(robot: Robot) -> Way:
    """Give a robot in a mode its own parameters back, but for those that were set since.

    Returns:
        The way back.
    """
    way = _way_back(robot, robot.status()["params"])
    if way.params:
        robot.set(**way.params)
    _forget(robot)
    return way


def _way_back(robot: Robot, in_force: dict[str, Any]) -> Way:
    """What brings a robot with these parameters out of the mode in which it is."""
    mode, own = _kept(robot)
    if mode:
        set_then = MODES[mode].params
        return Way(
            {key: own[key] for key in own if in_force.get(key) == set_then.get(key)}, known=True
        )
    chaos = MODES[CHAOS].params
    if all(in_force.get(key) == value for key, value in chaos.items()):
        return Way({key: TABLE[key].default for key in chaos}, known=False)
    return Way({}, known=False)  # who set k = 2 by hand wants it


def _into_chaos(robot: Robot, log: Log) -> dict[str, Any]:
    """Watch both wheels turn to and fro; kick those that rest."""
    kicks: list[Outcome] = []
    while True:
        first = len(log)
        robot.wait(CHAOS_S)
        turns = {side: _turns(log, side, first) for side in WHEELS}
        resting = [side for side in WHEELS if turns[side] == 0]
        if not resting or len(kicks) >= MOST_KICKS:
            break
        side = "both" if len(resting) == len(WHEELS) else resting[0]
        kicks.append(kick_and_watch(robot, log, PHASE, wheel=side))
    return {
        "reached": min(turns.values()) >= LEAST_TURNS,
        "after": {side: f"reversed {count} times" for side, count in turns.items()},
        "kicks": [outcome.as_dict() for outcome in kicks],
        "turns": turns,
    }


def _turns(log: Log, side: str, first: int) -> int:
    """How often a wheel has changed its direction since this row of a log."""
    way = directions(log.column(side + "_phi_rad")[first:])
    return sum(a != b for a, b in pairwise(way[way != 0].tolist()))


def _place(robot: Robot) -> Path | None:
    """The file with the own parameters of a robot whose program has not ended since."""
    folder = cache_folder()
    boot = str(robot.hello["boot"])
    return Path(folder) / "own-parameters" / f"{boot}.json" if folder and boot.isalnum() else None


def _kept(robot: Robot) -> tuple[str, dict[str, Any]]:
    """The mode in which this machine left a robot, and its own parameters; empty for none."""
    place = _place(robot)
    try:
        kept = json.loads(place.read_text(encoding="utf-8")) if place else {}
        mode, own = kept["mode"], kept["own"]
        known = mode in MODES and set(own) <= set(TABLE)
    except (OSError, ValueError, KeyError, TypeError):
        return "", {}
    return (mode, dict(own)) if known else ("", {})


def _keep(robot: Robot, mode: str, own: dict[str, Any]) -> bool:
    """Keep the own parameters of a robot that goes into a mode. Returns whether that worked."""
    place = _place(robot)
    if place is None:
        return False
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        write_text(place, json.dumps({"mode": mode, "own": own}, allow_nan=False))
        for old in sorted(place.parent.glob("*.json"), key=os.path.getmtime)[:-_KEPT]:
            old.unlink()
    except OSError:
        return False
    return True


def _forget(robot: Robot) -> None:
    place = _place(robot)
    if place is not None:
        with suppress(OSError):
            place.unlink()
