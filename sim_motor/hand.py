"""A hand on the simulated wheels, led by lines on standard input: a panel of the robot's program.

    left 1.25    pull the left wheel towards the angle 1.25 rad, as the robot counts it
    right -      let go of the right wheel

The hand lets go of a wheel of which it has heard nothing for SILENCE_S. The end of the input ends
the program: whoever holds the other end of the pipe has gone.

The robot does not know of the hand. It feels it as a torque on its wheels.
"""

import os
import select
from collections.abc import Callable
from math import isfinite, nan

from robot.kicks import WHEELS
from robot.loop import Loop
from sim_motor.brick import SimBrick

SILENCE_S = 0.5
# The hand is a spring with a damper, and no stronger than MOST_NM: 15 N at the rim of a wheel of
# 28 mm, which fingers can do. A motor at k = 8 turns with 0.3 N m when it is held; so a hand can
# hold it, up to 30 degrees away from where it pulls. The hand feels the wheel once a tick; a spring
# or a damper much harder than these would swing by itself then.
STIFFNESS_NM_RAD = 0.6
DAMPING_NM_S_RAD = 0.05
MOST_NM = 0.42

_READ_BYTES = 4096
_LONGEST_LINE = 80


def pull(away_rad: float, speed: float) -> float:
    """The torque (N m) of the hand on a wheel.

    Args:
        away_rad: How far the wheel is behind the angle to which the hand pulls it, rad.
        speed: The wheel's speed, rad/s.
    """
    torque = STIFFNESS_NM_RAD * away_rad - DAMPING_NM_S_RAD * speed
    return max(-MOST_NM, min(MOST_NM, torque))


class Grip:
    """Holds wheels of a simulated robot.

    Args:
        brick: Whose wheels it holds.
    """

    def __init__(self, brick: SimBrick) -> None:
        self._brick = brick
        self._holds: dict[str, tuple[float, float]] = {}  # wheel -> (angle in rad, heard of in s)

    def hold(self, side: str, angle_rad: float, now: float) -> None:
        """Pull a wheel towards an angle (rad, as the robot counts it) until SILENCE_S from now."""
        self._holds[side] = angle_rad, now

    def let_go(self, side: str) -> None:
        """Let go of a wheel."""
        self._holds.pop(side, None)
        self._brick.set_load(WHEELS.index(side), 0.0)

    def pull(self, loop: Loop) -> None:
        """Pull the wheels that it holds; to be called once a tick.

        Args:
            loop: The robot's.
        """
        now = loop.clock.now()
        polarities = loop.params.polarity_left, loop.params.polarity_right
        for side, (target, heard_s) in list(self._holds.items()):
            if now - heard_s > SILENCE_S:
                self.let_go(side)
                continue
            index = WHEELS.index(side)
            motor = self._brick.motors[index]
            truth = motor.truth()
            away_rad = polarities[index] * motor.mount * target - truth.wheel_angle
            self._brick.set_load(index, pull(away_rad, truth.wheel_speed))


class Hand:
    """The hand.

    Args:
        brick: Whose wheels it holds.
        lines: A file descriptor to read lines from.
        say: Called with the words about the first line that is wrong.
    """

    def __init__(self, brick: SimBrick, lines: int, say: Callable[[str], object]) -> None:
        self._grip = Grip(brick)
        self._lines = lines
        self._say = say
        self._rest = b""
        self._complained = False

    def serve(self, loop: Loop) -> None:
        """Read what has come, and pull.

        Args:
            loop: The robot's.
        """
        if self._read(loop.clock.now()):
            self._grip.pull(loop)
        else:
            loop.done = True
            self.close()

    def close(self) -> None:
        """Let go of both wheels."""
        for side in WHEELS:
            self._grip.let_go(side)

    def _read(self, now: float) -> bool:
        """Obey the lines that have come, without waiting. Returns whether more can come."""
        try:
            if not select.select([self._lines], [], [], 0.0)[0]:
                return True
            data = os.read(self._lines, _READ_BYTES)
        except (OSError, ValueError):
            return False
        *lines, self._rest = (self._rest + data).split(b"\n")
        if len(self._rest) > _LONGEST_LINE:
            lines.append(self._rest)
            self._rest = b""
        for line in lines:
            self._obey(line.decode("ascii", "replace"), now)
        return bool(data)

    def _obey(self, line: str, now: float) -> None:
        side, _, angle = line.strip().partition(" ")
        target = _number(angle)
        if side in WHEELS and angle == "-":
            self._grip.let_go(side)
        elif side in WHEELS and isfinite(target):
            self._grip.hold(side, target, now)
        elif not self._complained:
            self._complained = True
            self._say(
                f"the hand ignores the line {line[:40]!r}, and others like it: write 'left' or"
                " 'right', and an angle in rad or '-', as in: left 1.25"
            )


def _number(text: str) -> float:
    """The number in a text; NaN if there is none."""
    try:
        return float(text)
    except ValueError:
        return nan
