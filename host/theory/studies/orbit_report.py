"""What the study `orbit` found: windows by kind and period, and where attractors coexist."""

from __future__ import annotations

from itertools import groupby
from typing import Any, TypedDict

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.sections import UNDECIDED, MotionKind
from host.theory.engine.crossings import Surface
from host.theory.studies.orbit_rows import WAYS, OrbitRow, Way, motions_along
from host.theory.studies.section_report import WORDS

# `from` is a word of the language.
Window = TypedDict(
    "Window",
    {
        "way": Way,
        "from": float,
        "to": float,
        "kind": MotionKind,
        "period": int | None,
        "period_s": list[float] | None,
        "values": int,
    },
)


class Numbers(TypedDict):
    """All numbers of the study.

    Attributes:
        constants: the wheel's; the varied one is missing.
        over: the constant that is varied.
        on: the section.
        section: the same in words.
        step: distance of its values.
        windows: stretches of values with the same motion, from the first value to the last one: a
            window may be longer by less than a step on either side. period_s: the periods (s) at
            both ends.
        coexistence: stretches where the motion differs between the ways, and is decided on both.
    """

    constants: dict[str, float]
    over: str
    on: Surface
    section: str
    step: float
    windows: list[Window]
    coexistence: list[dict[str, Any]]


def report(rows: list[OrbitRow], setting: Setting) -> Findings:
    """The windows. The paper claims nothing about them in numbers."""
    options = setting.options
    over = options["over"]
    up, down = (motions_along(rows, way) for way in WAYS)
    numbers: Numbers = {
        "constants": {name: options[name] for name in ("a", "tau", "k", "f", "I") if name != over},
        "over": over,
        "on": options["on"],
        "section": WORDS[options["on"]],
        "step": up[1]["value"] - up[0]["value"],
        "windows": [*windows(up), *windows(down)],
        "coexistence": [
            {
                "from": own[0][0]["value"],
                "to": own[-1][0]["value"],
                "up": kinds[0],
                "down": kinds[1],
            }
            for kinds, group in groupby(
                zip(up, down, strict=True), key=lambda both: tuple(row["kind"] for row in both)
            )
            if kinds[0] != kinds[1] and UNDECIDED not in kinds
            for own in [list(group)]
        ],
    }
    return Findings([], numbers, answers=_answers(numbers))


def windows(rows: list[OrbitRow]) -> list[Window]:
    """Stretches of successive values with the same motion."""
    found: list[Window] = []
    for (kind, period), group in groupby(rows, key=lambda row: (row["kind"], row["period"])):
        own = list(group)
        periods_s = [row["period_s"] for row in (own[0], own[-1]) if row["period_s"] is not None]
        found.append(
            {
                "way": own[0]["way"],
                "from": own[0]["value"],
                "to": own[-1]["value"],
                "kind": kind,
                "period": period,
                "period_s": periods_s or None,
                "values": len(own),
            }
        )
    return found


def _worth_naming(window: Window) -> bool:
    """Whether a window has a period, or at least two values."""
    return bool(window["period"]) or window["values"] > 1


def _answers(numbers: Numbers) -> list[Answer]:
    """The windows that are worth naming, and where the ways differ."""
    over = numbers["over"]
    answers = [
        Answer("section", numbers["section"]),
        Answer(f"distance of the values of {over}", numbers["step"]),
    ]
    for own in filter(_worth_naming, numbers["windows"]):
        words = f"{over} = {own['from']:.6g} to {own['to']:.6g}"
        if own["period_s"]:
            first, last = own["period_s"]
            words += f", {first:.6g} s to {last:.6g} s in time"
        period = f", period {own['period']}" if own["period"] else ""
        answers.append(Answer(f"{own['way']}: {own['kind']}{period}", words))
    for both in numbers["coexistence"]:
        words = f"{over} = {both['from']:.6g} to {both['to']:.6g}"
        answers.append(Answer(f"{both['up']} up, {both['down']} down", words))
    return answers
