"""A brick on the desk: the robot's own program in real time, with simulated motors.

python -m sim_motor --port 5425, and in another terminal: kickctl --brick tcp://127.0.0.1:5425 kick
--mode phase

With --sysfs it is only the brick's hardware, as files that the robot's program for the real brick
can run on: python -m sim_motor --sysfs FOLDER, and in another terminal: python -m robot --sysfs
FOLDER
"""

import sys

from robot.beacon import Announcer
from robot.motors import MonotonicClock
from robot.program import choose_seed, parser, run, say
from sim_motor.brick import SimBrick
from sim_motor.clock import VirtualClock
from sim_motor.mount import serve


def main() -> int:
    """Run until interrupted. Returns the exit status."""
    arguments = parser(
        "A brick on the desk: the robot's program in real time, with simulated motors.",
        host="127.0.0.1",
    )
    arguments.add_argument(
        "--motor",
        default="pybricks",
        help="which set of constants of motors.toml (default %(default)s)",
    )
    arguments.add_argument(
        "--battery", type=float, metavar="V", help="open-circuit voltage of the battery"
    )
    arguments.add_argument(
        "--sysfs",
        metavar="MOUNTPOINT",
        help="mount the motors' files there instead, without the robot's program",
    )
    options = arguments.parse_args()
    seed = choose_seed(options)
    clock = VirtualClock(seed, jitter=False) if options.sysfs else MonotonicClock()
    try:
        brick = SimBrick(seed, clock=clock, motor=options.motor, battery_v=options.battery)
    except ValueError as error:
        arguments.error(str(error))
    if options.sysfs:
        return serve(options.sysfs, brick)
    announcer = Announcer(lambda text: say(text, sys.stderr))
    return int(run(options, brick.motors, brick.battery, brick.clock, seed, (announcer,)))


if __name__ == "__main__":
    sys.exit(main())
