"""A process of its own that stops the motors when the loop dies or hangs: a motor under run-direct turns on without its program.

Loop and watchdog share a pair of sockets. After each tick a byte goes out, which the watchdog sends back. Silence, or the end of the
loop's process, makes the watchdog stop every motor of the file tree and end; its own end, or its silence, makes the loop stop.
"""

import glob
import os
import select
import signal
import socket
import sys

from robot.motors import MotorFault

# Longer than the longest tick and a late one's outlier, and short enough to keep 250 ms together with the stopping itself.
SILENCE_S = 0.2
# The loop does not wait for echoes; it gives the watchdog this many ticks before it takes it for dead.
MOST_UNANSWERED = 40


def stop_all(root):
    """Stop every tacho motor under `root` (/sys/class on a brick), whatever the others do. Returns what could not be stopped."""
    failed = []
    for motor in glob.glob(os.path.join(root, "tacho-motor", "motor*")):
        for name, text in (("duty_cycle_sp", b"0"), ("command", b"stop")):
            try:
                handle = os.open(os.path.join(motor, name), os.O_WRONLY)
                try:
                    os.write(handle, text)
                finally:
                    os.close(handle)
            except OSError as error:
                failed.append("{}/{}: {}".format(motor, name, error.strerror))
    return failed


def watch(link, stop, silence_s=SILENCE_S):
    """Echo what comes over `link` until it ends or falls silent for silence_s, then call stop(). Returns why it ended.

    Before the first byte it may be silent for as long as it likes: a program takes seconds to start on the brick.
    """
    reason = "the loop has ended"
    patience_s = None
    while True:
        if not select.select([link], (), (), patience_s)[0]:
            reason = "the loop hangs"
            break
        try:
            beat = link.recv(64)
            if not beat:
                break
            link.send(beat)
            patience_s = silence_s
        except OSError:
            break
    stop()
    link.close()
    return reason


class Watchdog(object):
    """The loop's end, a panel of the program. Make it before anything else is opened: the watchdog is a fork of this process."""

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
        """Tell, once a tick, that the loop lives; a robot whose watchdog does not live is in fault."""
        tick = loop.blackbox.next_tick
        if tick != self._fed_tick:
            self._fed_tick = tick
            try:
                self.feed()
            except MotorFault as fault:
                loop.fail(str(fault))

    def feed(self):
        """Tell that the loop lives. Raises MotorFault if the watchdog does not."""
        try:
            self._link.send(b".")
            self._unanswered += 1 - len(self._echoes())
        except OSError as error:
            raise MotorFault(
                "the watchdog has ended ({}): it was killed, or the loop was silent and it has stopped the motors; "
                "start the robot's program anew".format(error.strerror)
            ) from error
        if self._unanswered > MOST_UNANSWERED:
            raise MotorFault("the watchdog does not answer; start the robot's program anew")

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
        self._link.close()
        try:
            os.kill(self.pid, signal.SIGCONT)  # or one that is frozen would not end, and this neither
            os.waitpid(self.pid, 0)
        except OSError:
            pass


def _be_watchdog(link, root):
    """What the forked process does, until it ends."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)  # these are meant for the loop, whose end is what counts
    status = 0
    try:
        os.setsid()
        reason = watch(link, lambda: stop_all(root))
        if reason != "the loop has ended":
            sys.stderr.write("watchdog: {}; motors stopped\n".format(reason))
            sys.stderr.flush()
    except BaseException:  # noqa: BLE001 - whatever it is, the motors come first
        status = 1
        stop_all(root)
    finally:
        os._exit(status)
