"""Whether the robot's program on this machine is well: python3 -m robot.health.

`kickctl deploy` has the brick ask this before it trusts a release.
"""

import binascii
import os
import socket
import sys
import time

from robot import __version__, sources, token, wire
from robot.arguments import Arguments
from robot.wire import PORT
from robot.words import say

# Where a program that listens on every address of its machine is asked.
LOOPBACK = {"": "127.0.0.1", "0.0.0.0": "127.0.0.1", "::": "::1"}  # noqa: S104
# Patience with a slow machine that has just started the program.
PATIENCE_S = 20.0
# A program that ticks does so within this time.
LONGEST_TICK_S = 2.0
# The exit statuses.
WELL, UNWELL, IN_FAULT = 0, 1, 3


class Unwell(Exception):
    """The program does not work as it should; the message says why."""


# What no answer, or the answer of something that is no robot, may raise.
_TROUBLE = (
    OSError,
    ArithmeticError,
    AttributeError,
    LookupError,
    TypeError,
    ValueError,
    wire.BadMessage,
    Unwell,
)


class Questioner(object):
    """A conversation with the robot that listens at an address of this machine.

    Raises OSError, BadMessage and Unwell.
    """

    def __init__(self, host, port):
        self._link = socket.create_connection((LOOPBACK.get(host, host), port), timeout=PATIENCE_S)
        self._decoder = wire.Decoder()

    def ask(self, kind, **message):
        """Send a frame. Returns the message that answers it."""
        self._link.sendall(wire.encode_json(kind, message))
        while True:
            frame = self._decoder.next()
            if frame is not None:
                answer = wire.load(frame[1])
                if "error" in answer:
                    raise Unwell("it refuses: {}".format(answer["error"].get("message")))
                return answer
            try:
                data = self._link.recv(wire.MAX_PAYLOAD)
            except socket.timeout:
                raise Unwell(
                    "it hangs: it has not answered for {:g} s; the watchdog stops the motors of a"
                    " program that hangs".format(PATIENCE_S)
                ) from None
            if not data:
                raise Unwell("it hangs up")
            self._decoder.feed(data)

    def status(self):
        """The robot's status."""
        return self.ask(wire.ASK, id=1, do="status")["result"]

    def close(self):
        """Hang up."""
        self._link.close()


def _compare(what, its, ours):
    """Raise Unwell if the program that answers is not the one in this folder."""
    if its != ours:
        raise Unwell("it runs {} {}, not {}: another program answers".format(what, its, ours))


def examine(host, port, secret):
    """The status of the robot that listens on a host and port, as its arguments name them.

    It has shown that it runs the release and the sources of this folder, has the token, and ticks.
    Raises OSError, BadMessage and Unwell.
    """
    robot = Questioner(host, port)
    try:
        nonce = os.urandom(wire.NONCE_BYTES)
        text = binascii.hexlify(nonce).decode("ascii")
        names = {"name": "health", "client": "health"}
        hello = robot.ask(wire.HELLO, protocol=wire.PROTOCOL, nonce=text, token=True, **names)
        _compare("release", hello["software"], __version__)
        _compare("sources", hello.get("sources"), sources.of_robot())
        shake = wire.Handshake(secret, nonce, binascii.unhexlify(hello["nonce"]))
        answer = robot.ask(wire.AUTH, proof=binascii.hexlify(shake.host_proof).decode("ascii"))
        if not wire.same(binascii.unhexlify(answer["proof"]), shake.robot_proof):
            raise Unwell("it does not have the token")
        first = status = robot.status()
        until = time.monotonic() + LONGEST_TICK_S
        while status["tick"] == first["tick"]:
            if time.monotonic() > until:
                raise Unwell("it does not tick")
            time.sleep(status["params"]["tick_s"])
            status = robot.status()
        return status
    finally:
        robot.close()


def main():
    """Print one line about the robot.

    Returns WELL, UNWELL, or IN_FAULT if the program is well but the robot is in fault.
    """
    arguments = Arguments("Asks the robot's program on this machine whether it is well.")
    arguments.add("host", "127.0.0.1", "address on which it listens", "ADDRESS")
    arguments.add("port", PORT, "its TCP port", "PORT", int)
    arguments.add("token", token.default_path(), "its token file", "FILE")
    options = arguments.parse(sys.argv[1:])
    try:
        secret = token.load(options.token, token.DELETE)
        words, fault = _describe(examine(options.host, options.port, secret))
    except token.TokenError as error:
        return _report("the robot's program cannot be asked: {}".format(error), UNWELL)
    except _TROUBLE as error:
        what = "the robot's program at port {} is not well: {}".format(options.port, error)
        return _report(what, UNWELL)
    return _report(words, IN_FAULT if fault else WELL)


def _describe(status):
    """(a robot's status in words, whether it is in fault)."""
    volts = status["battery_v"]
    battery = "" if volts is None else ", battery {:.1f} V".format(volts)
    fault = status["state"] == "fault"
    remedy = "; mend that, then `kickctl clear` and `kickctl start`" if fault else ""
    return "{} ({}){}{}".format(status["state"], status["reason"], battery, remedy), fault


def _report(text, status):
    say(text, sys.stdout)
    return status


if __name__ == "__main__":
    sys.exit(main())
