"""Settings of all that the paper leaves open: as published or assumed, and one that fits it."""

from __future__ import annotations

from typing import NamedTuple

from host.runs.registry import Option


class Preset(NamedTuple):
    """What differs from the ordinary setting.

    Attributes:
        params: Parameters of the robot, by name.
        scene: The simulated robot's floor and body, by the fields of sim_motor.scene.Scene, as in
            an address.
    """

    params: dict[str, float]
    scene: dict[str, str]


ORDINARY, PAPER = "ordinary", "paper"
PRESETS = {
    ORDINARY: Preset({}, {}),
    # The rods' lag: a program that reads the sensor anew in each formula, 3.65 ms for a reading,
    # computes F_i from positions that are one to two readings older than F_tan. The axle is as
    # stiff as a LEGO axle of some 20 mm, see sim_motor/axle.py; the grip is that of the roughest
    # carpet in the source of `grip_on_carpet`; the front is wider than the body.
    PAPER: Preset({"rod_lag_s": 0.006}, {"axle": "400", "grip": "1.83", "bumper": "0.25"}),
}
ABOUT = (
    "The setting 'paper' chooses what the paper leaves open: rods that are"
    f" {1000 * PRESETS[PAPER].params['rod_lag_s']:g} ms older in the forces F_i than the angle in"
    f" F_tan, axles of {PRESETS[PAPER].scene['axle']} N/m, grip {PRESETS[PAPER].scene['grip']},"
    f" and a front {PRESETS[PAPER].scene['bumper']} m wide. A program that reads the sensor anew in"
    " each formula would have such rods: a hypothesis that fits the paper's 30 to 40 ms."
)
OPTION = Option(
    "preset",
    ORDINARY,
    0,
    0,
    "what the paper leaves open: ordinary is as published or assumed, paper is a setting in which"
    " R1 to R14 hold together",
    tuple(PRESETS),
)
