"""kickctl params list|get|set."""

import argparse

from host.commands._terminal import robot_of, show
from host.errors import WrongUse

HELP = "the robot's parameters: list, get NAME, set NAME=VALUE ..."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The action and its names."""
    parser.add_argument("action", choices=("list", "get", "set"))
    parser.add_argument("names", nargs="*", metavar="NAME[=VALUE]")


def run(options: argparse.Namespace) -> int:
    """List, get or set; a set is checked by the robot and done wholly or not at all."""
    if (options.action == "list") == bool(options.names):
        raise WrongUse(
            f"params {options.action} takes {'no names' if options.names else 'at least one name'}",
            "see kickctl params --help",
        )
    changes = dict(_parse(text) for text in options.names) if options.action == "set" else {}
    with robot_of(options) as robot:
        rows = {row["name"]: row for row in robot.describe("params")}
        names = list(changes) or options.names or list(rows)
        for name in names:
            if name not in rows:
                raise WrongUse(f"the robot has no parameter '{name}'", "it has " + ", ".join(rows))
        if changes:
            robot.set(**changes)
        values = robot.status()["params"]
    if options.action == "list":
        table = [
            {"name": name, "value": values[name], **{key: row[key] for key in row if key != "name"}}
            for name, row in rows.items()
        ]
        if options.json:
            show(table)
        else:
            _print_table(table)
    elif options.json:
        show({name: values[name] for name in names})
    else:
        for name in names:
            print(f"{name} = {values[name]} {rows[name]['unit']}".rstrip())
    return 0


def _parse(text: str) -> tuple[str, float | int | str]:
    name, equals, value = text.partition("=")
    if not equals or not value:
        raise WrongUse(f"'{text}' sets nothing", "write it as in k=2.5")
    for convert in (int, float):
        try:
            return name, convert(value)
        except ValueError:
            pass
    return name, value


def _print_table(rows: list[dict[str, object]]) -> None:
    from rich.console import Console
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
    Console().print(table)
