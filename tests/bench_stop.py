"""How long a stop takes while another thread of the same program waits for an answer."""

import statistics
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

from host.client.robot import Robot, connect
from host.errors import KickctlError
from tests.cli.test_desk import desk_robot

STOPS = 40
TICK_S = 0.03
AT_MOST_S = TICK_S + 0.02


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
    stop_beside_a_blocked_request()
