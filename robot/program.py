"""The robot's program: from arguments to parts to the loop.

The brick and the simulated brick differ only in the parts they hand in.
"""

import argparse
import os
import signal
import sys

from robot import token
from robot.errors import Refused
from robot.loop import Loop
from robot.server import Server

PORT = 5425  # KICK on a telephone's keys
BAUD = 115200


def parser(description, host):
    """The arguments of every robot program; `host` is the address it listens on by default."""
    made = argparse.ArgumentParser(description=description)
    made.add_argument("--host", default=host, help="address to listen on (default %(default)s)")
    made.add_argument(
        "--port",
        type=int,
        default=PORT,
        help="TCP port to listen on, 0 for any that is free (default %(default)s)",
    )
    made.add_argument(
        "--serial",
        metavar="DEVICE[@BAUD]",
        help="serve this serial line as well (default baud rate {})".format(BAUD),
    )
    made.add_argument(
        "--token",
        default=token.default_path(),
        help="token file, made if there is none (default %(default)s)",
    )
    made.add_argument("--seed", type=int, help="fixes the neurons' start values; random by default")
    made.add_argument(
        "--idle", action="store_true", help="leave the motors off until told to start"
    )
    made.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="a parameter to begin with; may be repeated",
    )
    made.add_argument("--tick", type=float, metavar="S", help="control period in s")
    return made


def choose_seed(options):
    """The seed asked for, or a random one."""
    return int.from_bytes(os.urandom(4), "big") if options.seed is None else options.seed


def run(options, motors, battery, clock, seed, panels=()):
    """Serve and tick until SIGINT or SIGTERM. Prints READY when it listens.

    Returns the exit status.

    panels: what people see and touch on the robot; their serve(loop) is called in the time that
    ticks leave, and must return at once.
    """
    try:
        secret, new = token.load_or_make(options.token)
        loop = Loop(motors, battery, clock, seed)
        settings = _settings(options)
        if settings:
            loop.set_params(settings)
        server = Server(loop, secret)
        port = _listen(server, options)
        if new:
            print("made a new token: {}".format(options.token), file=sys.stderr)
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
    return 0


def _settings(options):
    """The parameters to begin with, by name. Raises Refused."""
    settings = {}
    for text in options.set:
        name, equals, value = text.partition("=")
        if not equals:
            raise Refused(
                "usage",
                "--set {} sets nothing".format(text),
                "it is --set NAME=VALUE, as --set polarity_left=-1",
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
    try:
        return server.listen(options.host, options.port)
    except (OSError, OverflowError) as error:
        raise Refused(
            "usage",
            "cannot listen on {}:{}: {}".format(options.host, options.port, error),
            "is another robot running there? Ports are 0 (any that is free) to 65535",
        ) from None


def _serve(options, loop, server, port, panels):
    """Tick and serve until told to end."""
    if options.serial:
        server.attach(_line_opener(options.serial))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: setattr(loop, "done", True))
    if not options.idle:
        try:
            loop.start()
        except Refused as refusal:
            loop.stop(refusal.message)
            print("not started: {}".format(refusal.message), file=sys.stderr)
    print("READY tcp://{}:{}".format(options.host, port), flush=True)

    def serve(timeout_s):
        for panel in panels:
            panel.serve(loop)
        server.serve(timeout_s)

    _run(loop, server, serve)


def _run(loop, server, serve):
    """Run the loop. If it fails, hosts are told why they will hear no more."""
    try:
        loop.run(serve)
    except Exception as error:
        loop.fail("the robot's program failed ({!r}); start it anew".format(error))
        server.serve(0.0)
        raise


def _give_up(message):
    print(message, file=sys.stderr)
    return 2


def _line_opener(argument):
    """A function that opens the serial line 'DEVICE' or 'DEVICE@BAUD' without blocking.

    It raises OSError.
    """
    device, _, baud = argument.partition("@")

    def open_line():
        import serial

        return serial.Serial(device, int(baud or BAUD), timeout=0, write_timeout=0)

    return open_line
