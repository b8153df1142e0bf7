"""What holds for every test.

Hypothesis counts no time, nothing outside of the test's own folder is touched, and tests that need
real time are marked.
"""

import gc
import os
import shutil
import signal
import sys

import pytest
from hypothesis import HealthCheck, settings

# No clock decides about a test: neither how long an example takes, nor how long it takes to make
# one up on a busy machine. Where changes are judged, the same examples are tried each time;
# elsewhere new ones.
settings.register_profile(
    "house",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize="CI" in os.environ,
)
settings.load_profile("house")

# Compiled functions are named by what went into them, so that tests may share them with each other
# and with everything else.
CACHES = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")  # noqa: PTH111
os.environ.setdefault("NUMBA_CACHE_DIR", CACHES)
# The tests share the cores by themselves: for small matrices, BLAS's threads mostly wait for each
# other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Without a list of fonts each program that draws makes one first, and says so after five seconds.
os.environ.setdefault("MPLCONFIGDIR", os.path.join(CACHES, "matplotlib"))  # noqa: PTH118
# Whoever draws with OpenGL first in a process would make it in a test's own folder.
os.environ.setdefault("MESA_SHADER_CACHE_DIR", CACHES)

# The tests make and remove ten thousand folders, and a disk's journal has them wait for each.
MEMORY = "/dev/shm"  # noqa: S108 - each run has a folder of its own in there
ROOM_BYTES = 2 * 1024**3
if (
    os.access(MEMORY, os.W_OK)
    and not os.statvfs(MEMORY).f_flag & os.ST_NOEXEC
    and shutil.disk_usage(MEMORY).free > ROOM_BYTES
):
    os.environ.setdefault("PYTEST_DEBUG_TEMPROOT", MEMORY)

# Where python3 is a script that looks for the right Python, each call would take far longer.
os.environ["PATH"] = os.pathsep.join((sys.base_prefix + "/bin", os.environ["PATH"]))

# Tests with real sockets, sshd, mounted files, processes of their own or the watchdog: `pytest -m
# realtime` runs these alone. They hold beside tests that compute, too.
REAL_TIME = (
    "tests/api/test_listen_page.py",
    "tests/api/test_listeners.py",
    "tests/api/test_own_motors_page.py",
    "tests/api/test_slow_listeners.py",
    "tests/cli/test_desk.py",
    "tests/cli/test_foxglove.py",
    "tests/cli/test_lab.py",
    "tests/cli/test_lesson_desk.py",
    "tests/cli/test_typed_pages.py",
    "tests/cli/test_watch_several.py",
    "tests/cli/test_watch_terminal.py",
    "tests/contract/test_motor.py",
    "tests/deploy/",
    "tests/foxglove/test_live.py",
    "tests/foxglove/test_viewers.py",
    "tests/lab/test_forecasts.py",
    "tests/lab/test_live.py",
    "tests/lab/test_owed_stops.py",
    "tests/lab/test_serial_station.py",
    "tests/lab/test_web.py",
    "tests/link/test_own_motors.py",
    "tests/link/test_neighbours.py",
    "tests/link/test_program_start.py",
    "tests/link/test_protocol_page.py",
    "tests/link/test_robots_by_name.py",
    "tests/link/test_robots_line.py",
    "tests/link/test_serial.py",
    "tests/link/test_stop.py",
    "tests/link/test_who_drives.py",
    "tests/sysfs/",
    "tests/web/test_alone.py",
    "tests/web/test_access.py",
    "tests/web/test_baton.py",
    "tests/web/test_hidden.py",
    "tests/web/test_notebook.py",
    "tests/web/test_page.py",
    "tests/web/test_projector.py",
    "tests/web/test_stop.py",
    "tests/unit/robot/test_program.py",
    "tests/unit/robot/test_watchdog.py",
)


# A fault's failure says what it found, as a test's does.
pytest.register_assert_rewrite("tests.faults")


def pytest_configure(config):
    config.addinivalue_line("markers", "realtime: runs in real time, see REAL_TIME in conftest.py")
    # Whoever runs the tests in a shell's background has ^C ignored, with nohup the terminal's end,
    # and so have their children.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
        signal.signal(signal.SIGHUP, signal.SIG_DFL)


# By itself, Python looks for garbage so often that it takes a tenth of the tests' time.
NEW_OBJECTS = 10000


# What collection makes stays until the end: the collector need not look through it as it grows,
# nor afterwards.
@pytest.hookimpl(hookwrapper=True)
def pytest_collection():
    gc.disable()
    yield
    freeze = getattr(gc, "freeze", None)  # Python 3.5 has none
    if freeze is not None:
        freeze()
    gc.enable()
    gc.set_threshold(NEW_OBJECTS)


# They mostly wait. At the end they would do so with nothing beside them that computes.
FIRST = "tests/deploy/"


# Before `-m` chooses by the marks.
@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: not item.nodeid.startswith(FIRST))
    for item in items:
        if item.nodeid.startswith(REAL_TIME):
            item.add_marker("realtime")


@pytest.fixture(scope="module")
def desk():
    """A simulated robot in a process of its own, which waits for a start."""
    from host.lab.desk_robot import DeskRobot, child_options

    with DeskRobot(child_options("sim://?seed=1&idle=1")) as desk:
        yield desk


@pytest.fixture
def observer(desk):
    """Who watches that robot, once it stands and nobody holds it any more."""
    from host.client.robot import connect

    with connect(desk.uri, observe=True) as robot:
        robot.stop()
        # Who held it in the test before may have been killed just now.
        robot.wait(20.0, until=lambda: robot.status()["controller"] is None)
        yield robot


@pytest.fixture(autouse=True)
def _own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    monkeypatch.delenv("KICK_BRICK", raising=False)
