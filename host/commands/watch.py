"""kickctl watch."""

from __future__ import annotations

import argparse
import time
from math import inf, pi
from typing import TYPE_CHECKING, Any

from host.client.robot import Robot
from host.commands._terminal import robot_of
from host.util.numbers import Number
from robot.kicks import WHEELS
from robot.record import KICK_NAMES, STATES, Record

if TYPE_CHECKING:
    from rich.table import Table

HELP = (
    "show a live table of the wheels; ^C ends it. With --json: a stream of JSON lines, one object"
    " for each refresh"
)

REFRESH_S = 0.1
_SPEED_TICKS = 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add how long to watch."""
    parser.add_argument(
        "--seconds",
        type=Number("s", 0.001, 1e9),
        default=inf,
        metavar="S",
        help="how long to watch, in s of the robot's time (default: until ^C)",
    )


def run(options: argparse.Namespace) -> int:
    """Show the table; with --json print a line of JSON for each refresh instead."""
    from rich.live import Live

    from host.commands._terminal import show_next

    with robot_of(options) as robot:
        robot.wait(REFRESH_S)
        start_s = robot.recent()[0].t_s
        with Live(_table(robot), auto_refresh=False, transient=options.json) as live:
            try:
                while robot.recent()[-1].t_s - start_s < options.seconds:
                    robot.wait(REFRESH_S)
                    if robot.link.virtual:
                        # Virtual time would pass before anyone has seen it.
                        time.sleep(REFRESH_S)
                    if options.json:
                        show_next(_summary(robot.recent()))
                    else:
                        live.update(_table(robot), refresh=True)
            except KeyboardInterrupt:
                pass
    return 0


def _summary(records: list[Record]) -> dict[str, Any]:
    now, before = records[-1], records[max(-len(records), -1 - _SPEED_TICKS)]
    summary: dict[str, Any] = {
        "tick": now.tick,
        "t_s": now.t_s,
        "state": STATES[now.state],
        "kick": KICK_NAMES[now.kick],
    }
    for side in WHEELS:
        values = {
            name: getattr(now, f"{side}_{name}")
            for name in ("phi_rad", "x1", "x2", "force", "torque", "duty_pct")
        }
        turn_rad = values["phi_rad"] - getattr(before, side + "_phi_rad")
        summary[side] = {
            **values,
            "turns_per_s": (
                turn_rad / (2 * pi) / (now.t_s - before.t_s) if now is not before else 0.0
            ),
        }
    return summary


def _table(robot: Robot) -> Table:
    from rich.table import Table

    summary = _summary(robot.recent())
    table = Table(
        title=f"{robot.link.uri}  tick {summary['tick']}  {summary['state']}  {summary['kick']}",
        title_justify="left",
    )
    table.add_column("")
    for side in WHEELS:
        table.add_column(side, justify="right", min_width=9)
    rows = {
        "turns_per_s": "speed (turns/s)",
        "torque": "torque M",
        "duty_pct": "duty (%)",
        "x1": "x1",
        "x2": "x2",
        "phi_rad": "phi (rad)",
    }
    for name, title in rows.items():
        table.add_row(title, *(f"{summary[side][name]:.2f}" for side in WHEELS))
    return table
