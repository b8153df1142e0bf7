"""A process of its own that stops the motors when the loop dies or hangs.

A motor under run-direct turns on without its program.

Loop and watchdog share a pair of sockets. After each tick a byte goes out, which the watchdog sends
back. Silence makes the watchdog stop every motor of the file tree, and tell the loop so, should it
wake; the end of the loop's process makes it do so and end. Its own end, or its silence, makes the
loop stop.
"""

import errno
import glob
import os
import select
import signal
import socket
import time

from robot.lights import Lights
from robot.motors import MotorFault
from robot.safety import RUNNING

# Longer than the longest tick and a late one's outlier, and short enough to keep 250 ms together
# with the stopping itself.
SILENCE_S = 0.2
# The loop does not wait for echoes; it gives the watchdog this many ticks before it takes it for
# dead.
MOST_UNANSWERED = 40
# A motor that does not obey is told again: at once, for an error that passes, and then so often,
# for so long once the loop is dead.
TRIES = 3
AGAIN_S = 0.05
LONGEST_S = 10.0
FAREWELL_S = 1.0

# What goes over the link: that the loop lives, and back; from the watchdog, that it has stopped the
# motors; from the loop, that it ends.
_ALIVE, _STOPPED, _FAREWELL = b".", b"!", b"q"
_GONE = (errno.ENOENT, errno.ENODEV)


def stop_all(root):
    """Stop every tacho motor under `root` (/sys/class on a brick), whatever the others do.

    Returns what could not be stopped, in words.
    """
    failed = []
    for motor in glob.glob(os.path.join(root, "tacho-motor", "motor*")):
        for left in reversed(range(TRIES)):
            try:
                _write(motor, "duty_cycle_sp", b"0")
                _write(motor, "command", b"stop")
                if int(_read(motor, "duty_cycle")) == 0:
                    break
                why = "it runs on"
            except OSError as error:
                if error.errno in _GONE:
                    break
                why = str(error.strerror)
            except ValueError:
                why = "it does not tell its duty cycle"
            if not left:
                failed.append("{}: {}".format(os.path.basename(motor), why))
    return failed


def _write(motor, name, text):
    handle = os.open(os.path.join(motor, name), os.O_WRONLY)
    try:
        os.write(handle, text)
    finally:
        os.close(handle)


def _read(motor, name):
    with open(os.path.join(motor, name)) as file:
        return file.read()


def watch(link, stop, silence_s=SILENCE_S):
    """Echo what comes over `link` until it ends.

    Whenever it falls silent for silence_s, and in the end, stop(reason).

    stop returns whether the motors obeyed; if not, it is called again, until they do, the loop
    lives again, or LONGEST_S after its end. The reason is in words, empty if the loop has said that
    it ends. Before the first byte, and after a silence until the next, it may be silent for as long
    as it likes: a program takes seconds to start on the brick.
    """
    patience_s = None
    try:
        while True:
            if select.select([link], (), (), patience_s)[0]:
                beat = link.recv(64)
                if not beat or _FAREWELL in beat:
                    break
                link.send(beat)
                patience_s = silence_s
            else:
                fresh = patience_s == silence_s
                patience_s = (
                    None if stop("the loop was silent for {:g} s".format(silence_s)) else AGAIN_S
                )
                if fresh:
                    link.send(_STOPPED)
    except OSError:
        beat = b""
    link.close()
    for _ in range(int(LONGEST_S / AGAIN_S)):
        if stop("" if beat else "the loop's process has died"):
            break
        select.select((), (), (), AGAIN_S)


class Watchdog(object):
    """The loop's end, a panel of the program. Make it before anything else is opened.

    The watchdog is a fork of this process.
    """

    def __init__(self, root):
        self._link, other = socket.socketpair()
        self._fed_tick = None
        self._unanswered = 0
        self.pid = os.fork()
        if self.pid == 0:
            self._link.close()
            _be_watchdog(other, root)
        other.close()
        self._link.setblocking(False)

    def serve(self, loop):
        """Tell, once a tick, that the loop lives.

        A robot whose watchdog does not live is in fault, and so is one that it had to stop.
        """
        tick = loop.blackbox.next_tick
        if tick == self._fed_tick:
            return
        self._fed_tick = tick
        try:
            silent = self.feed()
        except MotorFault as fault:
            loop.incurable = str(fault)
            loop.fail(loop.incurable)
        else:
            loop.incurable = ""
            if silent and loop.safety.state == RUNNING:
                loop.fail(
                    "the loop was silent for {:g} s or longer, and the watchdog stepped in and"
                    " stopped the motors: was the machine busy with something else? Clear the fault"
                    " to go on".format(SILENCE_S)
                )

    def feed(self):
        """Tell that the loop lives. Returns whether the watchdog has stopped the motors meanwhile.

        Raises MotorFault if it is dead.
        """
        try:
            echoes = self._echoes()
            self._send(_ALIVE)
        except OSError as error:
            raise MotorFault(
                "the watchdog has ended ({}); start the robot's program anew".format(error.strerror)
            ) from error
        self._unanswered += 1 - echoes.count(_ALIVE)
        if self._unanswered > MOST_UNANSWERED:
            raise MotorFault("the watchdog does not answer; start the robot's program anew")
        return _STOPPED in echoes

    def _send(self, what):
        try:
            self._link.send(what)
        except BlockingIOError:
            pass  # the link is full of what a frozen watchdog has not read

    def _echoes(self):
        try:
            echoes = self._link.recv(4096)
        except BlockingIOError:
            return b""
        if not echoes:
            raise OSError(0, "it closed its link")
        return echoes

    def close(self):
        """End the watchdog, after the motors were stopped."""
        try:
            self._send(_FAREWELL)
        except OSError:
            pass  # it has ended already
        self._link.close()
        try:
            os.kill(
                self.pid, signal.SIGCONT
            )  # or one that is frozen would not end, and this neither
            until = time.monotonic() + FAREWELL_S
            while os.waitpid(self.pid, os.WNOHANG)[0] == 0:
                if time.monotonic() > until:
                    os.kill(self.pid, signal.SIGKILL)
                time.sleep(0.01)
        except OSError:
            pass


def _say(text):
    """Onto standard error, unless that would take time, as a terminal that is stopped does, or fails."""
    try:
        if select.select((), [2], (), 0)[1]:
            os.write(2, text.encode())
    except OSError:
        pass


def _be_watchdog(link, root):
    """What the forked process does, until it ends."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(
            number, signal.SIG_IGN
        )  # these are meant for the loop, whose end is what counts
    said = []

    def stop(reason):
        failed = stop_all(root)
        words = "watchdog: {}; {}\n".format(
            reason, "not stopped: " + ", ".join(failed) if failed else "motors stopped"
        )
        if reason and said[-1:] != [words]:
            said[:] = [words]
            Lights(root).alarm()
            _say(words)
        return not failed

    status = 0
    try:
        os.setsid()
        watch(link, stop)
    except BaseException:  # noqa: BLE001 - whatever it is, the motors come first
        status = 1
        stop_all(root)
    finally:
        os._exit(status)
