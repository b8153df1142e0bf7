"""kickctl reproduce."""

import argparse
from typing import TYPE_CHECKING

from host.commands._options import add_take_over
from host.commands._terminal import essential, print_table, say, show
from host.errors import NotDone
from host.util.paths import path_argument

if TYPE_CHECKING:
    from host.runs.claims import Claim

HELP = (
    "measure all of the paper's claims about the robot and its model, and write a report with"
    " figures"
)
# It sets the parameters of its robots itself.
USES = ("brick", "seed", "token", "name")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Which claims, the folder, and whether to take control from another host."""
    parser.add_argument("--only", metavar="IDS", help="only these claims, such as R5,M7")
    parser.add_argument(
        "--out",
        type=path_argument,
        default="results",
        metavar="FOLDER",
        help="folder for the results (default %(default)s)",
    )
    add_take_over(parser)


def run(options: argparse.Namespace) -> int:
    """Measure and report. The report says whether the claims hold, not the exit status."""
    from host.perform.reproduce import reproduce

    only = [number.strip().upper() for number in options.only.split(",")] if options.only else []
    done = reproduce(
        options.brick,
        options.seed,
        only,
        token=options.token,
        out=options.out,
        take_over=options.take_over,
        say=say,
    )
    page = done.page and str(done.page)
    essentials = f"report {page}" if page else ""
    if options.json:
        claims = [claim.as_dict() for claim in done.claims]
        at_preset = [claim.as_dict() for claim in done.at_preset.values()]
        show(
            {
                "claims": claims,
                "at_preset": at_preset,
                "skipped": done.skipped,
                "report": page,
                **done.origin,
            },
            essentials,
        )
    else:
        with essential(essentials):
            _print(done.claims, done.at_preset, done.skipped)
            if page:
                print(essentials)
    if done.page is None:
        raise NotDone("the report is not written", "make room, and run the same command again")
    return 0


def _print(claims: list["Claim"], at_preset: dict[str, "Claim"], skipped: dict[str, str]) -> None:
    from rich.table import Table

    from host.runs.presets import ABOUT

    table = Table("", "claim", "asked for", "measured", "in the setting 'paper'", show_lines=True)
    for claim in claims:
        other = at_preset.get(claim.id)
        table.add_row(
            claim.id,
            claim.claim,
            claim.paper,
            _measured(claim),
            _measured(other) if other else "",
        )
    for number in skipped:
        table.add_row(number, "", "", "not measured", "")
    print_table(table)
    if at_preset:
        print(ABOUT)
    for number, note in [(claim.id, claim.note) for claim in claims] + list(skipped.items()):
        if note:
            print(f"{number}: {note}")


def _measured(claim: "Claim") -> str:
    return f"{claim.number()}: {claim.verdict.upper() if claim.holds is False else claim.verdict}"
