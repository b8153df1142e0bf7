"""Tells systemd that the robot's program is ready and alive, if it was started as a service (sd_notify(3))."""

import socket


class Notify(object):
    """A panel of the program. Ready is told when it is first served, alive twice in each watchdog period; nothing without a service.

    environment: has NOTIFY_SOCKET, and WATCHDOG_USEC if systemd watches, in the way of os.environ.
    """

    def __init__(self, environment):
        address = environment.get("NOTIFY_SOCKET", "")
        # '@' stands for the zero byte of a name that is in no file system.
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self._link = None
        self._period_s = int(environment.get("WATCHDOG_USEC", "0")) / 2e6
        self._due_s = None
        if address:
            self._link = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            self._link.setblocking(False)

    def serve(self, loop):
        """Tell what is due."""
        if self._link is None:
            return
        now = loop.clock.now()
        if self._due_s is None:
            self._tell(b"READY=1")
            self._due_s = now
        if self._period_s and now >= self._due_s:
            self._tell(b"WATCHDOG=1")
            self._due_s = now + self._period_s

    def close(self):
        """Tell that the program ends."""
        if self._link is not None:
            self._tell(b"STOPPING=1")
            self._link.close()
            self._link = None

    def _tell(self, what):
        try:
            self._link.sendto(what, self._address)
        except OSError:
            pass  # systemd takes silence for what it is
