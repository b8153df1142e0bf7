"""kickctl demo."""

import argparse

from host.commands._terminal import recorded, robot_of, say, show

HELP = (
    "start, roll, and reverse the robot by a kick, and measure some of the paper's claims on the"
    " way"
)

STARTS = 10
INVERSIONS = 50


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The demo has no arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Do it all and write one log.

    Returns 1 if the kick did not reverse the robot or a claim does not hold.
    """
    from host.figures.robot.kick import KICK_WINDOW_S, draw
    from host.kicking import manoeuvres as showing
    from host.kicking import robot_claims as claims
    from host.kicking.outcome import describe, kick_and_watch, title
    from host.kicking.primitives import drive
    from host.link.addresses import sim_options
    from host.perform.run import setting_of
    from host.util.progress import progress

    with (
        robot_of(options, moves=True) as robot,
        recorded(robot, "demo") as (log, path),
        progress("demo", 4) as advance,
    ):
        setting = setting_of(robot.status()["params"], sim_options(robot.link.uri), options.seed)
        say("driving forward ...")
        if robot.status()["state"] != "running":
            robot.start()
        drive(robot, log, "forward")
        rolling = showing.steady(robot, log)
        outcome = kick_and_watch(robot, log, "phase", ticks=4)
        figure = draw(
            log, path.with_suffix(".png"), title(outcome), KICK_WINDOW_S, outcome.applied_tick
        )
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
    failed = not outcome.reversed or any(claim.holds is False for claim in report)
    if options.json:
        show(
            {
                **outcome.as_dict(),
                "brick": brick,
                "seed": seed,
                "log": str(path),
                "figure": str(figure),
                "claims": [claim.as_dict() for claim in report],
            }
        )
    else:
        for claim in report:
            print(claim.sentence())
        print(f"{describe(outcome)}\nlog {path}\nfigure {figure}")
    return 1 if failed else 0
