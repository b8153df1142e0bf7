"""The tables of docs/claims.md, from what `make reproduce` has measured.

`kickctl reproduce --json | python -m json.tool > docs/claims.json` renews the data, and then
`python -m docs.site.claims` the page.
"""

from __future__ import annotations

import json
import re
from dataclasses import replace
from typing import Any

from docs.site import ROOT
from docs.site.markdown import table
from host.runs.claims import FAILS, Claim

DATA = ROOT / "docs" / "claims.json"
PAGE = ROOT / "docs" / "claims.md"
_SHARE = "the share of "
# A table with the id of a claim in its first row.
_TABLE = re.compile(r"^\|.*\n\|[-|]+\n\| ([A-Z])1 \|(?:.*\n\|)*.*\n", re.MULTILINE)


def load() -> dict[str, Any]:
    """What `kickctl reproduce --json` has answered."""
    answer: dict[str, Any] = json.loads(DATA.read_text(encoding="utf-8"))
    return answer


def counted() -> str:
    """How many claims hold, in words."""
    claims = [Claim.from_dict(claim) for claim in load()["claims"]]
    return f"{sum(bool(claim.holds) for claim in claims)} of {len(claims)} hold"


def rendered(page: str) -> str:
    """The page with tables that have what was measured.

    Args:
        page: The page, which has a table with a row R1, one with M1 and one with B1.
    """
    answer = load()
    claims = [Claim.from_dict(claim) for claim in answer["claims"]]
    at_preset = {claim["id"]: Claim.from_dict(claim) for claim in answer["at_preset"]}
    return _TABLE.sub(lambda old: _table(claims, at_preset, old[1]), page)


def _table(claims: list[Claim], at_preset: dict[str, Claim], kind: str) -> str:
    chosen = [claim for claim in claims if claim.id.startswith(kind)]
    head = ["id", "claim", "asked for", "measured", "verdict"]
    rows = [_row(claim) for claim in chosen]
    if chosen[0].id in at_preset:
        head.append("in the setting `paper`")
        for row, claim in zip(rows, chosen, strict=True):
            other = at_preset[claim.id]
            row.append(f"{_in_percent(other).number()}: {_verdict(other)}")
    return table(head, rows)


def _row(claim: Claim) -> list[str]:
    what = re.split(r"; |\. ", claim.note)[0]
    measured = f"{_in_percent(claim).number()}, {what}".replace(f", {_SHARE}", " of ")
    return [claim.id, claim.claim, claim.paper, measured, _verdict(claim)]


def _in_percent(claim: Claim) -> Claim:
    """The claim with its share in percent, if it has measured one."""
    if claim.measured is None or not claim.note.startswith(_SHARE):
        return claim
    interval = claim.interval and (100 * claim.interval[0], 100 * claim.interval[1])
    return replace(claim, measured=100 * claim.measured, unit="%", interval=interval)


def _verdict(claim: Claim) -> str:
    return f"**{claim.verdict}**" if claim.verdict == FAILS else claim.verdict


if __name__ == "__main__":
    PAGE.write_text(rendered(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
