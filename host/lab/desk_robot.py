"""A desk robot as a child process: it lives exactly as long as the lab that has started it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Self

from host.errors import NotDone, WrongUse, printable
from host.link.addresses import make_link, sim_options
from robot.params import TABLE

READY = "READY "
# The options of the child that an address has, too.
_SAME = ("seed", "motor", "battery", "walls", "grip", "bumper", "axle")
_ENDING_S = 5.0
_LINES_KEPT = 20
_ROOM = str(Path(__file__).resolve().parents[2])


def child_options(uri: str, seed: int | None = None) -> list[str]:
    """The options of the child for a sim:// address.

    Args:
        uri: The address; its options are those of an embedded robot.
        seed: Overrides the address's own seed.

    Raises:
        WrongUse: It cannot be simulated, or not as a process of its own.
    """
    make_link(uri, seed)  # which says in words what is wrong with it
    options = dict(sim_options(uri) or {})
    if seed is not None:
        options["seed"] = str(seed)
    words = []
    for name, value in options.items():
        if name in _SAME:
            words += [f"--{name}", value]
        elif name in TABLE:
            words += ["--set", f"{name}={value}"]
        elif name != "idle":
            raise WrongUse(
                f"the lab's simulated robot has no option '{name}'",
                "leave it out, or start a robot yourself: python -m sim_motor --help",
            )
        elif value == "1":
            words.append("--idle")
    return words


class DeskRobot:
    """The child process; a context manager.

    Args:
        options: Its options, see `child_options`.

    Attributes:
        uri: Its address.
        token: The path of its token file.
        on_end: Called with words if it ends by itself.
    """

    def __init__(self, options: list[str]) -> None:
        self.uri = ""
        self.on_end: Callable[[str], object] = lambda words: None
        self._folder = tempfile.TemporaryDirectory(prefix="kickctl-lab-")
        self.token = str(Path(self._folder.name) / "token")
        self._ends = False
        self._lines: deque[str] = deque(maxlen=_LINES_KEPT)
        self._process = self._begin(options)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._input, self._output = self._process.stdin, self._process.stdout
        # A robot that hangs must not make the lab wait.
        os.set_blocking(self._input.fileno(), False)
        self._reader = threading.Thread(target=self._read, name="lab desk robot", daemon=True)
        try:
            self._await_ready()
        except BaseException:
            self.close()
            raise

    def _begin(self, options: list[str]) -> subprocess.Popen[str]:
        paths = [_ROOM, *filter(None, [os.environ.get("PYTHONPATH")])]
        return subprocess.Popen(
            # Nothing of the present folder, and --hand: the robot ends when this end of the pipe
            # is closed, which the system does however this process ends.
            [sys.executable, "-P", "-m", "sim_motor", "--hand"]
            + ["--port", "0", "--token", self.token, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)},
            start_new_session=True,  # ^C in the terminal is for the lab, which stops the robot
        )

    def _await_ready(self) -> None:
        for line in self._output:
            if line.startswith(READY):
                self.uri = line.removeprefix(READY).strip()
                self._reader.start()
                return
            self._lines.append(line.strip())
        raise NotDone(f"the simulated robot did not start: {self._said()}", "see sim_motor --help")

    def _read(self) -> None:
        """Take in what it says, until it ends."""
        for line in self._output:
            self._lines.append(line.strip())
        status = self._process.wait()
        if not self._ends:
            self.on_end(f"the simulated robot has ended with status {status}: {self._said()}")

    def _said(self) -> str:
        return printable(self._lines[-1]) if self._lines else "it said nothing"

    def pull(self, wheel: str, angle_rad: float | None) -> None:
        """Pull a wheel to an angle (rad); None lets go. A robot that is gone feels nothing."""
        word = "-" if angle_rad is None else f"{angle_rad:.6g}"
        with suppress(OSError, ValueError):
            os.write(self._input.fileno(), f"{wheel} {word}\n".encode())

    def close(self) -> None:
        """End the process, and forget its token."""
        self._ends = True
        self._process.terminate()
        try:
            self._process.wait(_ENDING_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._reader.is_alive():
            self._reader.join()
        self._input.close()
        self._output.close()
        self._folder.cleanup()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
