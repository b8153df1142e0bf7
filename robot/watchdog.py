"""A process of its own that stops the motors when the loop dies or hangs: a motor under run-direct turns on without its program.

Loop and watchdog share a pair of sockets. After each tick a byte goes out, which the watchdog sends back. Silence makes the watchdog
stop every motor of the file tree, and tell the loop so, should it wake; the end of the loop's process makes it do so and end. Its own
end, or its silence, makes the loop stop.
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

# What goes over the link: that the loop lives, and back; from the watchdog, that it has stopped the motors; from the loop, that it ends.
_ALIVE, _STOPPED, _FAREWELL = b".", b"!", b"q"


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
    """Echo what comes over `link` until it ends, and call stop(reason) then and whenever it falls silent for silence_s.

    The reason is in words, empty if the loop has said that it ends. Before the first byte, and after a silence until the next, it may be
    silent for as long as it likes: a program takes seconds to start on the brick.
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
                stop("the loop was silent for {:g} s".format(silence_s))
                link.send(_STOPPED)
                patience_s = None
    except OSError:
        beat = b""
    stop("" if beat else "the loop's process has died")
    link.close()


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
        """Tell that the loop lives. Raises MotorFault if the watchdog does not, or has stopped the motors meanwhile."""
        try:
            echoes = self._echoes()
            self._link.send(_ALIVE)
        except OSError as error:
            raise MotorFault("the watchdog has ended ({}); start the robot's program anew".format(error.strerror)) from error
        self._unanswered += 1 - echoes.count(_ALIVE)
        if _STOPPED in echoes:
            raise MotorFault(
                "the loop was silent for {:g} s or longer, so the watchdog has stopped the motors: "
                "was the machine busy with something else? Clear the fault to go on".format(SILENCE_S)
            )
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
        try:
            self._link.send(_FAREWELL)
        except OSError:
            pass  # it has ended already
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

    def stop(reason):
        failed = stop_all(root)
        if reason:
            sys.stderr.write("watchdog: {}; {}\n".format(reason, "not stopped: " + ", ".join(failed) if failed else "motors stopped"))
            sys.stderr.flush()

    status = 0
    try:
        os.setsid()
        watch(link, stop)
    except BaseException:  # noqa: BLE001 - whatever it is, the motors come first
        status = 1
        stop_all(root)
    finally:
        os._exit(status)
