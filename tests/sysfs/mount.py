"""A live file tree of a brick, served by a process of its own, and always unmounted in the end."""

import importlib.util
import os
import shutil
import subprocess
import sys
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from robot.schedule import LOOP_PRIORITY

ROOT = Path(__file__).resolve().parents[2]


def why_not():
    """What this machine lacks for a mount, and how to get it; empty if nothing."""
    if not Path("/dev/fuse").exists():
        return (
            "there is no /dev/fuse: load the kernel module (modprobe fuse), or give the container"
            " the device"
        )
    if shutil.which("fusermount3") is None:
        return "there is no fusermount3: apt-get install fuse3"
    if importlib.util.find_spec("mfusepy") is None:
        return "there is no mfusepy: make setup"
    return ""


needs_mount = pytest.mark.skipif(bool(why_not()), reason=why_not())


def _put_first(process):
    """Have a process and its children run before everything else on this machine, if root asks.

    On the brick the kernel's files answer at once, and the robot's program has the machine nearly
    to itself. Here both would wait for their turn at each file access, also behind the threads of
    a lab, which are urgent, too, but less. What has a priority of its own keeps it.
    """
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text(encoding="ascii")
    for pid in (process.pid, *map(int, children.split())):
        if os.sched_getparam(pid).sched_priority < LOOP_PRIORITY:
            with suppress(PermissionError):
                os.sched_setscheduler(pid, os.SCHED_RR, os.sched_param(LOOP_PRIORITY))


def started(*arguments):
    """A process of the project, once it has printed its READY line, and the words after READY."""
    process = subprocess.Popen(
        [sys.executable, "-m", *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        bufsize=1,
    )
    line = process.stdout.readline()
    if not line.startswith("READY "):
        process.kill()
        pytest.fail(f"{arguments} did not start: {line}{process.communicate()[1]}")
    _put_first(process)
    return process, line[len("READY ") :].strip()


def ended(process):
    """The exit status of a process after SIGTERM, and what it wrote to standard error."""
    process.terminate()
    try:
        errors = process.communicate(timeout=20)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        errors = process.communicate()[1]
    return process.returncode, errors


@contextmanager
def mounted(folder, *options):
    """The mount's path; `options` are sim_motor's."""
    folder.mkdir()
    process = None
    try:
        process, _ = started("sim_motor", "--sysfs", str(folder), *options)
        yield folder
    finally:
        if process is not None:
            ended(process)
        # Not by asking the mount itself, which may hang.
        if f" {folder} " in Path("/proc/mounts").read_text(encoding="utf-8"):
            subprocess.run(["fusermount3", "-u", "-z", folder], check=False)


def inject(folder, fault):
    """Inject a fault, as a line of the mount's file .faults."""
    (folder / ".faults").write_text(fault, encoding="ascii")


def motor_folder(folder, port):
    """Where the motor at a port is just now."""
    return next(
        path.parent
        for path in folder.glob("tacho-motor/*/address")
        if path.read_text(encoding="ascii").strip().endswith(port)
    )
