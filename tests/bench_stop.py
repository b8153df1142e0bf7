"""How long a stop takes: beside a request that waits, from a shell, and for three robots."""

import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from host.client.robot import Robot, connect
from host.errors import KickctlError
from host.logs.log import Log
from robot.record import STATES, Record
from tests.cli.test_desk import desk_robot

STOPS = 40
TICK_S = 0.03
AT_MOST_S = TICK_S + 0.02
SHELL_RUNS = 10
SHELL_S = 0.3
STOPS_OF_ALL = 20
CLOCK_READINGS = 20
RUNNING = STATES.index("running")
APART_S = TICK_S + 0.05
NAMES = ("anna", "bert", "carl")
STOP = (sys.executable, "-m", "host", "stop")


def stop_beside_a_blocked_request() -> None:
    """Print the times from calling stop to the robot's word that the motors are off.

    A thread holds the connection meanwhile: it waits for the answer to a request that is never
    sent, so the answer never comes.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with (
            desk_robot(folder, "--tick", str(TICK_S)) as (uri, _),
            connect(uri, token=str(folder / "token")) as robot,
        ):
            times = _measure(robot)
            robot._broken = KickctlError("the measurement is over")  # frees the thread
    verdict = "PASS" if max(times) <= AT_MOST_S else "FAIL"
    print(
        f"stop on loopback beside a blocked request: median {1000 * statistics.median(times):.1f}"
        f" ms, at most {1000 * max(times):.1f} ms ({verdict}: at most one tick + 20 ms;"
        f" {STOPS} stops)",
        flush=True,
    )


def stop_from_a_shell() -> None:
    """Print how long `kickctl stop` takes for three robots, beside Python's start."""
    with _three_robots() as (_, environment):
        start_s, stop_s = (
            _shortest(command, environment) for command in ((sys.executable, "-c", ""), STOP)
        )
    more_s = stop_s - start_s
    print(
        f"stop from a shell, three robots on loopback: {stop_s:.2f} s, of that Python's"
        f" start {start_s:.2f} s ({'PASS' if more_s <= SHELL_S else 'FAIL'}: at most {SHELL_S:g} s"
        " more)",
        flush=True,
    )


def stop_of_all() -> None:
    """Print how far apart three robots are stopped by one `kickctl stop`.

    The time of a robot's stop is that of its first tick with the motors off, on this machine's
    clock.
    """
    with _three_robots() as (tokens, environment), ExitStack() as stack:
        robots = [stack.enter_context(connect(uri, token=token)) for uri, token in tokens.items()]
        zeros = [clock_zero(robot) for robot in robots]
        logs = [stack.enter_context(robot.recording()) for robot in robots]
        apart = []
        for _ in range(STOPS_OF_ALL):
            for robot, log in zip(robots, logs, strict=True):
                _wait_until(robot, log, running=True)
            subprocess.run(STOP, env=environment, check=True, stdout=subprocess.DEVNULL)
            off = []
            for zero_s, robot, log in zip(zeros, robots, logs, strict=True):
                _wait_until(robot, log, running=False)
                off.append(zero_s + first_tick_off(log).t_s)
                robot.start()
            apart.append(max(off) - min(off))
    verdict = "PASS" if max(apart) <= APART_S else "FAIL"
    print(
        f"stop for three robots on loopback: their first ticks with the motors off are"
        f" median {1000 * statistics.median(apart):.1f} ms apart, at most"
        f" {1000 * max(apart):.1f} ms ({verdict}: at most one tick + 50 ms ="
        f" {1000 * APART_S:.0f} ms; {STOPS_OF_ALL} stops)",
        flush=True,
    )


@contextmanager
def _three_robots() -> Iterator[tuple[dict[str, str], dict[str, str]]]:
    """Three running robots: {address: token file}, and the environment of a shell."""
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder, lines, tokens = Path(name), [], {}
        for robot in NAMES:
            (folder / robot).mkdir()
            uri, _ = stack.enter_context(desk_robot(folder / robot, "--tick", str(TICK_S)))
            lines.append(f'[{robot}]\naddress = "{uri}"\n')
            tokens[uri] = str(folder / robot / "token")
        (folder / "kickctl").mkdir()
        (folder / "kickctl" / "robots.toml").write_text("".join(lines), encoding="utf-8")
        environment = {**os.environ, "XDG_CONFIG_HOME": name}
        environment.pop("KICK_BRICK", None)
        environment.pop("PYTHONDONTWRITEBYTECODE", None)  # as on a user's machine
        yield tokens, environment


def clock_zero(robot: Robot) -> float:
    """When the robot's clock was at zero, in Unix seconds: what delays an answer only adds."""
    return min(time.time() - robot.status()["clock_s"] for _ in range(CLOCK_READINGS))


def _wait_until(robot: Robot, log: Log, *, running: bool) -> None:
    """Wait until the newest record says that the robot runs, or that it does not."""

    def arrived() -> bool:
        return bool(log.records) and (log.records[-1].state == RUNNING) == running

    robot.wait(float("inf"), until=arrived)


def first_tick_off(log: Log) -> Record:
    """The first record of the stop that the log ends with."""
    last = max(place for place, record in enumerate(log.records) if record.state == RUNNING)
    return log.records[last + 1]


def _shortest(command: tuple[str, ...], environment: dict[str, str]) -> float:
    """The shortest time (s) that a program takes: what else the machine does only adds to it."""
    times = []
    for _ in range(SHELL_RUNS):
        begin = time.perf_counter()
        subprocess.run(command, env=environment, check=True, stdout=subprocess.DEVNULL)
        times.append(time.perf_counter() - begin)
    return min(times)


def _measure(robot: Robot) -> list[float]:
    """The time (s) that each stop takes."""
    robot.answer_s = 3600.0

    def wait_for_ever():
        with suppress(KickctlError), robot._lock:
            session = robot._talk.session
            robot._exchange(lambda: (-1, b""), "a request that is never sent", session)

    waiting = threading.Thread(target=wait_for_ever, daemon=True)
    waiting.start()
    time.sleep(0.2)
    times = []
    for _ in range(STOPS):
        begin = time.perf_counter()
        robot.stop()
        times.append(time.perf_counter() - begin)
        time.sleep(0.013)
    assert waiting.is_alive(), "no request waited meanwhile"
    return times


if __name__ == "__main__":
    stop_from_a_shell()
    stop_of_all()
    stop_beside_a_blocked_request()
