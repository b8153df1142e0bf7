"""kickctl status."""

import argparse
from typing import Any

from host.commands._rest import explain_rest
from host.commands._terminal import robot_of, show
from host.errors import printable
from robot.words import duration, person

WITHOUT_PRIORITY = (
    "without real-time priority: other programs on the robot may delay its ticks. A brick gives it"
    " to a service (kickctl deploy --service), and another machine to root"
)
HELP = "show what the robot does, who controls it, and how punctual its ticks are"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add nothing: it has no arguments of its own."""


def run(options: argparse.Namespace) -> int:
    """Print the status. Raises RobotFault if the robot is in fault."""
    from host.kicking.outcome import require_no_fault

    with robot_of(options) as robot:
        status = dict(
            robot.status(),
            brick=robot.link.uri,
            seed=robot.hello["seed"],
            software=robot.hello["software"],
        )
        # An embedded robot has just begun, and a program that reads JSON shall not wait.
        known = options.json or robot.link.virtual or status["state"] != "running"
        rest = [] if known else explain_rest(robot, status["params"]["k"])
    if options.json:
        show(status)
    else:
        print(f"{status['brick']}: {status['state']} ({status['reason']}), tick {status['tick']}")
        print(_battery_and_driver(status))
        if status.get("real_time") is False:
            print(WITHOUT_PRIORITY)
        for line in rest:
            print(line)
        edges, counts = status["lateness"]["edges_s"], status["lateness"]["counts"]
        print(
            f"of {sum(counts) + status['missed']} ticks {status['missed']} were missed,"
            f" {status['overruns']} took longer than a control period, {status['clamped']} had"
            " their time step limited"
        )
        for least, edge, count in zip([0.0, *edges], [*edges, None], counts, strict=True):
            if count:
                late = f"over {1000 * least:g}" if edge is None else f"at most {1000 * edge:g}"
                print(f"  began {late} ms late: {count}")
    require_no_fault(status)
    return 0


def in_one_line(status: dict[str, Any]) -> str:
    """The main part of a status in words."""
    return f"{status['state']} ({status['reason']}); {_battery_and_driver(status)}"


def _battery_and_driver(status: dict[str, Any]) -> str:
    battery = "unknown" if status["battery_v"] is None else f"{status['battery_v']:.2f} V"
    return f"battery {battery}; {_driver(status)}"


def _driver(status: dict[str, Any]) -> str:
    """Who drives the robot, and for how long. Robots before protocol 1.2 do not say how long."""
    if status["controller"] is None:
        return "driven by nobody"
    driver = f"driven by {person(printable(str(status['controller'])))}"
    held_s = status.get("controller_held_s")
    return driver if held_s is None else f"{driver} for {duration(float(held_s))}"
