"""kickctl theory."""

import argparse
from typing import Any

from host.commands._runs import add_run, figure_given
from host.commands._terminal import answer_run, say
from host.runs.registry import options_given
from host.theory.studies.registry import TABLE

HELP = (
    "study the paper's model of a wheel: fixpoints, bifurcations, portraits, phase diagram, chaos,"
    " basins"
)
USES = ("seed",)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A command for each study, with its options."""
    names = parser.add_subparsers(metavar="NAME", required=True, dest="study")
    for name, entry in TABLE.items():
        add_run(names, name, entry, USES)


def run(options: argparse.Namespace) -> int:
    """Run it or resume it. Raises NotDone if a claim does not hold.

    With --json the numbers stand beside the fields of the summary; a list of them has the study's
    name.
    """
    from host.perform.run import perform

    name = options.study

    def as_json(summary: dict[str, Any]) -> dict[str, Any]:
        facts = {key: value for key, value in summary.items() if key != "numbers"}
        numbers = summary["numbers"]
        return facts | (numbers if isinstance(numbers, dict) else {name: numbers})

    return answer_run(
        options,
        lambda: perform(
            name,
            None,
            options.seed,
            out=options.out,
            scheduler=options.scheduler,
            say=say,
            **figure_given(options),
            **options_given(options, TABLE[name]),
        ),
        as_json,
    )
