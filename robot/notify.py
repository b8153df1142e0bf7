"""Messages to systemd that the robot's program is ready and alive (sd_notify(3))."""

from robot.bare import socket


class Notify(object):
    """A panel of the program that sends them; it does nothing if the program is no service.

    Args:
        environment: A mapping like os.environ. A service has NOTIFY_SOCKET in it, and WATCHDOG_USEC
            if systemd wants to hear regularly that the program lives.
    """

    def __init__(self, environment):
        address = environment.get("NOTIFY_SOCKET", "")
        # '@' stands for the zero byte of a name that is in no file system.
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._link = None
        microseconds = environment.get("WATCHDOG_USEC", "")
        self._period_s = int(microseconds) / 2e6 if microseconds.isdigit() else 0.0
        self._due_s = None
        if address:
            self._link = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self._link.setblocking(False)

    def serve(self, loop):
        """Send READY the first time, and WATCHDOG twice in each of systemd's watchdog periods.

        Args:
            loop: The robot.loop.Loop.
        """
        if self._link is None:
            return
        now = loop.clock.now()
        if self._due_s is None:
            self._send(b"READY=1")
            self._due_s = now
        if self._period_s and now >= self._due_s:
            self._send(b"WATCHDOG=1")
            self._due_s = now + self._period_s

    def close(self):
        """Send that the program ends."""
        if self._link is not None:
            self._send(b"STOPPING=1")
            self._link.close()
            self._link = None

    def _send(self, what):
        try:
            self._link.sendto(what, self._address)
        except OSError:
            pass  # systemd restarts a program that it does not hear
