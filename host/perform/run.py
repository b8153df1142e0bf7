"""Runs an experiment or a study of the model, or resumes an interrupted run.

Then it writes the table, the figure and the claims.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from host.errors import NotDone, WrongUse
from host.experiments.efforts import EFFORTS, in_words
from host.link.addresses import SIM, make_link, sim_options
from host.link.names import chosen, own_token
from host.link.robots_file import Known
from host.perform.catalogue import BODY, STUDY, find
from host.perform.drawings import USUAL, drawing, files
from host.perform.sweep import FAILURES, Sweep, forgiving
from host.runs.cluster import require_scheduler
from host.runs.columns import kinds_of
from host.runs.contract import Cell, Setting
from host.runs.registry import complete_options
from host.runs.results import Results
from host.runs.runner import Outcome, Work, do_cells, finish, open_study, simulate
from host.runs.sweep import axes, in_all, points
from host.util.arguments import need_function, need_path, need_seed, need_text
from host.util.extras import need
from host.util.provenance import commit, require_unchanged, sources
from robot import __version__
from sim_motor.constants import load

RESULTS = Path("results")
DEFAULT_SEED = 1
# The options of sim:// that an experiment leaves to its user.
OWN_OPTIONS = ("motor", "battery", "seed", "idle")


def perform(
    name: str,
    uri: str | None = None,
    seed: int | None = None,
    *,
    token: str | None = None,
    out: str | Path = RESULTS,
    scheduler: str | None = None,
    take_over: bool = False,
    formats: str | Sequence[str] = USUAL,
    panel: str | None = None,
    say: Callable[[str], None] = lambda words: None,
    ask: Callable[[float], None] = lambda seconds: None,
    **arguments: Any,
) -> Results:
    """Run an experiment or a study of the model, or resume it if it was interrupted.

    >>> study = run_experiment("hopf", tau=0.3, formats="svg")
    >>> study
    hopf, in results/theory/hopf-...
      Hopf bifurcation at k          1.3627461
      the paper's estimate of k      0.833333333
      wheels swing with              0.42285036 Hz
      cycles are born                stable
      first Lyapunov coefficient l1  -0.0529995371
      l1 changes its sign at tau     1.43435325 s
      table point: 1 rows
      table line: 102 rows
    >>> round(float(study.tables["line"]["k_hopf"].min()), 3)
    0.017

    Args:
        name: Its name, as in `kickctl experiment NAME` or `kickctl theory NAME`.
        uri: The robot's name or address, as `connect` takes it. A study has no robot.
        seed: The random seed, also of a simulated robot; by default 1.
        token: The path of the robot's token file.
        out: The folder for results. Each combination of arguments and sources has its own folder
            there.
        scheduler: The address of a Dask scheduler that computes the cells.
        take_over: Take control of a real robot, also from another host, which hears of it.
        formats: The formats of the figure: png, svg and pdf.
        panel: The one panel of the figure to draw; None for all.
        say: Called with messages for people.
        ask: Called before a real robot begins, with about how long it will be busy, s. It raises a
            KickctlError if that is too long.
        arguments: The run's own options. A list of numbers for one or two of them makes a sweep:
            one run at all of these points.

    Returns:
        The summary, which is also in summary.json in the run's folder; its `tables` are the run's
        tables as arrays.

    Raises:
        KickctlError: The run ended early. The cells that are complete are kept.
    """
    found = find(need_text("name", name, "the name of an experiment or study"))
    require_unchanged()
    seed, out = need_seed(seed), Path(need_path("out", out))
    token = None if token is None else need_path("token", token)
    if scheduler is not None:
        need_text("scheduler", scheduler, "the address of a Dask scheduler, as text")
    need_function("say", say, "a function that takes a text")
    options = complete_options(name, found.entry, arguments)
    swept = axes(found.entry, options)
    sweep = Sweep(name, swept) if swept else None
    experiment = sweep or found.work
    settings: dict[str, Any] = {
        "experiment": name,
        "options": options,
        "version": __version__,
        "sources": sources(),
    }
    robot, simulated = _robot_of(name, found.kind, uri)
    if robot is None:
        out = out / "theory"
        setting = Setting(DEFAULT_SEED if seed is None else seed, options)
    else:
        token = own_token(robot) if token is None else token
        setting = setting_of(options, simulated, seed)
        # The motor by value: your own one of this name may have other constants tomorrow.
        motor = {} if simulated is None else {"motor": asdict(setting.constants)}
        settings |= {"brick": robot.address, **motor}
    settings["seed"] = setting.seed
    batch = simulated is not None and experiment.simulate is not None
    if scheduler:
        _require_cluster(scheduler, batch=batch)
    cells = (sweep or found).cells(options, batch=batch)
    wanted = files("host.figures.sweep" if swept else found.figures, formats, panel, options)
    if swept:
        say(f"{name}: {len(points(swept))} points, {in_all(swept)}")
    with open_study(out, settings, cells, say) as study:
        if batch and experiment.simulate is not None:
            simulate(
                name,
                experiment.simulate,
                cells,
                setting,
                study,
                scheduler,
                parts=(sweep or found).parts,
                processes=found.kind == BODY,
            )
        elif robot is not None and (missing := sum(cell not in study for cell in cells)):
            if simulated is None and name in EFFORTS:
                whole_s = sum(EFFORTS[name].seconds({**options, **at}) for at in points(swept))
                busy_s = whole_s * missing / len(cells)
                say(f"{name}: about {in_words(busy_s)} on this robot")
                ask(busy_s)
            from host.perform.robots import robots  # with all that writes logs

            # On a real robot somebody may have stepped in: a cell that fails ends a sweep, too.
            failures = () if simulated is None else FAILURES
            with robots(
                experiment, robot, setting, token, study.folder / "logs", say, take_over=take_over
            ) as work:
                attempt = work if sweep is None else forgiving(work, failures)
                do_cells(name, cells, study, _with_motor_of(setting, attempt))
        rows = study.rows(cells)
        # The commit says where results come from. It is no part of their key: it also changes with
        # files that compute nothing.
        about = {**settings, "commit": commit()}
        draw = drawing(wanted, found, setting, settings)
        if sweep is None:
            findings, kinds = found.work.report(rows, setting), kinds_of(found.work)
            return finish(name, rows, findings, draw, study, about, kinds)
        table = sweep.table(rows, setting)
        return finish("sweep", table, sweep.report(table, setting), draw, study, about, sweep.kinds)


def _with_motor_of(setting: Setting, work: Work) -> Work:
    """The same work, but only while the user's own motor is that of the setting.

    Each simulated robot looks it up by its name, and its file may be written meanwhile.
    """

    def attempt(cell: Cell) -> Outcome:
        try:
            same = load(setting.motor) == setting.constants
        except ValueError:
            same = False
        if not same:
            raise NotDone(
                f"the motor '{setting.motor}' has changed since this run began",
                "run the same command again: with the changed motor it is a run of its own",
            )
        return work(cell)

    return attempt


def _require_cluster(scheduler: str, *, batch: bool) -> None:
    """Raise WrongUse, before the run has a folder, if no cluster can compute it."""
    if not batch:
        raise WrongUse(
            "--scheduler is for simulations, and this experiment runs on a robot", "leave it out"
        )
    require_scheduler(scheduler)


def _robot_of(name: str, kind: str, uri: str | None) -> tuple[Known | None, dict[str, str] | None]:
    """The robot of an experiment, and the options in its address as `_simulated` returns them.

    A study has no robot, and none of these.
    """
    if kind == STUDY:
        return None, {}
    robot = chosen(uri)
    return robot, _simulated(name, kind, robot.address)


def _simulated(name: str, kind: str, uri: str) -> dict[str, str] | None:
    """The options in the address of a simulated robot; None for a real one.

    Raises WrongUse if the experiment cannot use it.
    """
    make_link(uri)  # raises WrongUse if that is not the address of a robot
    simulated = sim_options(uri)
    if kind == BODY:
        need("mujoco", "bodies")
        if simulated is None:
            raise WrongUse(
                f"{name} is about simulated cars, and '{uri}' is a robot's address",
                f"leave the address out, or write {SIM}",
            )
    for option in simulated or ():
        if option not in OWN_OPTIONS:
            raise WrongUse(
                f"an experiment places its robots itself, and '{uri}' says {option}",
                f"leave {option} out",
            )
    return simulated


def setting_of(
    options: dict[str, Any], simulated: dict[str, str] | None, seed: int | None
) -> Setting:
    """The setting of a run on a robot.

    Args:
        options: The run's own options.
        simulated: The options in the address of a simulated robot; None for a real one.
        seed: The random seed; None for that of the address, or the default.
    """
    if seed is None:
        seed = int((simulated or {}).get("seed", DEFAULT_SEED))
    if simulated is None:
        return Setting(seed, options)
    battery_v = float(simulated["battery"]) if "battery" in simulated else None
    return Setting(seed, options, simulated.get("motor", Setting.motor), battery_v)
