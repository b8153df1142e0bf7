"""The robot's program on the brick: python3 -m robot."""

import os
import sys

from robot.bare import socket
from robot.beacon import Announcer
from robot.button import BackButton
from robot.lights import Lights
from robot.motors import MonotonicClock, MotorFault
from robot.notify import Notify
from robot.program import arguments, choose_seed, run
from robot.speaker import Speaker
from robot.watchdog import Watchdog, stop_all
from robot.words import say

PORTS = ("outA", "outB", "outC", "outD")
_LEFT, _RIGHT, _SYSFS = "outB", "outC", "/sys/class"
_NO_WATCHDOG = (
    "the process that would watch the program cannot start ({}): end other programs, or restart the"
    " machine"
)
_UNWATCHED = (
    "the watchdog cannot stop the {} motor, which has no method emergency_stop: if this program"
    " hangs or is killed, only its power switch stops it. While the program works, `kickctl stop`,"
    " a lost link and ^C stop it"
)


def _claim(root):
    """Claim the motors below a folder for this process.

    Args:
        root: Where the kernel's classes of devices are.

    Returns:
        A socket, whose name only one process at a time can have; None if another process has it.
    """
    claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    try:
        claim.bind(b"\0kickctl " + os.fsencode(os.path.realpath(root))[-90:])
    except OSError:
        claim.close()
        return None
    return claim


def _everywhere():
    """The address that stands for all of this machine: IPv6 and IPv4, or IPv4 alone.

    The host is another machine, and needs the token to command the robot.
    """
    try:
        socket.socket(socket.AF_INET6).close()
    except OSError:  # this kernel has no IPv6
        return "0.0.0.0"  # noqa: S104
    return "::"


def _give_up(message):
    say(message, sys.stderr)
    return 2


def main():
    """Run the robot's program until it is interrupted.

    Returns:
        The exit status: 0 when it was ended, 1 if a motor did not obey then, 2 if it could not
        start.
    """
    known = arguments("The robot's program on the brick.", _everywhere())
    known.add("left", _LEFT, "port of the left motor", "PORT", choices=PORTS)
    known.add("right", _RIGHT, "port of the right motor", "PORT", choices=PORTS)
    known.add("sysfs", _SYSFS, "where the kernel's devices are", "FOLDER")
    known.add(
        "motors",
        None,
        "drive your own motors, which this function returns, instead of the brick's; see"
        " docs/own-motors.md",
        "MODULE:FACTORY",
    )
    options = known.parse(sys.argv[1:])
    if options.motors is not None:
        for name, default in (("left", _LEFT), ("right", _RIGHT), ("sysfs", _SYSFS)):
            if getattr(options, name) != default:
                known.error(
                    "--{} is about the brick's motors, and --motors replaces them: leave one of"
                    " them out".format(name)
                )
        return _drive_own(options)
    if options.left == options.right:
        known.error("both motors cannot be at {}".format(options.left))
    return _drive_brick(options)


def _drive_brick(options):
    """Run with the brick's motors. Returns the exit status."""
    try:
        from robot.ev3 import Ev3Battery, Ev3Motor
    except ImportError as error:
        return _give_up(
            "{}: this program needs ev3dev's python3-ev3dev2; on another machine start a simulated"
            " robot: python3 -m sim_motor; or name your own motors with --motors".format(error)
        )
    # Before anything touches the motors. The watchdog, a fork of this process, keeps the claim for
    # as long as it may have to stop them.
    alone = _claim(options.sysfs)
    if alone is None:
        return _give_up(
            "another robot's program drives the motors under {}: end that one first".format(
                options.sysfs
            )
        )
    lights, speaker = Lights(options.sysfs), Speaker()

    def alarm():
        lights.alarm()
        speaker.silence()

    try:
        watchdog = Watchdog(lambda: stop_all(options.sysfs), alarm, lights.forget)
    except OSError as error:
        return _give_up(_NO_WATCHDOG.format(error.strerror))
    motors = (
        Ev3Motor("left", options.left, options.sysfs),
        Ev3Motor("right", options.right, options.sysfs),
    )
    for motor in motors:
        try:
            motor.find()
        except MotorFault as fault:
            # The first tick turns this into a fault. The host sees it, and can clear it when the
            # motor is there.
            say(str(fault), sys.stderr)
    try:
        battery = Ev3Battery(options.sysfs)
    except OSError as error:
        say("the battery cannot be watched: {}".format(error), sys.stderr)
        battery = None
    button = BackButton(lambda text: say(text, sys.stderr))
    panels = (watchdog, lights, speaker, button, Notify(os.environ))
    try:
        return run(
            options, motors, battery, MonotonicClock(), choose_seed(options), panels, brick=True
        )
    finally:
        alone.close()


def _drive_own(options):
    """Run with an engineer's own motors. Returns the exit status."""
    from robot import own_motors  # with `traceback`, whose import takes a brick 0.8 s

    try:
        motors, battery, faults = own_motors.load(options.motors)
    except own_motors.NoMotors as error:
        return _give_up(str(error))
    for fault in faults:
        say(fault, sys.stderr)  # the first tick turns this into a fault, as with the brick's motors
    watchdogs = []
    unwatched = own_motors.unwatched(motors)
    if unwatched:
        say(_UNWATCHED.format(" and the ".join(unwatched)), sys.stderr)
    if len(unwatched) < len(motors):
        try:
            watchdogs.append(Watchdog(lambda: own_motors.stop_all(motors), lambda: None))
        except OSError as error:
            return _give_up(_NO_WATCHDOG.format(error.strerror))
    announcer = Announcer(lambda text: say(text, sys.stderr))
    panels = (*watchdogs, announcer, Notify(os.environ))
    return run(options, motors, battery, MonotonicClock(), choose_seed(options), panels)


if __name__ == "__main__":
    sys.exit(main())
