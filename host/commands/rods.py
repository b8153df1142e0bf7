"""kickctl rods."""

import argparse
from pathlib import Path

from host.commands._options import add_take_over
from host.commands._outputs import add_force, answer_beside, require_place
from host.commands._recording import recorded
from host.commands._terminal import robot_of
from host.util.paths import path_argument

HELP = "a film of a wheel's transmission rods, slowed down, while a kick reverses it"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Where the film goes, and whether to take control from another host."""
    parser.add_argument(
        "--out",
        type=path_argument,
        default=Path("rods.mp4"),
        metavar="FILE",
        help="where the film goes, .mp4 or .gif (default %(default)s)",
    )
    add_force(parser)
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Kick the robot, keep the log, and draw the left wheel around the kick.

    Raises:
        NotDone: The robot did not reverse.
    """
    from host.errors import NotDone
    from host.figures.robot.rods import SIZE, pictures
    from host.films.movie import FPS, Movie
    from host.films.rod_course import SLOWER, WINDOW_S, course
    from host.kicking.outcome import (
        OTHER_PARAMETERS,
        UNSETTLED,
        describe,
        kick_and_watch,
        require_control,
        require_done,
        require_running,
        wait_settled,
    )
    from host.util.progress import progress
    from robot.kicks import PHASE

    require_place(options, options.out)
    with Movie(options.out, SIZE, new=not options.force) as movie:
        with robot_of(options, moves=True, sends="kick") as robot:
            require_running(robot)
            require_control(robot)
            with recorded(robot, "rods") as recording:
                log = recording.log
                if not wait_settled(robot):
                    raise NotDone(f"{UNSETTLED}, so there is no kick to film", OTHER_PARAMETERS)
                outcome = kick_and_watch(robot, log, PHASE)
                kick_s = log.records[log.kicks()[0][0]].t_s
                recorded_s = log.records[-1].t_s - kick_s
                robot.wait(max(0.0, WINDOW_S[1] - recorded_s + 0.1))
        shown = course(log, "left", WINDOW_S, 1 / (FPS * SLOWER))
        with progress("drawing", len(shown.t_s)) as advance:
            for picture in pictures(shown, SLOWER):
                movie.add(picture)
                advance(movie.pictures)
    result = {**outcome.as_dict(), "log": str(recording.path), "film": str(options.out)}
    words = f"{describe(outcome)}\nlog {recording.path}\nfilm {options.out}"
    answer_beside(options, options.out, result, words)
    recording.require_whole()
    require_done(outcome)
    return 0
