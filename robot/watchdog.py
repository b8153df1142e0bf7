"""A separate process that stops the motors when the loop dies or hangs.

A motor under run-direct keeps turning without its program.

Loop and watchdog share a pair of sockets. After each tick the loop sends a byte, and the watchdog
sends it back. If the loop is silent, the watchdog stops every motor, and says so to the loop, which
may wake up again. If the loop's process ends, the watchdog stops every motor and ends too. If the
watchdog ends or does not answer, the loop stops the motors itself.
"""

import errno
import os
import select
import time

from robot import schedule
from robot.bare import signal, socket
from robot.motors import MotorFault
from robot.safety import RUNNING

# Longer than the longest tick, late ticks included, and short enough that the motors stand still
# within 250 ms.
SILENCE_S = 0.2
# The loop does not wait for the bytes to come back. After this many ticks without one it takes the
# watchdog for dead.
MOST_UNANSWERED = 40
# How long a loop that wakes waits for the watchdog to finish a stop: less than SILENCE_S, or this
# would be the next silence.
LAST_STOP_S = 0.1
# A motor that does not obey gets the command again: TRIES times at once, as some errors pass; then
# every AGAIN_S; and for at most LONGEST_S once the loop is dead.
TRIES = 3
AGAIN_S = 0.05
LONGEST_S = 10.0
FAREWELL_S = 1.0

# Bytes on the link: the loop lives (sent and sent back); the watchdog has stopped the motors; the
# loop ends on purpose.
_ALIVE, _STOPPED, _FAREWELL = b".", b"!", b"q"
_GONE = (errno.ENOENT, errno.ENODEV)


def stop_all(root):
    """Stop every motor, even if some of them do not obey.

    Args:
        root: Where the kernel's classes of devices are: /sys/class on a brick.

    Returns:
        A list with a line for each motor that could not be stopped: its name and why.
    """
    failed = []
    folder = os.path.join(root, "tacho-motor")
    try:
        motors = os.listdir(folder)
    except OSError:  # this kernel has never seen a motor
        motors = []
    for name in motors:
        motor = os.path.join(folder, name)
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
                why = "its duty cycle cannot be read"
            if not left:
                failed.append("{}: {}".format(name, why))
    return failed


def _write(motor, name, text):
    handle = os.open(os.path.join(motor, name), os.O_WRONLY)
    try:
        os.write(handle, text)
    finally:
        os.close(handle)


def _read(motor, name):
    with open(os.path.join(motor, name), encoding="ascii") as file:
        return file.read()


def watch(link, stop, silence_s=SILENCE_S):
    """Send back what comes over a link until it ends, and stop the motors when it is silent.

    Silence counts from the first byte on, as a program takes seconds to start on the brick. While
    it lasts, the motors are stopped again and again: a loop that wakes may drive them, and hang.

    Args:
        link: A socket to the loop.
        stop: stop(reason) stops the motors and returns whether they obeyed. If they did not, it is
            called again until they do, until the loop lives again, or until LONGEST_S after the
            loop's end. The reason is in words; it is empty if the loop ended on purpose, and for
            another stop of motors that have obeyed.
        silence_s: How long the loop may be silent, in s.
    """
    silent = "the loop was silent for {:g} s".format(silence_s)
    patience_s, obeyed = None, False
    try:
        while True:
            if select.select([link], (), (), patience_s)[0]:
                beat = link.recv(64)
                if not beat or _FAREWELL in beat:
                    break
                link.send(beat)
                patience_s, obeyed = silence_s, False
            else:
                obeyed = stop("" if obeyed else silent)
                patience_s = silence_s if obeyed else AGAIN_S
                # After every stop: the loop may have woken and driven the motors meanwhile.
                _tell_stopped(link)
    except OSError:
        beat = b""
    link.close()
    for _ in range(int(LONGEST_S / AGAIN_S)):
        if stop("" if beat else "the loop's process has died"):
            break
        select.select((), (), (), AGAIN_S)


def _tell_stopped(link):
    """Tell the loop that the motors were stopped, unless the link is full of that already."""
    try:
        link.send(_STOPPED, socket.MSG_DONTWAIT)
    except BlockingIOError:
        pass


