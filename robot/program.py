"""The robot's program: from its arguments to the server and the loop.

The brick and the simulated brick differ only in the motors, battery, clock and panels they hand in.
"""

import os
import sys

from robot import schedule, token
from robot.arguments import WRONG_USE, Arguments
from robot.bare import signal, socket
from robot.errors import Refused
from robot.loop import Loop
from robot.server import Server
from robot.wire import BAUD, PORT
from robot.words import say

# On the brick, sending a record takes as long as a tick, and sending four hardly longer.
RECORDS_S = 0.1


def _warn(text):
    say(text, sys.stderr)


def arguments(description, host):
    """The arguments that every robot program has.

    Args:
        description: What the program is, for its help text.
        host: The address on which it listens by default.

    Returns:
        A robot.arguments.Arguments, to which a program may add its own.
    """
    known = Arguments(description)
    known.add("host", host, "address to listen on", "ADDRESS")
    known.add("port", PORT, "TCP port to listen on, 0 for any that is free", "PORT", int)
    known.add(
        "serial",
        None,
        "serve this serial line as well (default baud rate {})".format(BAUD),
        "DEVICE[@BAUD]",
    )
    known.add(
        "token",
        token.default_path(),
        "token file; the program writes one if there is none",
        "FILE",
    )
    known.add("seed", None, "random seed of the neurons' start values", "NUMBER", int)
    known.add("idle", False, "leave the motors off until a host starts the robot")
    known.add(
        "set",
        [],
        "start with this value of a parameter; may be repeated",
        "NAME=VALUE",
        many=True,
    )
    known.add("tick", None, "control period in s", "S", float)
    return known


def choose_seed(options):
    """The random seed that the arguments give, or a random one.

    Args:
        options: The parsed `arguments`.

    Returns:
        A whole number, 0 or more.
    """
    return int.from_bytes(os.urandom(4), "big") if options.seed is None else options.seed


def run(options, motors, battery, clock, seed, panels=(), brick=False):
    """Serve hosts and run the loop until SIGINT or SIGTERM. Prints READY when it listens.

    Args:
        options: The parsed `arguments`.
        motors: The left and the right robot.motors.Motor.
        battery: A robot.motors.Battery, or None.
        clock: A robot.motors.Clock.
        seed: Random seed of the neurons' start values.
        panels: What people see and touch on the robot, and what watches the loop. Between two ticks
            their serve(loop) is called once, and must return at once; close() ends them. Those
            that show which robot this is name their `ways`, see robot.beacon.
        brick: Whether this machine is as slow and small as the brick: then hosts get records ten
            times a second, and the program is kept from being swapped out, if the kernel allows it.

    Returns:
        The exit status: 0 when it was ended, 1 if a motor did not obey then, 2 if it could not
        start.
    """
    try:
        secret, new = token.load_or_make(options.token)
        loop = Loop(motors, battery, clock, seed)
        loop.beacon.ways = [way for panel in panels for way in getattr(panel, "ways", ())]
        settings = _settings(options)
        if settings:
            loop.set_params(settings)
        server = Server(loop, secret, RECORDS_S if brick else 0.0)
        port = _listen(server, options)
        if options.serial is not None:
            _attach(server, options.serial)
        if new:
            _warn("wrote a new token: {}".format(options.token))
        loop.memory_locked = brick and schedule.lock_memory()
        loop.real_time = schedule.take_priority(schedule.LOOP_PRIORITY)
        panels = (*panels, schedule.Collector())
        try:
            _serve(options, loop, server, port, panels)
        finally:
            server.close()
    except token.TokenError as error:
        return _give_up(str(error))
    except Refused as refusal:
        return _give_up("{}; {}".format(refusal.message, refusal.hint))
    finally:
        for panel in panels:
            panel.close()
    if loop.unstopped:
        _warn(
            "the {} motor did not obey when the program ended, and may run on ({}): look, and cut"
            " its power if it does".format(" and the ".join(loop.unstopped), loop.safety.reason)
        )
        return 1
    return 0


def _settings(options):
    """The parameters to start with, by name. Raises Refused."""
    settings = {}
    for text in options.set:
        name, equals, value = text.partition("=")
        if not equals:
            raise Refused(
                "usage",
                "--set {} sets nothing".format(text),
                "write --set NAME=VALUE, for example --set polarity_left=-1",
            )
        try:
            settings[name] = float(value)
        except ValueError:
            settings[name] = value
    if options.tick is not None:
        settings["tick_s"] = options.tick
    return settings


def _listen(server, options):
    """The port on which the server listens now. Raises Refused."""
    if not options.host.strip():
        # The system would take it for every address of this machine.
        raise Refused(
            "usage",
            "--host cannot be empty",
            "give an address of this machine: 127.0.0.1 lets in this machine only, 0.0.0.0 all"
            " others too",
        )
    try:
        return server.listen(options.host, options.port)
    # Of what is no machine's name, Python says UnicodeError, which is a ValueError, or TypeError.
    except (OSError, OverflowError, TypeError, ValueError) as error:
        raise Refused(
            "usage",
            "cannot listen on {}:{}: {}".format(options.host, options.port, error),
            "is another robot running there? The host is an address of this machine, and ports"
            " are 0 (any that is free) to 65535",
        ) from None


def own_address():
    """The address of this machine in its network, or 127.0.0.1 if it is in none."""
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        # An address for documentation. Nothing is sent: the system only chooses the interface.
        probe.connect(("192.0.2.1", PORT))
        return probe.getsockname()[0]
    except OSError:
        return "127.0.0.1"
    finally:
        probe.close()


def _attach(server, argument):
    """Have the server serve a serial line as well. Raises Refused."""
    from robot.serial_line import SerialLine  # with `termios`, which few robots need

    server.attach(SerialLine(argument, _warn).open)


def _serve(options, loop, server, port, panels):
    """Run the loop and serve hosts until a signal ends it."""
    ends = [signal.SIGINT, signal.SIGTERM]
    # Who wants the program to outlive its terminal has made it deaf to this one.
    if signal.getsignal(signal.SIGHUP) != signal.SIG_IGN:
        ends.append(signal.SIGHUP)
    for number in ends:
        signal.signal(number, lambda number, frame: setattr(loop, "done", True))
    if not options.idle:
        try:
            loop.start()
        except Refused as refusal:
            loop.stop(refusal.message)
            _warn("not started: {}".format(refusal.message))
    host = options.host
    if server.everywhere:
        host = own_address()
        _warn(
            "listening on every address of this machine ({}); READY names one of them".format(
                options.host
            )
        )
    host = "[{}]".format(host) if ":" in host else host
    say("READY tcp://{}:{}".format(host, port), sys.stdout)

    box, seen = loop.blackbox, None

    def serve(timeout_s):
        nonlocal seen
        if seen != box.next_tick:
            seen = box.next_tick
            for panel in panels:
                panel.serve(loop)
        server.serve(timeout_s)

    try:
        _run(loop, server, serve)
    except SystemExit as error:  # of a motor's own code, and perhaps with status 0
        raise RuntimeError("a part of the robot's program has ended it") from error


def _run(loop, server, serve):
    """Run the loop. If it fails, say why to the hosts before they hear no more."""
    try:
        loop.run(serve)
    except (Exception, SystemExit) as error:
        try:
            loop.fail("the robot's program failed ({!r}); start it again".format(error))
        finally:
            server.serve(0.0)
        raise


def _give_up(message):
    _warn(message)
    return WRONG_USE
