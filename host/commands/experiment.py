"""kickctl experiment."""

import argparse

from host.experiments.table import TABLE
from host.options import common
from host.terminal import say, show

HELP = "one of the robot's experiments: logs, table, figure, and what the paper claims beside what was measured"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """A name, and that experiment's options."""
    names = parser.add_subparsers(metavar="NAME", required=True, dest="experiment")
    for name, entry in TABLE.items():
        own = names.add_parser(name, help=entry.help, description=entry.help, parents=[common(defaults=False)])
        for option in entry.options:
            flag = "--" + option.name.replace("_", "-")
            own.add_argument(flag, type=type(option.default), default=option.default, help=f"{option.doc} (default %(default)s)")
        own.add_argument(
            "--out",
            default="results",
            metavar="FOLDER",
            help="where results go; the same command goes on where it was cut short (default %(default)s)",
        )
        own.add_argument("--scheduler", metavar="ADDRESS", help="spread the simulations over this Dask cluster, as tcp://host:8786")


def run(options: argparse.Namespace) -> int:
    """Run it; 1 if a claim does not hold."""
    from host.experiments.run import perform

    name = options.experiment
    arguments = {option.name: getattr(options, option.name) for option in TABLE[name].options}
    summary = perform(
        name, options.brick, options.seed, token=options.token, out=options.out, scheduler=options.scheduler, say=say, **arguments
    )
    if options.json:
        show(summary)
    else:
        from host.claims import Claim

        for claim in summary["claims"]:
            print(Claim.from_dict(claim).sentence())
        for kind, paths in (("table", [summary["table"]]), ("figure", summary["figures"][:1]), ("file", summary["files"])):
            for path in paths:
                print(kind, path)
    return 0 if all(claim["holds"] for claim in summary["claims"]) else 1
