"""kickctl log plot|film."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from host.commands._log_damage import damage_facts, damage_status
from host.commands._outputs import add_force, answer_beside, require_place
from host.errors import NotDone, WrongUse
from host.util.numbers import Number
from host.util.paths import path_argument

if TYPE_CHECKING:
    from host.logs.curves import Curves
    from host.logs.mcap_reading import LogFile

# The longest film that is made unasked (s): two minutes of 960 by 540 pixels.
LONGEST_FILM_S = 120.0
PICTURES = (".png", ".svg", ".pdf")


def add_arguments(plot: argparse.ArgumentParser, film: argparse.ArgumentParser) -> None:
    """Add the arguments of both actions."""
    plot.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the figure, .png, .svg or .pdf (default: NAME-plot.png beside the log)",
    )
    film.add_argument(
        "--out",
        type=path_argument,
        metavar="FILE",
        help="the film, .mp4 or .gif (default: NAME-film.mp4 beside the log)",
    )
    film.add_argument(
        "--begin",
        type=Number("s", 0.0, 1e6),
        default=0.0,
        metavar="S",
        help="when the film begins, s since the log began (default %(default)g)",
    )
    film.add_argument(
        "--seconds",
        type=Number("s", 0.01, 1e6),
        metavar="S",
        help="how much to film, s (default: to the log's end)",
    )
    film.add_argument(
        "--slower",
        type=Number("times", 0.01, 1e6),
        default=1.0,
        metavar="N",
        help="how many times slower than life (default %(default)g)",
    )
    for parser in (plot, film):
        add_force(parser)


def plot(options: argparse.Namespace) -> int:
    """Draw the log."""
    from host.logs.mcap_reading import LogFile

    out = options.out or _beside(options.log, "-plot.png")
    if out.suffix.lower() not in PICTURES:
        raise WrongUse(
            f"a figure cannot be written as '{out.name}'", f"end its name with {_or(PICTURES)}"
        )
    require_place(options, out)
    log = LogFile(options.log)
    curves = _read(log)
    from host.figures.caption import of_log
    from host.figures.robot.log import draw
    from host.figures.style import save

    title = f"{options.log.name}: {len(curves.t_s)} ticks, {log.info.get('brick', '')}"
    caption = of_log(curves.params, log.info, f"kickctl log plot {options.log.name}")
    save(draw(curves, title), out, caption, new=not options.force)
    facts = {
        "figure": str(out),
        "ticks": len(curves.t_s),
        "kicks": len(curves.kicks),
        "stops": len(curves.stops),
        **damage_facts(log),
    }
    answer_beside(options, out, facts, f"figure {out}")
    return damage_status(log)


def film(options: argparse.Namespace) -> int:
    """Film the log."""
    from host.films.log_course import frames, times
    from host.films.movie import FPS, Movie
    from host.logs.mcap_reading import LogFile
    from host.util.progress import progress

    out = require_place(options, options.out or _beside(options.log, "-film.mp4"))
    log = LogFile(options.log)
    curves = _read(log)
    t_s = times(curves, options.begin, options.seconds, 1 / (FPS * options.slower))
    if options.seconds is None and len(t_s) / FPS > LONGEST_FILM_S:
        raise WrongUse(
            f"the film would last {len(t_s) / FPS / 60:.0f} minutes",
            "choose a part with --begin S --seconds S; with --seconds it may be as long as you say",
        )
    from host.figures.robot.log_film import SIZE, pictures

    with Movie(out, SIZE, new=not options.force) as movie, progress("drawing", len(t_s)) as advance:
        for picture in pictures(frames(curves, t_s), options.slower):
            movie.add(picture)
            advance(movie.pictures)
    facts = {"film": str(out), "seconds": len(t_s) / FPS, **damage_facts(log)}
    answer_beside(options, out, facts, f"film {out}, {len(t_s) / FPS:.1f} s")
    return damage_status(log)


def _read(log: LogFile) -> Curves:
    from host.logs.curves import curves

    found = curves(log.stream())
    if not len(found.t_s):
        raise NotDone(f"{log.path} holds no ticks", "record for longer: kickctl record 10")
    return found


def _beside(log: Path, ending: str) -> Path:
    return log.with_name(log.stem + ending)


def _or(words: tuple[str, ...]) -> str:
    return ", ".join(words[:-1]) + " or " + words[-1]
