"""A serial line to a robot, which one program at a time may set up and read."""

from __future__ import annotations

import errno
import os
import select
import stat
import termios
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Self

from host.errors import NoLink, printable
from host.link.transport import CONNECT_TIMEOUT_S, READ_BYTES, LinkLost, Meant

# What the kernel says of a line that another program has locked, or keeps for itself.
_TAKEN = (errno.EAGAIN, errno.EBUSY)


class SerialLink:
    """A serial line.

    Two readers of one line take each other's bytes. So the line is locked, and a second program
    that opens it learns who has it. A stop goes over the open line first.

    Args:
        uri: The robot's address.
        device: The device file.
        baud: The baud rate.
        shared: Whether to use the line, as it is set up, if another program has locked it.
    """

    virtual = False
    opens_fast = False
    is_line = True
    meant: Meant | None = None

    def __init__(self, uri: str, device: str, baud: int, *, shared: bool = False) -> None:
        import serial

        self.uri = uri
        self.device = device
        self._shared = shared
        self._serial = serial.Serial(baudrate=baud, exclusive=True)
        self._serial.port = device
        self._fd: int | None = None

    def another(self) -> Self:
        """The same line, not opened yet, also if this link or another program has locked it.

        Who sends a stop must not have to wait until a line is free.
        """
        other = type(self)(self.uri, self.device, int(self._serial.baudrate), shared=True)
        other.meant = self.meant
        return other

    def open(self) -> None:
        """Open the line, closing it first if it is open. Raises NoLink."""
        self.close()
        try:
            self._serial.open()
            self._fd = self._serial.fileno()
        # pyserial may say OverflowError, ValueError or termios.error of a baud rate, or of what is
        # no serial line.
        except (OSError, OverflowError, ValueError, termios.error) as error:
            if isinstance(error, OSError) and error.errno in _TAKEN:
                self._join()
                return
            why, hint = _explained(self.device, error)
            raise NoLink(f"the serial line {self.uri} cannot be opened: {why}", hint) from error

    def _join(self) -> None:
        """Use the line beside the program that has set it up, if that may be. Raises NoLink."""
        if not self._shared:
            raise NoLink(
                f"the serial line {self.uri} is in use: {holder(self.device)} has it open",
                "end that program, or use the robot from there; `kickctl stop` works nevertheless",
            )
        try:
            self._fd = os.open(self.device, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        except OSError as error:
            raise NoLink(
                f"nothing can be sent over {self.uri}, so the motors may still be running:"
                f" {holder(self.device)} keeps the line for itself",
                "end that program and try again, press the back button on the brick, or take out"
                " its battery",
            ) from error

    def send(self, data: bytes) -> None:
        """Send all of it. Raises LinkLost."""
        until = self.now() + CONNECT_TIMEOUT_S
        while data:
            try:
                data = data[os.write(self._descriptor(), data) :]
            except BlockingIOError:
                self._wait(select.POLLOUT, 0.1)
                if self.now() > until:
                    raise LinkLost("the line takes nothing more") from None
            except OSError as error:
                raise LinkLost(str(error)) from error

    def receive(self, timeout_s: float) -> bytes:
        """What has arrived within timeout_s; empty also if another reader took it.

        Raises LinkLost.
        """
        if not self._wait(select.POLLIN, max(0.0, timeout_s)):
            return b""
        try:
            return os.read(self._descriptor(), READ_BYTES)
        except BlockingIOError:
            return b""
        except OSError as error:
            raise LinkLost(str(error)) from error

    def _wait(self, event: int, timeout_s: float) -> bool:
        """Wait until the line is ready. Raises LinkLost if it came off."""
        poll = select.poll()
        poll.register(self._descriptor(), event)
        ready = poll.poll(1000 * timeout_s)
        if ready and ready[0][1] & ~event:
            raise LinkLost("the line came off")
        return bool(ready)

    def _descriptor(self) -> int:
        if self._fd is None:
            raise LinkLost("the connection is closed")
        return self._fd

    def now(self) -> float:
        """Monotonic seconds."""
        return time.monotonic()

    def close(self) -> None:
        """Close the line."""
        if self._fd is not None and not self._serial.is_open:
            os.close(self._fd)
        self._fd = None
        self._serial.close()


def _explained(device: str, error: Exception) -> tuple[str, str]:
    """(why, what to do) of a device file that cannot be opened as a serial line."""
    try:
        mode = os.stat(device).st_mode  # noqa: PTH116 - Path refuses a NUL differently
    except (OSError, ValueError) as missing:
        cable = "is the cable in? `ls /dev/tty*` shows which lines there are"
        return f"{device}: {getattr(missing, 'strerror', missing)}", cable
    if not stat.S_ISCHR(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "a file and no device"
        return f"{device} is {kind}", "name the device file, as in serial:///dev/ttyUSB0"
    if isinstance(error, OSError) and error.errno in (errno.EACCES, errno.EPERM):
        return f"this user may not use {device}", "are you in group dialout?"
    return (
        f"{device} does not behave as a serial line: {error}",
        "is the cable in, and the baud rate one that the line has?",
    )


def holder(device: str) -> str:
    """Who has a device file open, in words, as far as this user may see it."""
    names = [f"'{name}' (process {pid})" for pid, name in _openers(os.path.realpath(device))]
    return " and ".join(names) or "another program, perhaps of another user,"


def _openers(path: str) -> Iterator[tuple[int, str]]:
    """(process number, command) of each program that has a file open."""
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if any(str(link.readlink()) == path for link in (process / "fd").iterdir()):
                command = (process / "cmdline").read_bytes().replace(b"\0", b" ")
                yield int(process.name), printable(command.decode(errors="replace").strip())[:60]
