"""The experiments: help text, options and claims of each.

`kickctl --help` imports it, so it imports nothing heavy.
"""

from __future__ import annotations

from host.runs.presets import OPTION as PRESET
from host.runs.registry import Entry, Option
from host.runs.robot_options import NAMES, robot_options

# On simulated cars, which need no robot: `kickctl[bodies]`.
BODIES = {
    "train-start": Entry(
        "trains of five cars from random wheel phases: order parameter against time, and which way"
        " each goes",
        (
            Option("seeds", 20, 1, 10000, "number of trains of each preset"),
            Option("seconds", 15.0, 2.0, 600.0, "how long each runs, s"),
        ),
        ("B2",),
    ),
    "train-wall": Entry(
        "a train between two walls, dead and bouncy: reversals and leg times, beside a train with"
        " constant torque",
        (
            Option("seeds", 3, 1, 1000, "number of trains of each kind"),
            Option("seconds", 60.0, 10.0, 3600.0, "how long each runs, s"),
        ),
        ("B3",),
    ),
    "train-slope": Entry(
        "a train between four slopes, over their angle and k: reversals, coherence, whether it"
        " stays inside",
        (
            Option("seeds", 2, 1, 1000, "number of trains of each kind"),
            Option("seconds", 30.0, 10.0, 3600.0, "how long each runs, s"),
        ),
    ),
    "train-wiggle": Entry(
        "the travelling wave along a fast train's joints: amplitude, frequency, lag, beside the"
        " authors' program",
        (Option("seconds", 60.0, 10.0, 3600.0, "how long each train runs, s"),),
    ),
    "train-kick": Entry(
        "how many wheels of a running train must be kicked, and for how long, to reverse all of it",
        (
            Option("trials", 4, 1, 10000, "number of tries of each kick"),
            Option("preset", "paper", 0, 0, "which train", ("paper", "snake2019")),
        ),
    ),
    "train-goal": Entry(
        "drive a train to goals by kicks that it has learned, beside random kicks and none",
        (Option("goals", 10, 1, 1000, "number of goals, each from a start of its own"),),
    ),
    "train-fault": Entry(
        "a train with one wheel weaker or dead, or with wheels of different size: order, speed,"
        " turning",
        (
            Option("seeds", 2, 1, 1000, "number of trains of each kind"),
            Option("seconds", 30.0, 5.0, 3600.0, "how long each runs, s"),
            Option("preset", "snake2019", 0, 0, "which train", ("paper", "snake2019")),
        ),
    ),
    "car-slope": Entry(
        "the car between four slopes for ten minutes: its way, and whether it stays inside and on"
        " its wheels",
        (
            Option("seeds", 3, 1, 1000, "number of cars on slopes of each angle"),
            Option("seconds", 600.0, 10.0, 36000.0, "how long each drives, s"),
        ),
        ("B1",),
    ),
    "car-route": Entry(
        "rest, forth-and-back and rolling of the car over k, and its speed beside the formula",
        (
            Option("seeds", 6, 1, 1000, "number of starts for each k"),
            Option("seconds", 15.0, 6.0, 600.0, "how long each drives, s"),
        ),
    ),
}

ROBOT = {
    "primitives": Entry(
        "all motion primitives from each other by kicks, stopped and back: success rates and times,"
        " speed, duty, torque",
        (Option("trials", 10, 1, 1000, "number of tries of each transition"), PRESET),
        ("R1", "R2", "R3", "R4", "R7"),
    ),
    "timeline": Entry(
        "the three kicks one after the other: potentials, torque, settling times, and the phase"
        " slip between the wheels",
        (
            Option("trials", 25, 1, 10000, "number of rounds of the three kicks, there and back"),
            *robot_options(),
            PRESET,
        ),
        ("R11", "R12"),
    ),
    "reliability": Entry(
        "how reliably kicks of 1 to 10 ticks reverse a wheel: position, phase of both signs, and"
        " membrane",
        (
            Option("trials", 50, 1, 100000, "number of kicks at each point"),
            *robot_options(),
            PRESET,
        ),
        ("R8", "R9", "R10"),
    ),
    "kick-map": Entry(
        "how often a kick reverses a wheel, against the kick's length and the wheel's phase when"
        " it begins",
        (
            Option("kicks", 200000, 36, 100000000, "number of kicks; on a robot a few hundred"),
            *robot_options(),
            PRESET,
        ),
    ),
    "bifurcation": Entry(
        "torque and speed against k, swept down and up: the jump, the hysteresis, and the unstable"
        " branch between",
        (
            Option("points", 33, 5, 1000, "number of values of k in each sweep"),
            Option("rounds", 3, 1, 1000, "number of sweeps and descents in each direction"),
            Option(
                "branch", 13, 0, 13, "number of speeds at which k is regulated, in each direction"
            ),
            Option("k", 8.0, 1.5, 100.0, "greatest spring constant of the rods, without unit"),
            *robot_options()[1:],
            PRESET,
        ),
        ("R5", "R6"),
    ),
    "wall": Entry(
        "a robot with k = 2 between two walls, which reverses by itself: on which axles, floors,"
        " fronts and batteries",
        (
            Option("bounces", 50, 1, 10000, "number of bounces to count"),
            *robot_options(k=2.0),
            PRESET,
        ),
        ("R13",),
    ),
    "chaos": Entry(
        "k = 15 and tau = 1 s: torque series, return map, Lyapunov exponent, and which older rods"
        " make it chaotic",
        (
            Option("minutes", 10.0, 1.0, 600.0, "length of the series, minutes"),
            *robot_options(k=15.0, tau=1.0),
            PRESET,
        ),
        ("R14",),
    ),
    "starts": Entry(
        "start the robot from rest many times: which way each wheel goes, and whether both ways"
        " are equally likely",
        (Option("starts", 100, 1, 100000, "number of starts"),),
    ),
    "predictions": Entry(
        "predict kicks at random, then give them: whether the predicted shares come true, and how"
        " sure they are",
        (Option("kicks", 500, 1, 100000, "number of kicks"),),
    ),
    "calibrate": Entry(
        "identify this robot's motor from a drive, and write it as a file for sim://?motor=mine",
        (Option("seconds", 120.0, 60.0, 3600.0, "how long to drive the robot about, s"),),
    ),
}

# On the simulated robot only: they need to know where it is, or hundreds of it.
SIMULATED = {
    "explore": Entry(
        "how the simulated robot covers a floor between walls: in chaos, straight on, with kicks at"
        " random times, beside a random walk",
        (
            Option("robots", 20, 2, 1000, "number of robots with each way of moving"),
            Option("minutes", 10.0, 0.2, 600.0, "how long each drives, minutes"),
        ),
    ),
    "leave-chaos": Entry(
        "which kicks bring the simulated robot out of chaos, alone or with its own parameters set"
        " back: to rest, straight on, or to a turn",
        (Option("robots", 200, 10, 100000, "number of moments at which each kick is tried"),),
    ),
    "exponents": Entry(
        "the largest Lyapunov exponent over k and tau: of the simulated robot, of one with older"
        " rods, and of the model",
        (Option("pairs", 32, 4, 10000, "number of pairs of robots at each point"),),
    ),
}

TABLE = {**ROBOT, **SIMULATED, **BODIES}


def claimed(name: str) -> dict[str, float | str | None]:
    """The robot's parameters for which an experiment's claims are made, by their options."""
    return {option.name: option.default for option in ROBOT[name].options if option.name in NAMES}
