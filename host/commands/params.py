"""kickctl params list|get|set|reset."""

import argparse
from typing import Any

from host.client.robot import Robot
from host.commands._options import add_take_over
from host.commands._rest import explain_rest
from host.commands._terminal import print_result, print_table, robot_of, say, show
from host.errors import WrongUse
from host.link.settings import parse_setting
from robot.params import TABLE, accepted

HELP = "the robot's parameters: list, get NAME, set NAME=VALUE ..., reset [NAME ...]"
# They say how the motors are mounted. Other values would turn a wheel the wrong way.
_OF_THE_BODY = ("polarity_left", "polarity_right")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The action and its names."""
    parser.add_argument(
        "action",
        choices=("list", "get", "set", "reset"),
        help="what to do; kickctl params list shows all names with their units and ranges",
    )
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME[=VALUE]",
        help="a parameter, as in get k; for set with its value, as in set k=2.5 tau_s=1",
    )
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """List, get, set or reset. The robot checks changes, and makes all of them or none."""
    if options.action != "reset" and (options.action == "list") == bool(options.names):
        raise WrongUse(
            f"params {options.action} takes {'no names' if options.names else 'at least one name'}",
            "see kickctl params --help",
        )
    changes = dict(map(parse_setting, options.names)) if options.action == "set" else {}
    with robot_of(options, sends="set" if options.action in ("set", "reset") else "") as robot:
        rows = {row["name"]: row for row in robot.describe("params")}
        names = list(changes) or options.names or list(rows)
        for name in names:
            if name not in rows:
                raise WrongUse(f"the robot has no parameter '{name}'", "it has " + ", ".join(rows))
        if options.action == "reset":
            changes = _resets(robot, rows, options.names)
            names = list(changes)
        if changes:
            robot.set(**changes)
            _say_what_follows(options, robot, changes)
        values = robot.status()["params"]
    if options.action == "list":
        table = [
            {"name": name, "value": values[name], **row, **_limits(name, values)}
            for name, row in rows.items()
        ]
        if options.json:
            show({"params": table})
        else:
            _print_table(table)
        return 0
    lines = [f"{name} = {values[name]} {_shown_unit(rows[name])}".rstrip() for name in names]
    essentials = f"the robot has set {', '.join(lines)}" if changes else ""
    if options.json:
        show({name: values[name] for name in names}, essentials)
    elif lines:
        print_result("\n".join(lines), essentials)
    return 0


def _resets(
    robot: Robot, rows: dict[str, dict[str, Any]], names: list[str]
) -> dict[str, float | str]:
    """The defaults of these parameters that have other values now.

    Without names they are those of all parameters but _OF_THE_BODY.
    """
    values = robot.status()["params"]
    if not names:
        names = [name for name in rows if name not in _OF_THE_BODY]
        kept = [name for name in _OF_THE_BODY if values[name] != rows[name]["default"]]
        if kept:
            say(
                f"{' and '.join(kept)} stay as they are: they say how the motors are mounted."
                f" To reset them too: kickctl params reset {' '.join(kept)}"
            )
    changes = {
        name: rows[name]["default"] for name in names if values[name] != rows[name]["default"]
    }
    if not changes:
        say("nothing to reset: these parameters have their defaults already")
    return changes


_ENDS = "the simulated robot ends with this command; the next one begins with its address's values."


def _shown_unit(row: dict[str, Any]) -> str:
    """The unit in a parameter's row; empty for a number without one."""
    return "" if row["unit"] == "1" else str(row["unit"])


def _limits(name: str, values: dict[str, Any]) -> dict[str, float]:
    """Between which numbers the robot takes a parameter now; empty if the table says it."""
    if name not in TABLE or TABLE[name].choices is not None:
        return {}
    least, greatest = accepted(name, values, at_rest=True)
    return {"minimum": least, "maximum": greatest}


def _say_what_follows(
    options: argparse.Namespace, robot: Robot, changes: dict[str, float | str]
) -> None:
    """Say how long changes hold, or what they leave at rest."""
    if robot.link.virtual:
        say(_gone(options.names) if options.action == "set" else _ENDS)
    elif "k" in changes and not options.json:
        _say_what_rests(robot)


def _say_what_rests(robot: Robot) -> None:
    status = robot.status()
    if status["state"] == "running":
        for line in explain_rest(robot, status["params"]["k"]):
            say(line)


def _gone(settings: list[str]) -> str:
    given = " ".join(f"--set {setting}" for setting in settings)
    return (
        "the simulated robot ends with this command, and the new values with it.\n"
        f"  For a simulated robot that begins with them: kickctl {given} kick --mode phase, or"
        f" --brick 'sim://?{'&'.join(settings)}'.\n"
        "  For one that stays: python -m sim_motor, then --brick tcp://127.0.0.1 in each command."
    )


def _print_table(rows: list[dict[str, Any]]) -> None:
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for heading in ("name", "value", "unit", "range", "default", "what it is"):
        table.add_column(heading)
    for row in rows:
        choices = row["choices"]
        span = (
            ", ".join(map(str, choices))
            if isinstance(choices, list)
            else f"{row['minimum']} to {row['maximum']}"
        )
        table.add_row(
            *map(
                str,
                (row["name"], row["value"], _shown_unit(row), span, row["default"], row["doc"]),
            )
        )
    print_table(table)
