"""`make bench`: how fast the things are that have to be fast, as ratios and rates of one run.

With --page it also writes what it has measured, and on which machine, to docs/benchmarks.md. A
number says for how many minutes the lab page's memory is followed, instead of 10.
"""

import io
import os
import platform
import re
import socket
import sys
import textwrap
import time
from contextlib import redirect_stdout
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from math import cos, exp, sin, tanh
from pathlib import Path

from tests.bench_drawings import drawings
from tests.bench_io import reads_and_writes
from tests.bench_jitter import collector, schedules
from tests.bench_lab import lab_page
from tests.bench_starts import starts
from tests.bench_static_page import page_without_a_server
from tests.bench_stop import stop_beside_a_blocked_request, stop_from_a_shell, stop_of_all
from tests.bench_storm import many_hosts

PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"
INTRODUCTION = """# Benchmarks

`make bench` measures what has to be fast. This page is its output of one run, as
`.venv/bin/python -m tests.bench --page` has written it; nothing of it is typed by hand. Ratios of
one run say more than times: times are those of this machine, and whatever else it does adds to
them. FAIL stands where this run missed a goal. What ticks cost on a real brick's processor is on
[another page](arm.md).
"""


class Both(io.StringIO):
    """Keeps what is printed, and prints it."""

    def write(self, text: str) -> int:
        sys.__stdout__.write(text)
        sys.__stdout__.flush()
        return super().write(text)


def main() -> None:
    """Print everything."""
    minutes = [float(word) for word in sys.argv[1:] if word != "--page"]
    measures = {
        "The first and the second start of commands": starts,
        "Reading angles and writing duty cycles": reads_and_writes,
        "The controller": controller_tick,
        "Virtual time": virtual_time,
        "Many wheels at once": batch,
        "Cars and trains": bodies,
        "How late ticks begin": schedules,
        "Python's garbage collector": collector,
        "A stop beside a request that waits": stop_beside_a_blocked_request,
        "A stop from a shell": stop_from_a_shell,
        "A stop of three robots": stop_of_all,
        "Many hosts": many_hosts,
        "The drawings of the lab page": drawings,
        "The lab page": partial(lab_page, *minutes),
        "The lab page without a server": page_without_a_server,
    }
    machine = (
        f"{processor()}, {os.cpu_count()} cores; Linux {platform.release().partition('-')[0]};"
        f" Python {platform.python_version()}, numpy {version('numpy')}, numba {version('numba')},"
        f" MuJoCo {version('mujoco-core')}"
    )
    print(machine, flush=True)
    page = [INTRODUCTION, textwrap.fill(f"{datetime.now(UTC):%Y-%m-%d}: {machine}.", 98)]
    for title, measure in measures.items():
        with redirect_stdout(Both()) as heard:
            measure()
        lines = [
            textwrap.fill(line, 98, subsequent_indent="  ")
            for line in heard.getvalue().splitlines()
        ]
        page.append("\n".join([f"\n## {title}\n", "```text", *lines, "```"]))
    if "--page" in sys.argv[1:]:
        PAGE.write_text("\n".join(page) + "\n", encoding="utf-8")


def processor() -> str:
    """What this machine's processor calls itself."""
    text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    found = re.search(r"^model name\s*: (.*)$", text, re.MULTILINE)
    return found[1] if found else platform.machine()


def best_of(repeats, function):
    """The shortest time (s) that `function` took.

    Whatever else the machine did only ever adds to it.
    """
    times = []
    for _ in range(repeats):
        start_s = time.perf_counter()
        function()
        times.append(time.perf_counter() - start_s)
    return min(times)


def controller_tick() -> None:
    """Two wheels through robot.wheel.Wheel against the same arithmetic written inline."""
    from robot.params import Params
    from robot.wheel import Wheel

    count = 20000
    params, wheels = Params(), (Wheel("left"), Wheel("right"))

    def through_robot():
        for tick in range(count):
            for wheel in wheels:
                wheel.phi = 0.1 * tick
                wheel.step(tick, 0.03, params, None)

    def inline():
        a, tau, k, dt = 4.0, 0.25, 8.0, 0.03
        l1 = l2 = r1 = r2 = 0.0
        for tick in range(count):
            phi = 0.1 * tick
            c, s = cos(phi), sin(phi)
            l1 += dt * (c - l1) / tau
            l2 += dt * (s - l2) / tau
            tanh(
                k * (2 / (1 + exp(-a * l1)) - 1 - c) * s - k * (2 / (1 + exp(-a * l2)) - 1 - s) * c
            )
            phi = 0.1 * tick
            c, s = cos(phi), sin(phi)
            r1 += dt * (c - r1) / tau
            r2 += dt * (s - r2) / tau
            tanh(
                k * (2 / (1 + exp(-a * r1)) - 1 - c) * s - k * (2 / (1 + exp(-a * r2)) - 1 - s) * c
            )

    ours, bare = best_of(5, through_robot), best_of(5, inline)
    print(
        f"controller tick, two wheels: {1e6 * ours / count:.2f} us, {ours / bare:.2f} times the"
        " bare arithmetic inline",
        flush=True,
    )


