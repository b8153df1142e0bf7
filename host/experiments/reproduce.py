"""All of the robot's claims in one go: the experiments that settle them, and a report."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from host import report
from host.claims import Claim
from host.errors import WrongUse
from host.experiments.run import RESULTS, address, perform
from host.experiments.table import TABLE
from host.links import sim_options

# What a robot on a table does not have around it; asked for by name, it is taken to be there.
NEEDS = {"R13": "needs two walls, a robot's length and more apart: build them, and ask for it by name (--only R13)"}


class Reproduction(NamedTuple):
    """claims: in the order of their numbers; skipped: why a claim was not tried; page: the report."""

    claims: list[Claim]
    skipped: dict[str, str]
    page: Path


def known() -> list[str]:
    """The ids of all claims that an experiment settles."""
    return sorted((number for entry in TABLE.values() for number in entry.claims), key=lambda number: int(number[1:]))


def reproduce(
    uri: str | None = None,
    seed: int | None = None,
    only: Sequence[str] = (),
    *,
    token: str | None = None,
    out: str | Path = RESULTS,
    say: Callable[[str], None] = lambda words: None,
) -> Reproduction:
    """Run what settles the claims `only`, by default all that the robot can do, and write OUT/report.html.

    The report of some claims has their names in its own, as report-R5-R6.html. Each experiment goes on where it was cut short. Raises
    KickctlError.
    """
    unknown = [number for number in only if number not in known()]
    if unknown:
        raise WrongUse(f"there is no claim {', '.join(unknown)}", "there are " + ", ".join(known()))
    uri = address(uri)
    simulated = sim_options(uri) is not None
    skipped = {} if simulated or only else NEEDS
    wanted = [number for number in known() if number not in skipped and (not only or number in only)]
    summaries: list[dict[str, Any]] = []
    claims: dict[str, Claim] = {}
    for name, entry in TABLE.items():
        if any(number in wanted for number in entry.claims):
            summary = perform(name, uri, seed, token=token, out=out, say=say)
            summaries.append(summary)
            found = [Claim.from_dict(claim) for claim in summary["claims"]]
            claims.update((claim.id, claim) for claim in found if claim.id in entry.claims and claim.id in wanted)
    name = "-".join(["report", *(wanted if only else [])])
    page = report.write(Path(out) / f"{name}.html", [claims[number] for number in wanted], summaries, skipped)
    return Reproduction([claims[number] for number in wanted], skipped, page)
