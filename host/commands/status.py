"""kickctl status."""

import argparse

from host.commands._terminal import robot_of, show

HELP = "show what the robot does, who controls it, and how punctual its ticks are"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add nothing: it has no arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Print the status. Returns 5 if the robot is in fault."""
    with robot_of(options) as robot:
        status = dict(
            robot.status(),
            brick=robot.link.uri,
            seed=robot.hello["seed"],
            software=robot.hello["software"],
        )
    if options.json:
        show(status)
    else:
        battery = "unknown" if status["battery_v"] is None else f"{status['battery_v']:.2f} V"
        print(f"{status['brick']}: {status['state']} ({status['reason']}), tick {status['tick']}")
        print(f"battery {battery}; controlled by {status['controller'] or 'nobody'}")
        print(
            f"ticks: {status['missed']} missed, {status['overruns']} overrun, {status['clamped']}"
            " delta t clamped; how late they began:"
        )
        edges, counts = status["lateness"]["edges_s"], status["lateness"]["counts"]
        for edge, count in zip([*edges, None], counts, strict=True):
            if count:
                print(f"  {'more' if edge is None else f'<= {1000 * edge:g} ms'}: {count}")
    return 5 if status["state"] == "fault" else 0
