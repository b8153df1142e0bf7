"""Runs an experiment: cell after cell on the robot that is there, or in the compiled batch for a simulated one; then what came of it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from host.bodies import need
from host.client import Robot, connect
from host.entries import checked
from host.errors import NoLink, NotDone, RobotFault, WrongUse
from host.experiments.experiment import Cell, Experiment, Row, Setting
from host.experiments.study import digest
from host.experiments.table import BODIES, TABLE, load
from host.experiments.work import Outcome, Work, begun, do, finish, simulate
from host.links import SIM, make_link, sim_options
from host.log import Log
from host.origin import commit
from host.recording import McapTap
from robot import __version__
from robot.params import TABLE as TABLE_OF_PARAMETERS
from sim_motor.motor import load as constants

RESULTS = Path("results")
DEFAULT_SEED = 1
# A robot's cell is tried again when something else came between, a fault or a link that broke.
TRIES = 3
PAUSE_S = 1.0
# The paper's parameters, with which every trial begins, whatever a robot was set to; it gets its own back in the end.
PAPER = {name: TABLE_OF_PARAMETERS[name].default for name in ("a", "tau_s", "k", "tick_s", "rods", "max_duty_pct")}
# What of sim:// an experiment leaves to its user.
OWN_OPTIONS = ("motor", "battery", "seed", "idle")


def perform(
    name: str,
    uri: str | None = None,
    seed: int | None = None,
    *,
    token: str | None = None,
    out: str | Path = RESULTS,
    scheduler: str | None = None,
    say: Callable[[str], None] = lambda words: None,
    **arguments: float,
) -> dict[str, Any]:
    """Run an experiment, or the rest of one that was cut short, and return its summary, which also stands in its folder.

    uri, token: as `connect` takes them; seed: of all chances, also those of a simulated robot. out: below which folder; what belongs to
    exactly these arguments has one of its own there. scheduler: address of a Dask scheduler for the compiled batch. arguments: the
    experiment's own options. Raises KickctlError; what was measured until then is kept.
    """
    options = checked("experiment", TABLE, name, arguments)
    experiment = load(name)
    uri = address(uri)
    make_link(uri)  # raises, in words, if that is no robot's address
    simulated = sim_options(uri)
    if name in BODIES:
        need("mujoco", "bodies")
        if simulated is None:
            raise WrongUse(f"{name} is about simulated cars, and '{uri}' is a robot's address", f"leave it out, or say {SIM}")
    for option in simulated or ():
        if option not in OWN_OPTIONS:
            raise WrongUse(f"an experiment places its robots itself, and '{uri}' says {option}", "leave that out")
    if seed is None:
        seed = int((simulated or {}).get("seed", DEFAULT_SEED))
    batch = simulated is not None and experiment.simulate is not None
    if scheduler and not batch:
        raise WrongUse("--scheduler spreads simulations, and this experiment runs on a robot's loop", "leave it out")
    setting = Setting(seed, options)
    if simulated is not None:
        battery_v = float(simulated["battery"]) if "battery" in simulated else None
        setting = Setting(seed, options, simulated.get("motor", setting.motor), battery_v)
    settings = {"experiment": name, "brick": uri, "seed": seed, "options": options, "version": __version__, "commit": commit()}
    if simulated is not None:
        settings["motor"] = asdict(constants(setting.motor))  # an own motor of the same name may be another one tomorrow
    cells = experiment.cells(options, batch=batch)
    with begun(Path(out), settings, cells, say) as study:
        if experiment.simulate and batch:
            simulate(name, experiment.simulate, cells, setting, study, scheduler, processes=name in BODIES)
        elif any(cell not in study for cell in cells):
            with _robots(experiment, uri, setting, token, study.folder / "logs", say) as work:
                do(name, cells, study, work)
        rows = study.rows(cells)
        return finish(name, rows, experiment.report(rows, setting), study, settings)


def address(uri: str | None) -> str:
    """The robot's address: the one given, else $KICK_BRICK, else the simulated robot's."""
    return uri or os.environ.get("KICK_BRICK") or SIM


@contextmanager
def _robots(
    experiment: Experiment, uri: str, setting: Setting, token: str | None, logs: Path, say: Callable[[str], None]
) -> Iterator[Work]:
    """Yields what does a cell on a robot: a simulated one of its own for each, or the one that there is, which is stopped in the end."""
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


def _trial(experiment: Experiment, cell: Cell, robot: Robot, setting: Setting, logs: Path) -> list[Row]:
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
        raise NotDone("the robot's program began anew meanwhile, or records were lost", "look at its log: ./deploy.sh --logs")
    return rows


def _set(robot: Robot, wanted: dict[str, Any]) -> None:
    """Set those parameters that are not as wanted."""
    params = robot.status()["params"]
    changes = {name: value for name, value in wanted.items() if params[name] != value}
    if changes:
        robot.set(**changes)


def _patient(experiment: Experiment, cell: Cell, robot: Robot, setting: Setting, logs: Path, say: Callable[[str], None]) -> Outcome:
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
            raise NoLink(error.message, error.hint or "mend the link, and run the same command again") from error
