"""A claim of the paper beside what was measured, and the verdict on it."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

HOLDS, FAILS, UNDECIDED = "holds", "does not hold", "undecided"


@dataclass(frozen=True)
class Claim:
    """One row of a report: what the paper says, and what was measured.

    Attributes:
        id: The number under which the project keeps the claim, such as R8.
        claim: What is claimed.
        paper: The paper's number; a range is the target.
        measured: The number that was measured, in `unit`; None if there was nothing to measure.
        unit: The unit of `measured`; "1" for a number without one.
        interval: Where the number lies with a confidence of 95 %; None where chance plays no part.
        holds: Whether the claim holds; None if this run cannot decide it, because it has too few
            trials or is not at the parameters that the claim is made for.
        note: What was measured, and what else was found; why the claim does not hold or is
            undecided.
    """

    id: str
    claim: str
    paper: str
    measured: float | None
    unit: str
    interval: tuple[float, float] | None
    holds: bool | None
    note: str = ""

    @property
    def verdict(self) -> str:
        """HOLDS, FAILS or UNDECIDED."""
        return UNDECIDED if self.holds is None else HOLDS if self.holds else FAILS

    def doubted(self, *reasons: str) -> Claim:
        """The claim, undecided if there is a reason for that.

        Args:
            reasons: Why this run cannot decide the claim, in words that follow the note. Empty
                ones do not count.
        """
        doubts = [reason for reason in reasons if reason]
        if not doubts:
            return self
        return replace(self, holds=None, note="; ".join(filter(None, [self.note, *doubts])))

    def as_dict(self) -> dict[str, Any]:
        """The claim as plain data, with its verdict."""
        return {**asdict(self), "verdict": self.verdict}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Claim:
        """The claim that `as_dict` gave as plain data."""
        fields = {name: value for name, value in data.items() if name != "verdict"}
        return cls(**{**fields, "interval": tuple(data["interval"]) if data["interval"] else None})

    def number(self) -> str:
        """What was measured, with unit and interval."""
        if self.measured is None:
            return "nothing"
        unit = "" if self.unit == "1" else " " + self.unit
        interval = f" ({self.interval[0]:.3g} to {self.interval[1]:.3g})" if self.interval else ""
        return f"{self.measured:.3g}{unit}{interval}"

    def sentence(self) -> str:
        """The verdict, the claim, what was measured and what is asked for, on one line."""
        verdict = self.verdict.upper() if self.holds is False else self.verdict
        note = f", {self.note}" if self.note else ""
        return (
            f"{self.id} {verdict}: {self.claim}. Measured: {self.number()}{note}. Asked for:"
            f" {self.paper}."
        )


def exit_status(claims: list[dict[str, Any]]) -> int:
    """The exit status of a command that measured these claims, given as plain data.

    Returns:
        1 if one of them does not hold, else 0. An undecided claim is no failure.
    """
    return 1 if any(claim["holds"] is False for claim in claims) else 0


def too_few(count: int, least: int, of_what: str) -> str:
    """What to say if a claim rests on fewer trials than it takes; empty if there are enough."""
    return "" if count >= least else f"{count} {of_what} are too few: it takes {least} to decide"
