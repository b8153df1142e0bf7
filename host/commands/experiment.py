"""kickctl experiment."""

import argparse

from host.commands._efforts import add_effort, question, sized
from host.commands._options import add_take_over
from host.commands._runs import add_run, figure_given
from host.commands._terminal import answer_run, say
from host.experiments.registry import ROBOT, TABLE
from host.runs.registry import options_given

HELP = "run one of the experiments: logs, a table, a figure, and the paper's claims, measured"
# It sets the parameters of its robots itself.
USES = ("brick", "seed", "token", "name")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A command for each experiment, with its options."""
    names = parser.add_subparsers(metavar="NAME", required=True, dest="experiment")
    for name, entry in TABLE.items():
        own = add_run(names, name, entry, USES)
        add_effort(own, name, entry)
        if name in ROBOT:
            add_take_over(own)


def run(options: argparse.Namespace) -> int:
    """Run it or resume it. Raises NotDone if a claim does not hold."""
    from host.perform.run import perform

    name = options.experiment
    arguments = {**options_given(options, TABLE[name]), **sized(options, name, TABLE[name])}
    return answer_run(
        options,
        lambda: perform(
            name,
            options.brick,
            options.seed,
            token=options.token,
            out=options.out,
            scheduler=options.scheduler,
            take_over=getattr(options, "take_over", False),
            say=say,
            ask=question(options),
            **figure_given(options),
            **arguments,
        ),
    )
