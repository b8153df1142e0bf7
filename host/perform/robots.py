"""Does the cells of an experiment on robots.

A simulated one for each cell, or the one that there is, tried again when it is disturbed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from host.client.robot import Robot, connect
from host.errors import NoLink, NotDone, RobotFault
from host.link.addresses import SIM, sim_options
from host.logs.log import Log
from host.logs.mcap_files import McapTap
from host.runs.contract import Cell, Experiment, Row, Setting
from host.runs.folder import digest
from host.runs.runner import Outcome, Work
from host.util.installation import deploy_command
from robot.params import TABLE

# A robot's cell is tried again when something else came between, a fault or a link that broke.
TRIES = 3
PAUSE_S = 1.0
# The paper's parameters, with which every trial begins, whatever a robot was set to; it gets its
# own back in the end.
PAPER = {
    name: TABLE[name].default for name in ("a", "tau_s", "k", "tick_s", "rods", "max_duty_pct")
}


@contextmanager
def robots(
    experiment: Experiment,
    uri: str,
    setting: Setting,
    token: str | None,
    logs: Path,
    say: Callable[[str], None],
) -> Iterator[Work]:
    """Yields what does a cell on a robot.

    A simulated one of its own for each, or the one that there is, which is stopped in the end.
    """
    logs.mkdir(exist_ok=True)
    if sim_options(uri) is None:
        with connect(uri, token=token) as robot:
            robot.on_trouble = say
            own = {name: robot.status()["params"][name] for name in PAPER}
            try:
                yield lambda cell: _patient(experiment, cell, robot, setting, logs, say)
            finally:
                robot.stop()
                _set(robot, own)
        return

    def alone(cell: Cell) -> Outcome:
        with connect(_in_world(uri, experiment.world(cell)), setting.seed_of(cell)) as robot:
            return _trial(experiment, cell, robot, setting, logs), []

    yield alone


def _in_world(uri: str, world: dict[str, str]) -> str:
    options = {**(sim_options(uri) or {}), **world}
    return SIM + ("?" + urlencode(options) if options else "")


def _trial(
    experiment: Experiment, cell: Cell, robot: Robot, setting: Setting, logs: Path
) -> list[Row]:
    """One try of a cell, with its raw log, which a cell's next try replaces."""
    path = logs / f"{digest(cell)}.mcap"
    path.unlink(missing_ok=True)
    _set(robot, PAPER)
    if robot.status()["state"] != "running":
        robot.start()
    info = {**robot.info(), "cell": cell}
    log = Log(info)
    with McapTap(path, info) as file:
        robot.add_tap(file)
        robot.add_tap(log)
        try:
            rows = experiment.trial(cell, robot, log, setting)
        finally:
            robot.remove_tap(log)
            robot.remove_tap(file)
    if log.restarts() or log.missing():
        raise NotDone(
            "the robot's program began anew meanwhile, or records were lost",
            f"look at its log: {deploy_command()} --logs",
        )
    return rows


def _set(robot: Robot, wanted: dict[str, Any]) -> None:
    """Set those parameters that are not as wanted."""
    params = robot.status()["params"]
    changes = {name: value for name, value in wanted.items() if params[name] != value}
    if changes:
        robot.set(**changes)


def _patient(
    experiment: Experiment,
    cell: Cell,
    robot: Robot,
    setting: Setting,
    logs: Path,
    say: Callable[[str], None],
) -> Outcome:
    """A cell on a real robot. A try into which a fault, a stop or a broken link came does not count; its reason is kept."""
    spoiled: list[str] = []
    while True:
        try:
            return _trial(experiment, cell, robot, setting, logs), spoiled
        except (RobotFault, NotDone) as error:
            spoiled.append(error.message)
            if len(spoiled) >= TRIES:
                raise
            say(f"this try does not count: {error.message}; trying again")
            robot.wait(PAUSE_S)
            if robot.status()["state"] == "fault":
                robot.clear()
        except NoLink as error:
            raise NoLink(
                error.message, error.hint or "mend the link, and run the same command again"
            ) from error
