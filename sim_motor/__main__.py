"""A brick on the desk: the robot's own program in real time, with simulated motors.

python -m sim_motor --port 5425, and in another terminal: kickctl --brick tcp://127.0.0.1:5425 kick --mode phase
"""

import sys

from robot.motors import MonotonicClock
from robot.program import choose_seed, parser, run
from sim_motor.brick import SimBrick


def main() -> int:
    """Run until interrupted. Returns the exit status."""
    arguments = parser("A brick on the desk: the robot's program in real time, with simulated motors.", host="127.0.0.1")
    arguments.add_argument("--motor", default="pybricks", help="which set of constants of motors.toml (default %(default)s)")
    arguments.add_argument("--battery", type=float, metavar="V", help="open-circuit voltage of the battery")
    options = arguments.parse_args()
    seed = choose_seed(options)
    try:
        brick = SimBrick(seed, clock=MonotonicClock(), motor=options.motor, battery_v=options.battery)
    except ValueError as error:
        arguments.error(str(error))
    return int(run(options, brick.motors, brick.battery, brick.clock, seed))


if __name__ == "__main__":
    sys.exit(main())
