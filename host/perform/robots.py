"""Does the cells of an experiment on a robot.

This is a new simulated robot for each cell, or a real one, which tries a cell again if something
disturbs it.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from host.client.robot import Robot, connect
from host.errors import LeaseLost, NoLink, NotDone, RobotFault
from host.kicking.outcome import require_control
from host.kicking.robot_claims import PAPER
from host.link.addresses import SIM, sim_options
from host.link.robots_file import Known
from host.logs.log import Log
from host.logs.mcap_files import McapTap
from host.runs.contract import Cell, Experiment, Row, Setting
from host.runs.folder import digest
from host.runs.runner import Outcome, Work
from host.util.installation import deploy_command
from host.util.whole_files import write_text
from robot.sources import of_robot

# How often a real robot tries a cell if a fault or a stop disturbs it, and the wait between tries.
TRIES = 3
PAUSE_S = 1.0


@contextmanager
def robots(
    experiment: Experiment,
    chosen: Known,
    setting: Setting,
    token: str | None,
    logs: Path,
    say: Callable[[str], None],
    *,
    take_over: bool = False,
) -> Iterator[Work]:
    """Yields a function that does a cell on a robot, and stops a real robot in the end.

    Raises:
        NoLink: The robot cannot be reached.
        NotDone: The robot runs other code than this host, or another one began the run.
    """
    logs.mkdir(exist_ok=True)
    if sim_options(chosen.address) is None:
        with connect(chosen.name, token=token) as robot:
            robot.on_trouble = say
            _require_same_sources(robot)
            _require_same_robot(robot, logs.parent / "robot.json")
            if take_over:
                robot.take_over()
            require_control(robot)
            own = {name: robot.status()["params"][name] for name in PAPER}
            try:
                yield lambda cell: _try_often(experiment, cell, robot, setting, logs, say)
            except NoLink:
                # The error that ended the run says more than one of a stop that nobody hears.
                with suppress(NoLink):
                    robot.stop()
                raise
            except LeaseLost:
                raise  # who drives it now decides what it does
            except BaseException:
                _leave(robot, own)
                raise
            _leave(robot, own)
        return

    def simulate(cell: Cell) -> Outcome:
        world = {**setting.preset.scene, **experiment.world(cell)}
        with connect(_in_world(chosen.address, world), setting.seed_of(cell)) as robot:
            return _trial(experiment, cell, robot, setting, logs), []

    yield simulate


def _require_same_sources(robot: Robot) -> None:
    """Raise NotDone if a real robot runs other code than this host.

    Its results would be kept as if the code of this host had measured them. Robots of an older
    release do not say what they run.
    """
    if robot.hello.get("sources", ours := of_robot()) != ours:
        raise NotDone(
            "the robot runs other sources than this host, so its results would not be this code's",
            f"bring this release to the robot: {deploy_command()}",
        )


def _require_same_robot(robot: Robot, kept: Path) -> None:
    """Raise NotDone if another robot than this has begun the run: an address may pass to another.

    Args:
        robot: The robot.
        kept: A file that says which robot began the run. It is written if it does not exist.
    """
    this = {name: robot.hello.get(name, "") for name in ("hardware_id", "motor")}
    if not kept.exists():
        write_text(kept, json.dumps(this, allow_nan=False) + "\n")
    elif json.loads(kept.read_text(encoding="utf-8")) != this:
        raise NotDone(
            f"another robot began this run, or this one with other motors, as {kept} says",
            "connect the robot from before, or begin a new run: name another folder with --out",
        )


def _leave(robot: Robot, own: dict[str, Any]) -> None:
    """Stop a real robot, and give its own parameters back to it."""
    robot.stop()
    _set(robot, own)


def _in_world(uri: str, world: dict[str, str]) -> str:
    options = {**(sim_options(uri) or {}), **world}
    return SIM + ("?" + urlencode(options) if options else "")


def _trial(
    experiment: Experiment, cell: Cell, robot: Robot, setting: Setting, logs: Path
) -> list[Row]:
    """Try a cell once. The log of the try replaces that of an earlier one."""
    path = logs / f"{digest(cell)}.mcap"
    path.unlink(missing_ok=True)
    # Every trial begins with the paper's parameters; a real robot gets its own back in the end.
    _set(robot, {**PAPER, **setting.at(cell).own_params()})
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
            "the robot's program restarted meanwhile, or records were lost",
            f"look at its log: {deploy_command()} --logs",
        )
    return rows


def _set(robot: Robot, wanted: dict[str, Any]) -> None:
    """Set those parameters that are not as wanted yet."""
    params = robot.status()["params"]
    changes = {name: value for name, value in wanted.items() if params[name] != value}
    if changes:
        robot.set(**changes)


def _try_often(
    experiment: Experiment,
    cell: Cell,
    robot: Robot,
    setting: Setting,
    logs: Path,
    say: Callable[[str], None],
) -> Outcome:
    """Do a cell on a real robot.

    A try that a fault or a stop disturbs does not count. The reasons are kept.
    """
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
                error.message,
                error.hint or "mend the link, and run the same command again: it resumes the run",
            ) from error