class Watchdog(object):
    """The loop's end of the link to its watchdog; a panel of the program.

    The watchdog is a fork of this process: create it before the process opens anything else but
    what stops the motors.

    Args:
        stop: Stops every motor, in the watchdog's process. It returns a list with a line for each
            motor that could not be stopped.
        alarm: Called in the watchdog's process when it has stopped the motors on its own account.
        woken: Called in this process when it learns of that, as it runs again.

    Attributes:
        pid: The watchdog's process id.
    """

    def __init__(self, stop, alarm, woken=lambda: None):
        self._woken = woken
        self._link, other = socket.socketpair()
        self._fed_tick = None
        self._unanswered = 0
        self.pid = os.fork()
        if self.pid == 0:
            self._link.close()
            _be_watchdog(other, stop, alarm)
        other.close()
        self._link.setblocking(False)

    def serve(self, loop):
        """Say once a tick that the loop lives.

        If the watchdog does not live, or had to stop the motors, the robot goes to fault.

        Args:
            loop: The robot.loop.Loop.
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
            if silent:
                self._woken()
            if silent and loop.safety.state == RUNNING:
                loop.fail(
                    "the loop was silent for {:g} s or longer, and the watchdog stepped in and"
                    " stopped the motors: was the machine busy with something else? Clear the fault"
                    " to go on".format(SILENCE_S)
                )

    def feed(self):
        """Say that the loop lives.

        Returns:
            Whether the watchdog has stopped the motors since the last call.

        Raises:
            MotorFault: The watchdog has ended, or does not answer.
        """
        try:
            echoes = self._echoes()
            self._send(_ALIVE)
            if _STOPPED in echoes:
                echoes += self._last_echoes()
        except OSError as error:
            raise MotorFault(
                "the watchdog has ended ({}); start the robot's program again".format(
                    error.strerror
                )
            ) from error
        self._unanswered += 1 - echoes.count(_ALIVE)
        if self._unanswered > MOST_UNANSWERED:
            raise MotorFault("the watchdog does not answer; start the robot's program again")
        return _STOPPED in echoes

    def _last_echoes(self):
        """Wait until the watchdog has heard that the loop lives, so that no stop is under way.

        That stop would fall upon a robot that somebody has cleared and started meanwhile.
        """
        echoes = b""
        until = time.monotonic() + LAST_STOP_S
        while not echoes.endswith(_ALIVE):
            left_s = max(until - time.monotonic(), 0.0)
            if not select.select([self._link], (), (), left_s)[0]:
                break
            echoes += self._echoes()
        return echoes

    def _send(self, what):
        try:
            self._link.send(what)
        except BlockingIOError:
            pass  # the link is full: a frozen watchdog has not read it

    def _echoes(self):
        try:
            echoes = self._link.recv(4096)
        except BlockingIOError:
            return b""
        if not echoes:
            raise OSError(0, "it closed its link")
        return echoes

    def close(self):
        """End the watchdog. Stop the motors first; it tries for longer, if they do not obey."""
        try:
            self._send(_FAREWELL)
        except OSError:
            pass  # it has ended already
        self._link.close()
        try:
            # A frozen watchdog would not end, and nor would this process.
            os.kill(self.pid, signal.SIGCONT)
            until = time.monotonic() + LONGEST_S + FAREWELL_S
            while os.waitpid(self.pid, os.WNOHANG)[0] == 0:
                if time.monotonic() > until:
                    os.kill(self.pid, signal.SIGKILL)
                time.sleep(0.01)
        except OSError:
            pass


def _say(text):
    """Write to standard error if it takes no time: a stopped terminal could block the watchdog."""
    try:
        if select.select((), [2], (), 0)[1]:
            os.write(2, text.encode("utf-8", "replace"))
    except OSError:
        pass


def _be_watchdog(link, stop_motors, alarm):
    """What the forked process does, until it ends."""
    schedule.take_priority(schedule.WATCHDOG_PRIORITY)
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        # They are meant for the loop; the watchdog waits for its end.
        signal.signal(number, signal.SIG_IGN)
    said, trouble = "", False

    def stop(reason):
        nonlocal said, trouble
        failed = stop_motors()
        result = "not stopped: " + ", ".join(failed) if failed else "motors stopped"
        words = "watchdog: {}\n".format("; ".join(filter(None, (reason, result))))
        # Motors that do not obey get a stop every AGAIN_S, but no line for each; motors that obey
        # get another one while the silence lasts, and no line unless they did not obey before.
        news = words != said if failed else bool(reason or trouble)
        if news and reason:
            alarm()
        if news:
            _say(words)
        said, trouble = words, bool(failed)
        return not failed

    status = 0
    try:
        os.setsid()
        watch(link, stop)
    except BaseException:  # noqa: BLE001 - the motors come first, with every error
        status = 1
        stop_motors()
    finally:
        os._exit(status)
