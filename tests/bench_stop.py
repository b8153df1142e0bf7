"""How long a stop takes while another thread of the same program waits for an answer."""

import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, suppress
from pathlib import Path

from host.client.robot import Robot, connect
from host.errors import KickctlError
from tests.cli.test_desk import desk_robot

STOPS = 40
TICK_S = 0.03
AT_MOST_S = TICK_S + 0.02
SHELL_RUNS = 10
SHELL_S = 0.3


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
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder = Path(name)
        lines = []
        for robot in ("anna", "bert", "carl"):
            (folder / robot).mkdir()
            uri, _ = stack.enter_context(desk_robot(folder / robot, "--tick", str(TICK_S)))
            lines.append(f'[{robot}]\naddress = "{uri}"\n')
        (folder / "kickctl").mkdir()
        (folder / "kickctl" / "robots.toml").write_text("".join(lines), encoding="utf-8")
        environment = {**os.environ, "XDG_CONFIG_HOME": name}
        environment.pop("KICK_BRICK", None)
        python, stop = ((sys.executable, *words) for words in (("-c", ""), ("-m", "host", "stop")))
        start_s, stop_s = (_shortest(command, environment) for command in (python, stop))
    more_s = stop_s - start_s
    print(
        f"kickctl stop from a shell, three robots on loopback: {stop_s:.2f} s, of that Python's"
        f" start {start_s:.2f} s ({'PASS' if more_s <= SHELL_S else 'FAIL'}: at most {SHELL_S:g} s"
        " more)",
        flush=True,
    )


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
        with suppress(KickctlError):
            robot._exchange(lambda: (-1, b""), "a request that is never sent")

    threading.Thread(target=wait_for_ever, daemon=True).start()
    time.sleep(0.2)
    times = []
    for _ in range(STOPS):
        begin = time.perf_counter()
        robot.stop()
        times.append(time.perf_counter() - begin)
        time.sleep(0.013)
    return times


if __name__ == "__main__":
    stop_from_a_shell()
    stop_beside_a_blocked_request()