def virtual_time() -> None:
    """Robot seconds per wall second on one core.

    The loop alone, and with a host that takes in every record.
    """
    from host.client.robot import connect
    from robot.loop import Loop
    from robot.server import Server
    from sim_motor.brick import SimBrick

    seconds = 300.0
    brick = SimBrick(1)
    loop = Loop(brick.motors, brick.battery, brick.clock, brick.seed)
    server = Server(loop, b"\0" * 32)
    loop.start()

    def alone():
        until = loop.clock.now() + seconds
        while loop.clock.now() < until:
            loop.clock.wait(loop.deadline, server.serve)
            loop.tick()

    alone()
    rate = seconds / best_of(3, alone)
    with connect("sim://", seed=1) as robot:
        robot.wait(5)
        watched = seconds / best_of(3, lambda: robot.wait(seconds))
    print(
        f"virtual time, full loop: {rate:.0f} robot seconds a second; with a host that takes in"
        f" every record: {watched:.0f}",
        flush=True,
    )


def batch() -> None:
    """Wheel-seconds per wall second, compiled, on all cores."""
    import numpy as np

    from sim_motor.batch import random_times, run

    wheels, ticks = 4000, 1000
    run(8, 100, seed=1)
    together = random_times(1, ticks, 0.03, np.random.default_rng(1))
    for title, times in (
        ("each wheel late in its own way", None),
        ("all wheels late together", together),
    ):
        elapsed = best_of(5, lambda times=times: run(wheels, ticks, seed=1, times=times))
        rate = wheels * ticks * 0.03 / elapsed
        print(
            f"compiled batch, {os.cpu_count()} cores, {title}: {rate:,.0f} wheel-seconds a second",
            flush=True,
        )


def bodies() -> None:
    """Cars in MuJoCo with the controllers of all wheels, against MuJoCo alone."""
    import mujoco
    import numpy as np
    from mujoco.rollout import rollout

    from host.bodies.build import BodyRequest, build_body

    full, pushed = (
        mujoco.mjtState.mjSTATE_FULLPHYSICS,
        mujoco.mjtState.mjSTATE_CTRL | mujoco.mjtState.mjSTATE_XFRC_APPLIED,
    )
    for what, cars in (("car", 1), ("train", 5)):
        for preset in ("paper", "snake2019"):
            own_s, plain_s, steps = [], [], 3000
            body = build_body(BodyRequest(cars=cars, preset=preset))
            model, data = body.model, mujoco.MjData(body.model)
            step_s = float(model.opt.timestep)
            body.run(2.0)
            for _ in range(3):
                # The same motion three times: to hear what pushes it in each step, with its
                # controllers, and with what was heard.
                start, sizes = (
                    np.empty(mujoco.mj_stateSize(model, full)),
                    mujoco.mj_stateSize(model, pushed),
                )
                mujoco.mj_getState(model, body.data, start, full)
                floats, step = body.neurons.floats.copy(), body.step
                heard = np.empty((1, steps, sizes))
                for number in range(steps):
                    body.run(step_s)
                    mujoco.mj_getState(model, body.data, heard[0, number], pushed)
                mujoco.mj_setState(model, body.data, start, full)
                body.neurons.floats[:], body.step = floats, step
                own_s.append(
                    best_of(1, lambda body=body, seconds=steps * step_s: body.run(seconds))
                )
                plain_s.append(
                    best_of(
                        1,
                        lambda m=model, d=data, b=start, h=heard: rollout(
                            m, d, b, h, control_spec=int(pushed)
                        ),
                    )
                )
            ours = min(own_s)
            print(
                f"{what} ({preset}), one core: {steps / ours:,.0f} steps/s of {1000 * step_s:g} ms,"
                f" {steps * step_s / ours:.0f} times real time; {min(plain_s) / ours:.2f} of"
                " MuJoCo's bare stepping" + (" (goals: 15, 0.5)" if cars > 1 else " (goal: 0.5)")
            )


if __name__ == "__main__":
    socket.setdefaulttimeout(30.0)
    main()
