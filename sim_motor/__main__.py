"""A brick on the desk: the robot's own program in real time, with simulated motors.

python -m sim_motor --port 5425, and in another terminal: kickctl --brick tcp://127.0.0.1:5425 kick
--mode phase

With --hand, lines on standard input pull at its wheels, see sim_motor/hand.py; with --walls 2 it
drives between two walls.

With --sysfs it is only the brick's hardware, as files that the robot's program for the real brick
can run on: python -m sim_motor --sysfs FOLDER, and in another terminal: python -m robot --sysfs
FOLDER
"""

import sys
from typing import Any

from robot.beacon import Announcer
from robot.motors import MonotonicClock
from robot.program import arguments, choose_seed, run
from robot.words import say
from sim_motor.brick import SimBrick
from sim_motor.clock import VirtualClock
from sim_motor.hand import SILENCE_S, Hand
from sim_motor.mount import serve
from sim_motor.scene import Scene


def main() -> int:
    """Run until interrupted. Returns the exit status."""
    known = arguments(
        "A brick on the desk: the robot's program in real time, with simulated motors.",
        host="127.0.0.1",
    )
    known.add("motor", "pybricks", "which set of constants of motors.toml", "NAME")
    known.add("battery", None, "open-circuit voltage of the battery", "V", float)
    known.add("walls", None, "put the robot halfway between two walls, M metres apart", "M", float)
    known.add("grip", None, "friction coefficient of its tyres between the walls", "MU", float)
    known.add("bumper", None, "width of its body's front and rear", "M", float)
    known.add("axle", None, "stiffness of the axle from a motor to its wheel", "N/M", float)
    known.add(
        "hand",
        False,
        "let lines on standard input pull at the wheels: 'left 1.25' pulls the left wheel towards"
        " the angle 1.25 rad, 'left -' lets go, as does silence of"
        f" {SILENCE_S:g} s; the end of the input ends the program",
    )
    known.add(
        "sysfs",
        None,
        "mount the motors' files there instead, without the robot's program",
        "MOUNTPOINT",
    )
    options = known.parse(sys.argv[1:])
    if options.hand and options.sysfs:
        known.error("--hand belongs to the robot's program, which --sysfs leaves out")
    if options.hand and sys.stdin is None:
        known.error("--hand reads standard input, and there is none: leave it open")
    seed = choose_seed(options)
    clock = VirtualClock(seed, jitter=False) if options.sysfs else MonotonicClock()
    try:
        brick = SimBrick(
            seed,
            clock=clock,
            motor=options.motor,
            battery_v=options.battery,
            scene=_scene(options),
        )
    except ValueError as error:
        known.error(str(error))
    if options.sysfs:
        return serve(options.sysfs, brick)

    def warn(text: str) -> None:
        say(text, sys.stderr)

    panels: list[Announcer | Hand] = [Announcer(warn)]
    if options.hand:
        panels.append(Hand(brick, sys.stdin.fileno(), warn))
    return int(run(options, brick.motors, brick.battery, brick.clock, seed, panels))


def _scene(options: Any) -> Scene | None:
    """What the robot has around it. Raises ValueError."""
    given = {name: getattr(options, name) for name in ("walls", "grip", "bumper", "axle")}
    if options.walls is None:
        if any(value is not None for value in given.values()):
            raise ValueError("--grip, --bumper and --axle need --walls")
        return None
    return Scene(**given)


if __name__ == "__main__":
    sys.exit(main())
