"""The paper's claims about kicks (R1, R8 to R10), over many seeds.

Each trial goes through the robot's whole loop in virtual time.
"""

from functools import cache
from math import pi

import pytest

from host.logs.motion import heading_of
from robot.kicks import WHEELS
from robot.loop import Loop
from sim_motor.brick import SimBrick

TRIALS = 50
OPPOSITE = {"forward": "backward", "backward": "forward"}


@cache
def trial(seed, **kick):
    """Start a robot, let it settle, kick both wheels and watch them.

    Returns ((heading before, heading after), the same) of the left and the right wheel.
    """
    brick = SimBrick(seed)
    loop = Loop(brick.motors, brick.battery, brick.clock, seed)
    loop.start()
    angles = {side: [] for side in WHEELS}

    def run(ticks):
        for _ in range(ticks):
            loop.clock.wait(loop.deadline, lambda timeout_s: None)
            loop.tick()
            for side, motor in zip(WHEELS, brick.motors, strict=True):
                angles[side].append(motor.angle_rad())

    run(130 + seed % 17)
    before = [heading_of(angles[side]) for side in WHEELS]
    loop.kick({"id": "trial", **kick})
    run(kick.get("ticks", 1) + 100)
    return tuple((old, heading_of(angles[side])) for old, side in zip(before, WHEELS, strict=True))


def reversals(**kick):
    """How many of TRIALS robots had both wheels reversed."""
    return sum(
        all(new == OPPOSITE.get(old) for old, new in trial(seed, **kick)) for seed in range(TRIALS)
    )


def test_r8_membrane_inversion_always_reverses():
    assert reversals(mode="membrane") == TRIALS


@pytest.mark.parametrize("mode", ["position", "phase"])
def test_r9_r10_quenched_kicks_are_reliable_for_3_to_5_ticks_and_fail_for_1(mode):
    assert any(reversals(mode=mode, ticks=ticks) >= 0.95 * TRIALS for ticks in (4, 3, 5))
    assert reversals(mode=mode, ticks=1) <= 0.1 * TRIALS


def test_r9_long_position_kicks_fail_again():
    assert reversals(mode="position", ticks=9) <= 0.1 * TRIALS


@pytest.mark.parametrize(("sign", "begins"), [(1, "forward"), (-1, "backward")])
def test_r10_the_sign_that_the_paper_names_reverses(sign, begins):
    outcomes = [
        turn
        for seed in range(TRIALS)
        for turn in trial(seed, mode="phase", ticks=3, shift=sign * 3 * pi / 4)
    ]
    reversed_ones = [new == OPPOSITE[begins] for old, new in outcomes if old == begins]
    assert len(reversed_ones) >= TRIALS / 2
    assert sum(reversed_ones) >= 0.95 * len(reversed_ones)


def test_r1_both_directions_are_reached_from_random_starts():
    headings = [old for seed in range(TRIALS) for old, _ in trial(seed, mode="membrane")]
    assert min(headings.count("forward"), headings.count("backward")) >= 0.3 * len(headings)
