"""Runs an experiment or a study of the model, or the rest of one that was cut short.

Then its table, its figure and its claims.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from host.errors import WrongUse
from host.link.addresses import SIM, make_link, sim_options
from host.perform.catalogue import BODY, STUDY, find
from host.perform.robots import robots
from host.runs.contract import Setting
from host.runs.registry import checked
from host.runs.runner import begun, do, finish, simulate
from host.util.extras import need
from host.util.provenance import commit
from robot import __version__
from sim_motor.motor import load as constants

RESULTS = Path("results")
DEFAULT_SEED = 1
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
    **arguments: Any,
) -> dict[str, Any]:
    """Run an experiment or a study of the model, or resume one that was cut short.

    Args:
        name: Its name, as in `kickctl experiment NAME` or `kickctl theory NAME`.
        uri: The robot's address, as `connect` takes it; a study has no robot.
        seed: Fixes all chances, also those of a simulated robot.
        token: The path of the token file, as `connect` takes it.
        out: The folder for results; each set of arguments has a folder of its own there.
        scheduler: The address of a Dask scheduler that spreads simulations.
        say: Called with words for people.
        arguments: The run's own options.

    Returns:
        The summary, which is also a file in the run's folder: claims, numbers, files.

    Raises:
        KickctlError: It cannot go on; what was measured until then is kept.
    """
    found = find(name)
    options = checked(name, found.entry, arguments)
    settings: dict[str, Any] = {
        "experiment": name,
        "options": options,
        "version": __version__,
        "commit": commit(),
    }
    simulated: dict[str, str] | None = {}
    out = Path(out)
    if found.kind == STUDY:
        out = out / "theory"
        setting = Setting(DEFAULT_SEED if seed is None else seed, options)
    else:
        uri = address(uri)
        simulated = _simulated(name, found.kind, uri)
        setting = _setting(options, simulated, seed)
        settings["brick"] = uri
        if simulated is not None:
            settings["motor"] = asdict(
                constants(setting.motor)
            )  # an own motor of the same name may be another one tomorrow
    settings["seed"] = setting.seed
    batch = simulated is not None and found.work.simulate is not None
    if scheduler and not batch:
        raise WrongUse(
            "--scheduler spreads simulations, and this experiment runs on a robot's loop",
            "leave it out",
        )
    cells = found.work.cells(options, batch=batch)
    with begun(out, settings, cells, say) as study:
        if batch and found.work.simulate is not None:
            simulate(
                name,
                found.work.simulate,
                cells,
                setting,
                study,
                scheduler,
                processes=found.kind == BODY,
            )
        elif uri is not None and any(cell not in study for cell in cells):
            with robots(found.work, uri, setting, token, study.folder / "logs", say) as work:
                do(name, cells, study, work)
        rows = study.rows(cells)
        return finish(name, rows, found.work.report(rows, setting), found.draw, study, settings)


def address(uri: str | None) -> str:
    """The robot's address: the one given, else $KICK_BRICK, else the simulated robot's."""
    return uri or os.environ.get("KICK_BRICK") or SIM


def _simulated(name: str, kind: str, uri: str) -> dict[str, str] | None:
    """The options of a simulated robot's address, None for a real one's.

    Raises WrongUse if the experiment cannot use it.
    """
    make_link(uri)  # raises, in words, if that is no robot's address
    simulated = sim_options(uri)
    if kind == BODY:
        need("mujoco", "bodies")
        if simulated is None:
            raise WrongUse(
                f"{name} is about simulated cars, and '{uri}' is a robot's address",
                f"leave it out, or say {SIM}",
            )
    for option in simulated or ():
        if option not in OWN_OPTIONS:
            raise WrongUse(
                f"an experiment places its robots itself, and '{uri}' says {option}",
                "leave that out",
            )
    return simulated


def _setting(
    options: dict[str, Any], simulated: dict[str, str] | None, seed: int | None
) -> Setting:
    if seed is None:
        seed = int((simulated or {}).get("seed", DEFAULT_SEED))
    if simulated is None:
        return Setting(seed, options)
    battery_v = float(simulated["battery"]) if "battery" in simulated else None
    return Setting(seed, options, simulated.get("motor", Setting.motor), battery_v)
