"""Parameters to choose by one click: where the paper shows a behaviour of the robot."""

from __future__ import annotations

from typing import Any, NamedTuple

from host.kicking.modes import CHAOS, MODES, WALL_TURNER
from robot.params import TABLE


class Preset(NamedTuple):
    """Parameters under a name, and a label for people."""

    label: str
    set: dict[str, float]


def _near_default(**changes: float) -> dict[str, float]:
    names = ("a", "tau_s", "k", "rod_lag_s")
    return {name: float(TABLE[name].default) for name in names} | changes


# docs/claims.md has the robot's values: below k = 0.47 it rests; at 2 it turns round at a wall by
# itself; 8 is the paper's own; with 15, a slow neuron and older rods it turns to and fro without a
# rhythm.
PRESETS = {
    "rest": Preset("rest: springs too weak to roll (k = 0.3)", _near_default(k=0.3)),
    "gentle": Preset(
        "gentle: turns round at a wall (k = 2)", _near_default(**MODES[WALL_TURNER].params)
    ),
    "locomotion": Preset("locomotion: forward or backward (k = 8)", _near_default(k=8.0)),
    "chaos": Preset("chaos: to and fro (k = 15, tau = 1 s)", _near_default(**MODES[CHAOS].params)),
}
PRIMITIVES = {
    "forward": "roll forward",
    "backward": "roll backward",
    "spin-left": "turn to the left on the spot",
    "spin-right": "turn to the right on the spot",
    "stopped": "come to rest",
}


def describe_presets() -> list[dict[str, Any]]:
    """The presets as plain data, for the welcome."""
    return [{"name": name, **preset._asdict()} for name, preset in PRESETS.items()]


def describe_primitives() -> list[dict[str, str]]:
    """The primitives as plain data, for the welcome."""
    return [{"name": name, "label": label} for name, label in PRIMITIVES.items()]
