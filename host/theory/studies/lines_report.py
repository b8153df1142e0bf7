"""What the lines show: special points, where lines end or meet, and how accurate they are."""

from __future__ import annotations

from typing import TypedDict

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.chaos_edges import LASTING_S
from host.theory.studies.lines_rows import (
    ChaosEdgeRow,
    CyclePointRow,
    EndRow,
    LinesRow,
    PointRow,
    SpecialRow,
    chaos_edges_of,
    ends_of,
    points_of,
    specials_of,
)
from host.theory.studies.registry import LETTERS

_UNITS = {"tau": "s", "f": "s", "I": "s^2"}
_CYCLES = {"FB": " of forth-and-back cycles", "LLM": " of rotations"}
_NAMES = {
    "Hopf": "Hopf line",
    "merging": "merging line",
    "fold": "folds",
    "pitchfork": "pitchforks",
    "neimark-sacker": "Neimark-Sacker line",
}
_ENDS = {
    "Hopf line": "end at a Bautin point",
    "merging": "join the merging line",
    "resonance 1:1": "ends where two multipliers are 1",
    "resonance 1:2": "ends where two multipliers are -1",
    "lost": "could not be followed further",
    "long": "was not followed further",
}


class LineNumbers(TypedDict):
    """A line: how many points it has, and their least and greatest x and y."""

    line: str
    points: int
    x: list[float]
    y: list[float]


class Numbers(TypedDict):
    """All numbers of the study.

    Attributes:
        constants: of the wheel; those on the axes do not matter.
        axes: the constants x and y.
        special_points: with x and y, and the relative difference with shorter time steps.
        ends: where lines end, with x and y.
        lines: the lines that were found.
        chaos_edges: where half of the wheels are still chaotic after chaos_lasts_s; few and most
            are the values of x at which a tenth and nine tenths of them are.
        chaos_lasts_s: how long lasting chaos lasts at least (s).
        greatest_off_by: the greatest relative difference with shorter time steps.
    """

    constants: dict[str, float]
    axes: dict[str, str]
    special_points: list[dict[str, object]]
    ends: list[dict[str, object]]
    lines: list[LineNumbers]
    chaos_edges: list[dict[str, float]]
    chaos_lasts_s: float
    greatest_off_by: float | None


def report(rows: list[LinesRow], setting: Setting) -> Findings:
    """The lines. The paper claims nothing about them in numbers."""
    axes = {axis: setting.options[axis] for axis in ("x", "y")}
    chaos = chaos_edges_of(rows)
    specials, ends, lines = specials_of(rows), ends_of(rows), _lines(points_of(rows))
    differences = [row["off_by"] for row in specials if row["off_by"] is not None]
    numbers: Numbers = {
        "constants": {letter: setting.options[letter] for letter in LETTERS},
        "axes": axes,
        "special_points": [
            {
                "type": row["type"],
                "line": _name(row["part"], row["on"]),
                "x": row["x"],
                "y": row["y"],
                "off_by": row["off_by"],
            }
            for row in specials
        ],
        "ends": [
            {
                "type": row["type"],
                "line": _name(row["part"], row["on"]),
                "x": row["x"],
                "y": row["y"],
                "gap": row["gap"],
            }
            for row in ends
        ],
        "lines": lines,
        "chaos_edges": [
            {"x": row["x"], "y": row["y"], "few": row["few"], "most": row["most"]} for row in chaos
        ],
        "chaos_lasts_s": LASTING_S,
        "greatest_off_by": max(differences, default=None),
    }
    answers = [
        *(_special_answer(row, axes) for row in specials),
        *(_end_answer(row, axes) for row in ends),
        *(
            Answer(one["line"], _range(axes["x"], one["x"]) + ", " + _range(axes["y"], one["y"]))
            for one in lines
        ),
    ]
    answers += [_chaos_answer(row, axes) for row in chaos]
    if not any(row["type"] == "pitchfork" for row in points_of(rows)):
        answers.append(Answer("pitchforks, period doublings", "none of symmetric cycles"))
    return Findings([], numbers, answers=answers)


def _lines(points: list[PointRow | CyclePointRow]) -> list[LineNumbers]:
    found: dict[str, list[PointRow | CyclePointRow]] = {}
    for row in points:
        found.setdefault(_name(row["part"], row["type"]), []).append(row)
    return [
        {
            "line": name,
            "points": len(own),
            "x": [min(row["x"] for row in own), max(row["x"] for row in own)],
            "y": [min(row["y"] for row in own), max(row["y"] for row in own)],
        }
        for name, own in found.items()
    ]


def _name(part: str, type_: str) -> str:
    """A line in words."""
    return _NAMES[type_] + _CYCLES.get(part, "")


def _special_answer(row: SpecialRow, axes: dict[str, str]) -> Answer:
    where = (
        "" if row["type"] in ("Bautin", "neutral saddle") else _name(row["part"], row["on"]) + ": "
    )
    names = {"Bautin": "Bautin point", "crosses Hopf": "crosses the Hopf line"}
    return Answer(where + names.get(row["type"], row["type"]), _place(row, axes))


def _end_answer(row: EndRow, axes: dict[str, str]) -> Answer:
    gap = "" if row["gap"] is None else f", closer than {row['gap']:.1e} of it"
    return Answer(f"{_name(row['part'], row['on'])}: {_ENDS[row['type']]}", _place(row, axes) + gap)


def _chaos_answer(row: ChaosEdgeRow, axes: dict[str, str]) -> Answer:
    (x, y), (low, high) = axes.values(), sorted((row["few"], row["most"]))
    return Answer(
        f"edge of chaos that lasts {LASTING_S:g} s, {y} = {row['y']:g}{_unit(y)}",
        f"{x} = {row['x']:.4g}{_unit(x)} ({low:.4g} to {high:.4g})",
    )


def _place(row: SpecialRow | EndRow, axes: dict[str, str]) -> str:
    return ", ".join(
        f"{letter} = {row[axis]:.10g}{_unit(letter)}"  # type: ignore[literal-required]
        for axis, letter in axes.items()
    )


def _range(letter: str, ends: list[float]) -> str:
    return f"{letter} from {ends[0]:.6g} to {ends[1]:.6g}{_unit(letter)}"


def _unit(letter: str) -> str:
    return f" {_UNITS[letter]}" if letter in _UNITS else ""
