"""kickctl body."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from shlex import join
from typing import TYPE_CHECKING, Any, NamedTuple

from host.commands._failures import os_words
from host.commands._outputs import add_force, require_place
from host.commands._recording import figure_words
from host.commands._terminal import print_result, say, show
from host.errors import KickctlError, NotDone, WrongUse, mark_kept
from host.util.numbers import Number
from host.util.paths import path_argument
from host.util.whole_files import write_text

if TYPE_CHECKING:
    from host.bodies.build import BodyRequest
    from host.bodies.keeping import Keeper
    from host.bodies.kicks import ScheduledKick
    from host.figures.caption import Caption
    from sim_motor.bodies.body import Body
    from sim_motor.bodies.measures import Summary

HELP = "simulate a car, or a train of cars, with one rod and one neuron for each wheel, in MuJoCo"
USES = ("seed",)
# MuJoCo needs about 5e-5 s times cars ** 2.5 to build a train, and nothing can interrupt it.
MOST_CARS, MANY_CARS = 200, 60


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The body, where it is, and what to make of it."""
    parser.add_argument("body", choices=("car", "train"), help="one car, or a train")
    parser.add_argument(
        "--cars",
        type=Number("cars", 1, MOST_CARS, whole=True),
        metavar="N",
        help="length of the train, in cars (default 5)",
    )
    parser.add_argument(
        "--scene",
        default="flat",
        metavar="NAME",
        help=(
            "where it is: flat, walls, octagon, slopes, funnel, halfpipe, hills, box, or your own"
            " NAME.xml (default %(default)s)"
        ),
    )
    parser.add_argument(
        "--time",
        type=Number("s", 0.01, 36000.0),
        default=30.0,
        metavar="S",
        help="how long, in s of simulated time (default %(default)s)",
    )
    parser.add_argument(
        "--preset",
        default="paper",
        metavar="NAME",
        help="sizes, masses, drag and controller: paper or snake2019 (default %(default)s)",
    )
    for name, unit, words in (
        ("a", "", "gain of the neurons, without unit"),
        ("k", "N", "spring constant of the rods, N"),
        ("tau", "s", "time constant of the neurons, s"),
        ("drag", "", "viscous drag: of bodies, N s/m (paper), or of wheels, N s/rad (snake2019)"),
        ("angle", "rad", "angle of the scene's slopes, rad"),
        ("torque", "N m", "constant torque of every wheel instead of its controller, N m"),
    ):
        parser.add_argument("--" + name, type=Number(unit), metavar="X", help=words)
    parser.add_argument(
        "--start",
        choices=("pushed", "random"),
        help="wheels: all pushed forward (default of a car), or at random angles (of a train)",
    )
    parser.add_argument(
        "--bouncy", action="store_true", help="walls throw back, as in the authors' program"
    )
    parser.add_argument(
        "--kick",
        action="append",
        default=[],
        metavar="WORDS",
        help=(
            'for example "t=5,mode=membrane,wheel=all"; also seconds, shift, param, value ...; may'
            " be given more than once"
        ),
    )
    parser.add_argument(
        "--film", type=path_argument, metavar="FILE", help="film it, as .mp4 or .gif"
    )
    parser.add_argument(
        "--live", action="store_true", help="watch it in MuJoCo's viewer, in real time"
    )
    parser.add_argument(
        "--model",
        type=path_argument,
        metavar="FILE",
        help="also write the scene with the cars as MJCF, for any viewer",
    )
    parser.add_argument(
        "--out",
        type=path_argument,
        default=Path("results"),
        metavar="FOLDER",
        help="where results go (default %(default)s)",
    )
    add_force(parser)


