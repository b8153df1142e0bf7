"""An emulated ARM926 with a Python for it: what a program executes there, counted."""

import os
import shutil
import subprocess
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import ev3dev2

ROOT = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "kickctl", "armel")
SUITE, PYTHON = "bookworm", "python3.11"
TOOLS = {"qemu-arm": "qemu-user", "gcc": "gcc"}
TOOLS_FOR_CACHE = {"debootstrap": "debootstrap", "dpkg-deb": "dpkg"}


class Unavailable(Exception):
    """The emulator cannot be had; the message says why and what to do."""


class Mark(NamedTuple):
    """A line that a program printed, and what it had executed until then."""

    line: str
    instructions: int
    calls: int


class Emulator:
    """Runs Python programs on an ARM926 in user mode.

    Raises Unavailable if something for it is missing. $PYTHON_ARM names another Python than
    Debian's, and $QEMU_LD_PREFIX where its C library is.

    folder: where it keeps its plugin and the robot's sources while it is used.
    """

    def __init__(self, folder: Path) -> None:
        _need(TOOLS, "")
        self._python = os.environ.get("PYTHON_ARM") or ""
        if not self._python:
            if not CACHE.exists():
                _fill_cache()
            self._python = str(CACHE / "usr/bin" / PYTHON)
        elif not Path(self._python).is_file():
            raise Unavailable(f"there is no {self._python}: PYTHON_ARM names a Python for armel")
        self._plugin = folder / "count.so"
        subprocess.run(
            [
                "gcc",
                "-O2",
                "-shared",
                "-fPIC",
                "-o",
                self._plugin,
                Path(__file__).with_name("count.c"),
            ],
            check=True,
        )
        # Of the library alone, since its neighbours in .venv are for another processor.
        self._sources = folder / "sources"
        for source in (ROOT / "robot", ROOT / "tests" / "bench_arm", Path(ev3dev2.__file__).parent):
            goal = self._sources / (
                source.relative_to(ROOT) if source.is_relative_to(ROOT / "tests") else source.name
            )
            shutil.copytree(source, goal, ignore=shutil.ignore_patterns("__pycache__"))

    @contextmanager
    def start(self, *arguments: str):
        """A running program, as a Popen with pipes; it is terminated in the end."""
        command = [
            "qemu-arm",
            "-cpu",
            "arm926",
            "-plugin",
            str(self._plugin),
            self._python,
        ]
        environment = {
            "PYTHONPYCACHEPREFIX": str(self._plugin.with_name("pyc")),
            "PYTHONHASHSEED": "0",
            # Where QEMU finds the loader and the C library of that Python.
            "QEMU_LD_PREFIX": os.environ.get("QEMU_LD_PREFIX") or str(CACHE),
        }
        with subprocess.Popen(
            [*command, *arguments],
            env=environment,
            cwd=self._sources,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            try:
                yield process
            finally:
                process.terminate()

    def run(self, *arguments: str) -> list[Mark]:
        """The marks of a program that ends by itself. Raises Unavailable if it fails."""
        with self.start(*arguments) as process:
            out, err = process.communicate()
        if process.returncode:
            raise Unavailable(f"the emulated program failed: {err.strip()}")
        counts = [line.split()[1:] for line in err.splitlines() if line.startswith("COUNT")]
        return [
            Mark(line, int(done), int(calls))
            for line, (done, calls) in zip(out.splitlines(), counts, strict=True)
        ]

    def until_line(self, *arguments: str) -> Mark:
        """The mark of a program's first line; it is terminated then."""
        with self.start(*arguments) as process:
            line = process.stdout.readline().strip()
            process.terminate()
            counts = [
                text.split()[1:]
                for text in process.stderr.read().splitlines()
                if text.startswith("COUNT")
            ]
        if not line:
            raise Unavailable("the emulated program printed nothing")
        return Mark(line, *map(int, counts[0]))


def _need(tools: dict[str, str], why: str) -> None:
    missing = [package for tool, package in tools.items() if not shutil.which(tool)]
    if missing:
        raise Unavailable(
            f"needs {', '.join(missing)}{why}. Install it (Debian, Ubuntu: apt-get install"
            f" {' '.join(missing)}) and try again"
        )


def _fill_cache() -> None:
    """Unpack Debian's Python for armel, without installing it: the emulator runs it from there."""
    why = f", once, for an ARM Python in {CACHE}"
    _need(TOOLS_FOR_CACHE, why)
    if os.geteuid() != 0:
        raise Unavailable(
            f"needs root{why}, since debootstrap does. Run it as root, or keep XDG_CACHE_HOME from"
            " a run as root"
        )
    print(f"fetching an ARM Python into {CACHE} (about 40 MB; once)", flush=True)
    CACHE.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=CACHE.parent) as folder:
        packages = ["--include=python3-minimal,libpython3.11-stdlib"]
        command = [
            "debootstrap",
            "--download-only",
            "--arch=armel",
            "--variant=minbase",
            *packages,
            SUITE,
            f"{folder}/download",
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise Unavailable(
                f"debootstrap failed: {(done.stdout + done.stderr).strip().splitlines()[-1]}"
            )
        for package in sorted(Path(folder, "download/var/cache/apt/archives").glob("*.deb")):
            subprocess.run(["dpkg-deb", "-x", package, f"{folder}/root"], check=True)
        Path(folder, "root").rename(CACHE)
