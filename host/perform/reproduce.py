"""Measures all of the paper's claims, about the robot and about the model, and writes a report."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from host.errors import WrongUse
from host.experiments.registry import BODIES, TABLE
from host.link.addresses import sim_options
from host.link.names import chosen
from host.perform.run import RESULTS, perform
from host.runs import html_report as report
from host.runs.claims import Claim
from host.runs.presets import OPTION, PAPER
from host.runs.registry import Entry
from host.theory.studies.registry import TABLE as STUDIES
from host.util.installation import install_command

# What a claim needs around a real robot. If someone asks for the claim by name, it is there.
NEEDS = {
    "R13": (
        "needs two walls, a robot's length and more apart: build them, and ask for it by name"
        " (--only R13)"
    )
}

OF_MODEL = "is about the paper's model, not about a robot: ask for it by name, or without --brick"
OF_BODIES = "is about simulated cars, not about a robot: ask for it by name, without --brick"
NO_BODIES = f"needs mujoco, which is not installed: {install_command('bodies')}"
_ELSEWHERE = {"M": OF_MODEL, "B": OF_BODIES}


class Reproduction(NamedTuple):
    """The outcome of a reproduction.

    Attributes:
        claims: The claims, in the order of their numbers.
        at_preset: Those about the robot once more, by their ids, measured in the setting `paper` of
            what the paper leaves open. Empty for a real robot, which is as it is.
        skipped: Why a claim was not measured, by its id.
        page: The path of the report; None if it could not be written.
        origin: Version and commit of the program, and the random seed, by these names.
    """

    claims: list[Claim]
    at_preset: dict[str, Claim]
    skipped: dict[str, str]
    page: Path | None
    origin: dict[str, Any]


def claim_ids() -> list[str]:
    """The ids of all claims: R of the robot, M of the model, B of simulated bodies."""
    return sorted(
        (number for entry in (*TABLE.values(), *STUDIES.values()) for number in entry.claims),
        key=_place,
    )


def _place(number: str) -> tuple[int, int]:
    return "RMB".index(number[0]), int(number[1:])


def reproduce(
    uri: str | None = None,
    seed: int | None = None,
    only: Sequence[str] = (),
    *,
    token: str | None = None,
    out: str | Path = RESULTS,
    take_over: bool = False,
    say: Callable[[str], None] = lambda words: None,
) -> Reproduction:
    """Run what decides the claims, or resume it, and write a report.

    Args:
        uri: The robot's name or address, as `connect` takes it.
        seed: The random seed; by default 1.
        only: The ids of the claims; by default all that this robot can decide.
        token: The path of the robot's token file.
        out: The folder for results. The report is report.html there, or for some claims only a name
            such as report-R5-R6.html.
        take_over: Take control of a real robot, also from another host, which hears of it.
        say: Called with messages for people.

    Raises:
        KickctlError: A run ended early. The cells that are complete are kept.
    """
    unknown = [number for number in only if number not in claim_ids()]
    if unknown:
        raise WrongUse(
            f"there is no claim {', '.join(unknown)}", "there are " + ", ".join(claim_ids())
        )
    robot = chosen(uri)
    simulated = sim_options(robot.address) is not None
    skipped = (
        {}
        if simulated or only
        else NEEDS
        | {number: _ELSEWHERE[number[0]] for number in claim_ids() if number[0] in _ELSEWHERE}
    )
    if not only and find_spec("mujoco") is None:
        skipped |= {number: NO_BODIES for entry in BODIES.values() for number in entry.claims}
    wanted = [
        number for number in claim_ids() if number not in skipped and (not only or number in only)
    ]
    summaries: list[dict[str, Any]] = []

    def run(table: Mapping[str, Entry], uri: str | None, **options: Any) -> dict[str, Claim]:
        claims: dict[str, Claim] = {}
        for name, entry in table.items():
            if any(number in wanted for number in entry.claims):
                summary = perform(
                    name, uri, seed, token=token, out=out, take_over=take_over, say=say, **options
                )
                summaries.append(summary)
                found = [Claim.from_dict(claim) for claim in summary["claims"]]
                claims.update(
                    (claim.id, claim)
                    for claim in found
                    if claim.id in entry.claims and claim.id in wanted
                )
        return claims

    claims = {**run(TABLE, robot.name), **run(STUDIES, None)}
    at_preset: dict[str, Claim] = {}
    if simulated:
        open_to_choice = {name: entry for name, entry in TABLE.items() if OPTION in entry.options}
        at_preset = run(open_to_choice, robot.name, **{OPTION.name: PAPER})
    name = "-".join(["report", *(wanted if only else [])])
    found = [claims[number] for number in wanted]
    page: Path | None = Path(out) / f"{name}.html"
    try:
        report.write(Path(out) / f"{name}.html", found, at_preset, summaries, skipped)
    except OSError as error:  # the claims are known all the same
        say(f"the report cannot be written: {error.filename}: {error.strerror}")
        page = None
    origin = {name: summaries[0][name] for name in ("version", "commit", "seed")}
    return Reproduction(found, at_preset, skipped, page, origin)