def run(options: argparse.Namespace) -> int:
    """Simulate, and keep what there is even if it ends early."""
    from host.bodies.build import (
        CARS_OF_A_TRAIN,
        ONE_OF_THEM,
        WITHOUT_CONTROLLER,
        BodyRequest,
        build_body,
        build_scene,
    )
    from host.bodies.keeping import BLOCK
    from host.bodies.kicks import parse_kick
    from host.runs.folder import digest
    from host.util.provenance import commit, sources

    if options.body == "car" and options.cars not in (None, 1):
        raise WrongUse(f"a car is one car, not {options.cars}", "kickctl body train --cars N")
    if options.torque is not None and options.kick:
        raise WrongUse(f"{WITHOUT_CONTROLLER}, so a kick does nothing", ONE_OF_THEM)
    cars = options.cars
    if cars is None:
        cars = 1 if options.body == "car" else CARS_OF_A_TRAIN
    request = BodyRequest(
        cars=cars,
        scene=options.scene,
        preset=options.preset,
        seed=1 if options.seed is None else options.seed,
        a=options.a,
        k=options.k,
        tau=options.tau,
        drag=options.drag,
        angle=options.angle,
        bouncy=options.bouncy,
        torque=options.torque,
        start=options.start,
    )
    if cars > MANY_CARS:
        say(f"building a train of {cars} cars, which takes about {5e-5 * cars**2.5:.0f} s ...")
    scene = build_scene(request)
    body = build_body(request, scene, BLOCK)
    if options.film:
        require_place(options, options.film)
    if options.model:
        if options.model.exists() and _is_scene(options.model, options.scene):
            raise WrongUse(
                f"{options.model} is the scene itself, and would be lost", "choose another name"
            )
        write_text(require_place(options, options.model), scene.to_xml(), new=not options.force)
    kicks = [parse_kick(words, body.wheels) for words in options.kick]
    if any(kick.t_s >= options.time for kick in kicks):
        raise WrongUse(
            f"a kick comes after the {options.time:g} s that are simulated",
            "kick earlier, or give a longer --time",
        )
    settings = {
        **request._asdict(),
        # By value: your own scene of this name may be another one tomorrow.
        "model": digest({"xml": scene.to_xml()}),
        "kicks": options.kick,
        "time_s": options.time,
        "sources": sources(),
        "commit": commit(),
    }
    result = Result(options.out / f"body-{digest(settings)}", request, settings, body, kicks)
    summary, unwritten = _simulate(options, result)
    essentials = f"the results are in {result.folder}"
    if options.json:
        show({**result.as_dict(summary), "unwritten": unwritten}, essentials)
    else:
        print_result("\n".join(_lines(summary, result.folder, unwritten)), essentials)
    for words in unwritten.values():
        say(f"kickctl: {words}")
    if missing := sorted(unwritten.keys() - {"body.png", "body.svg"}):
        raise NotDone(f"not written: {', '.join(missing)}", "make room, and run it again")
    return 0


def _is_scene(path: Path, scene: str) -> bool:
    return Path(scene).exists() and path.samefile(scene)


class Result(NamedTuple):
    """What there is to keep of a body, and where."""

    folder: Path
    request: BodyRequest
    settings: dict[str, Any]
    body: Body
    kicks: list[ScheduledKick]

    def as_dict(self, summary: Summary) -> dict[str, Any]:
        """The settings and the summary as plain data."""
        return {**self.settings, **summary, "folder": str(self.folder)}

    def kept_s(self) -> float:
        """How much simulated time (s) an earlier run has kept in the folder; 0 for none."""
        try:
            return float(json.loads((self.folder / "summary.json").read_text())["time_s"])
        except (OSError, ValueError, KeyError, TypeError):
            return 0.0

    def finish(self, keeper: Keeper) -> tuple[Summary, dict[str, str]]:
        """Write what is left to write, as far as disk and matplotlib allow.

        Returns:
            The summary of the run so far, and why files could not be written, by their names.
        """
        keeper.finish()
        summary = keeper.summary()
        unwritten = {name: os_words(error) for name, error in keeper.failures.items()}
        text = json.dumps(self.as_dict(summary), indent=1, allow_nan=False) + "\n"
        work: dict[str, Callable[[Path], object]] = {
            "summary.json": lambda path: write_text(path, text),
            "body.png": lambda path: self._draw(path, keeper, summary),
            "body.svg": lambda path: self._draw(path, keeper, summary),
        }
        for name, write in work.items():
            try:
                write(self.folder / name)
            except OSError as error:
                unwritten[name] = os_words(error)
            except Exception as error:  # noqa: BLE001 - the body has moved, whatever befalls a picture
                unwritten[name] = figure_words(error)
        return summary, unwritten

    def _draw(self, path: Path, keeper: Keeper, summary: Summary) -> Path:
        from host.figures.bodies.body import draw
        from host.figures.style import save

        kicks_s = [kick.t_s for kick in self.kicks]
        figure = draw(keeper.columns, keeper.rows(), self.request, summary, kicks_s, self.body.data)
        return save(figure, path, self._caption())

    def _caption(self) -> Caption:
        """What the figure says about the run: the body's numbers, and the command."""
        from host.bodies.build import BodyRequest, choose_preset
        from host.figures.caption import Caption, in_words

        own, usual = choose_preset(self.request), BodyRequest()._asdict()
        given = [
            f"--{name}" if value is True else f"--{name}={value}"
            for name, value in self.request._asdict().items()
            if value != usual[name]
        ]
        given += [f"--kick={words}" for words in self.settings["kicks"]]
        kind = "car" if self.request.cars == 1 else "train"
        command = ["kickctl", "body", kind, *given, f"--time={self.settings['time_s']:g}"]
        parameters = in_words({"a": own.a, "tau": own.tau})
        return Caption(f"{parameters}   k = {own.k:g} N   seed {self.request.seed}", join(command))


