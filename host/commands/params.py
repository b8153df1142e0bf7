"""kickctl params list|get|set."""

import argparse

from host.commands._terminal import print_table, robot_of, say, show
from host.errors import WrongUse
from host.link.settings import parse_setting

HELP = "the robot's parameters: list, get NAME, set NAME=VALUE ..."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The action and its names."""
    parser.add_argument("action", choices=("list", "get", "set"))
    parser.add_argument("names", nargs="*", metavar="NAME[=VALUE]")


def run(options: argparse.Namespace) -> int:
    """List, get or set. The robot checks a set, and changes all of it or nothing."""
    if (options.action == "list") == bool(options.names):
        raise WrongUse(
            f"params {options.action} takes {'no names' if options.names else 'at least one name'}",
            "see kickctl params --help",
        )
    changes = dict(map(parse_setting, options.names)) if options.action == "set" else {}
    with robot_of(options) as robot:
        rows = {row["name"]: row for row in robot.describe("params")}
        names = list(changes) or options.names or list(rows)
        for name in names:
            if name not in rows:
                raise WrongUse(f"the robot has no parameter '{name}'", "it has " + ", ".join(rows))
        if changes:
            robot.set(**changes)
            if robot.link.virtual:
                say(_gone(options.names))
        values = robot.status()["params"]
    if options.action == "list":
        table = [
            {"name": name, "value": values[name], **{key: row[key] for key in row if key != "name"}}
            for name, row in rows.items()
        ]
        if options.json:
            show({"params": table})
        else:
            _print_table(table)
    elif options.json:
        show({name: values[name] for name in names})
    else:
        for name in names:
            print(f"{name} = {values[name]} {rows[name]['unit']}".rstrip())
    return 0


def _gone(settings: list[str]) -> str:
    given = " ".join(f"--set {setting}" for setting in settings)
    return (
        "the simulated robot ends with this command, and the new values with it.\n"
        f"  For a simulated robot that begins with them: kickctl {given} kick --mode phase, or"
        f" --brick 'sim://?{'&'.join(settings)}'.\n"
        "  For one that stays: python -m sim_motor, then --brick tcp://127.0.0.1 in each command."
    )


def _print_table(rows: list[dict[str, object]]) -> None:
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
            *map(str, (row["name"], row["value"], row["unit"], span, row["default"], row["doc"]))
        )
    print_table(table)
