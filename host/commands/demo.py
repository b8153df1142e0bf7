"""kickctl demo."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from host.commands._options import add_take_over
from host.commands._recording import conclude, recorded
from host.commands._terminal import contradiction, robot_of, say

if TYPE_CHECKING:
    from host.client.robot import Robot

HELP = (
    "start, roll, and reverse the robot by a kick, and measure some of the paper's claims on the"
    " way"
)

STARTS = 10
INVERSIONS = 50


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add whether to take control from another host."""
    add_take_over(parser)


@contextmanager
def _driven(options: argparse.Namespace) -> Iterator[Robot]:
    """The robot, driven from here: who cannot drive it gets no log of a demo."""
    from host.kicking.outcome import require_control
    from host.kicking.robot_motor import motor_of

    with robot_of(options, moves=True, sends="kick") as robot:
        require_control(robot)
        motor_of(robot)
        yield robot


def run(options: argparse.Namespace) -> int:
    """Do it all and write one log.

    Raises NotDone if the kick did not reverse the robot or a claim does not hold.
    """
    from host.kicking import manoeuvres as showing
    from host.kicking import robot_claims as claims
    from host.kicking.outcome import describe, kick_and_watch, require_done, title
    from host.kicking.primitives import drive
    from host.link.addresses import sim_options
    from host.logs.log import Log
    from host.perform.run import setting_of
    from host.util.progress import progress

    with (
        _driven(options) as robot,
        recorded(robot, "demo") as recording,
        progress("demo", 4) as advance,
    ):
        log = recording.log
        setting = setting_of(robot.status()["params"], sim_options(robot.link.uri), options.seed)
        say("driving forward ...")
        if robot.status()["state"] != "running":
            robot.start()
        drive(robot, log, "forward")
        rolling = showing.steady(robot, log)
        outcome = kick_and_watch(robot, log, "phase", ticks=4)
        until_then = Log(log.info)
        log.play(until_then)
        advance(1)
        say(f"starting {STARTS} times from random potentials ...")
        starts = showing.starts(robot, log, STARTS)
        advance(2)
        say(f"inverting the membrane potentials {INVERSIONS} times ...")
        inversions = [kick_and_watch(robot, log, "membrane").reversed for _ in range(INVERSIONS)]
        advance(3)
        say("raising the torque slowly on a robot at rest ...")
        ramp = showing.ramp(robot, log)
        advance(4)
        brick, seed = robot.link.uri, robot.hello["seed"]
    started = [wheel for span in starts for wheel in claims.steady(log, span)]
    measured = [
        claims.coexistence(started),
        *claims.locomotion(claims.steady(log, rolling)),
        claims.break_away(log, ramp),
        claims.inversions(inversions),
    ]
    foreign = setting.elsewhere(**claims.PAPER)
    report = [claim.doubted(foreign) for claim in measured]
    failed = [claim.id for claim in report if claim.holds is False]

    def draw(path: Path) -> Path:
        from host.figures.robot.kick import KICK_WINDOW_S, draw

        return draw(until_then, path, title(outcome), KICK_WINDOW_S, outcome.applied_tick)

    result = {
        **outcome.as_dict(),
        "brick": brick,
        "seed": seed,
        "claims": [claim.as_dict() for claim in report],
    }
    sentences = [*(claim.sentence() for claim in report), describe(outcome)]
    conclude(options, result, "\n".join(sentences), recording, draw)
    if failed:
        raise contradiction(failed)
    require_done(outcome)
    return 0