def _simulate(options: argparse.Namespace, result: Result) -> tuple[Summary, dict[str, str]]:
    """Run the body, and write everything, also if it is interrupted or becomes unstable."""
    from host.bodies.keeping import Keeper
    from host.bodies.kicks import run_with_kicks
    from host.util.progress import progress

    body, folder = result.body, result.folder
    with ExitStack() as stack:
        watchers = [stack.enter_context(watcher) for watcher in _watchers(options, body)]
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WrongUse(
                f"{folder} cannot hold results: {error.strerror}",
                "name a folder with --out that you may write to",
            ) from error
        keeper = Keeper(folder, body, result.settings)
        try:
            advance = stack.enter_context(
                progress(f"{options.body}, simulated seconds", options.time)
            )

            def watch(time_s: float) -> None:
                keeper.note()
                advance(time_s)
                for watcher in watchers:
                    watcher(body.data)

            run_with_kicks(body, options.time, result.kicks, watch)
        except (KickctlError, KeyboardInterrupt) as error:
            if (longer_s := result.kept_s()) > body.time_s:
                keeper.drop()
                say(f"{folder} keeps the {longer_s:g} s of an earlier run")
            else:
                result.finish(keeper)
                say(f"the first {body.time_s:g} s are kept in {folder}")
            mark_kept(error, folder)
            raise
    return result.finish(keeper)


def _watchers(
    options: argparse.Namespace, body: Body
) -> list[AbstractContextManager[Callable[[Any], None]]]:
    """What looks at the body while it runs."""
    watchers: list[AbstractContextManager[Callable[[Any], None]]] = []
    if options.film:
        from host.films.body import Film

        watchers.append(Film(options.film, body.model, body.cars, new=not options.force))
    if options.live:
        from host.films.body import open_viewer

        watchers.append(open_viewer(body.model, body.data))
    return watchers


def _lines(summary: Summary, folder: Path, unwritten: dict[str, str]) -> Iterator[str]:
    """What the body did, and its files, for people."""
    times = ", ".join(f"{time_s:.1f}" for time_s in summary["reversals"])
    yield (
        f"{summary['time_s']:g} s: {summary['mean_speed']:.3f} m/s, order parameter"
        f" {summary['order_parameter']:.3f}"
    )
    yield f"{len(summary['reversals'])} reversals" + (f", at {times} s" if times else "")
    if summary["stuck"]:
        yield (
            "in the end it stays where it is: it rests, turns on the spot, or is held; another"
            " --start, --seed or --kick may move it"
        )
    if summary["flipped"]:
        yield "a car fell over"
    for name in ("body.png", "state.csv", "state.mcap"):
        if name not in unwritten:
            yield str(folder / name)
