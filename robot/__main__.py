"""The robot's program on the brick: python3 -m robot."""

import os
import sys

from robot.button import BackButton
from robot.lights import Lights
from robot.motors import MonotonicClock, MotorFault
from robot.notify import Notify
from robot.program import choose_seed, parser, run
from robot.watchdog import Watchdog

# The host is another machine; it must have the token.
EVERYWHERE = "0.0.0.0"  # noqa: S104


def main():
    """Run until interrupted. Returns the exit status."""
    arguments = parser("The robot's program on the brick.", host=EVERYWHERE)
    arguments.add_argument("--left", default="outB", metavar="PORT", help="port of the left motor (default %(default)s)")
    arguments.add_argument("--right", default="outC", metavar="PORT", help="port of the right motor (default %(default)s)")
    arguments.add_argument("--sysfs", default="/sys/class", metavar="FOLDER", help="where the kernel's devices are (default %(default)s)")
    options = arguments.parse_args()
    try:
        from robot.ev3 import Ev3Battery, Ev3Motor
    except ImportError as error:
        print("{}: the robot runs on ev3dev, which has python3-ev3dev2; elsewhere try python -m sim_motor".format(error), file=sys.stderr)
        return 2
    watchdog = Watchdog(options.sysfs)
    motors = (Ev3Motor("left", options.left, options.sysfs), Ev3Motor("right", options.right, options.sysfs))
    for motor in motors:
        try:
            motor.find()
        except MotorFault as fault:
            # The first tick makes a fault of it, which the host sees, and which can be cleared when the motor is there.
            print(fault, file=sys.stderr)
    try:
        battery = Ev3Battery(options.sysfs)
    except OSError as error:
        print("the battery cannot be watched: {}".format(error), file=sys.stderr)
        battery = None
    panels = (watchdog, Lights(options.sysfs), BackButton(), Notify(os.environ))
    return run(options, motors, battery, MonotonicClock(), choose_seed(options), panels)


if __name__ == "__main__":
    sys.exit(main())
