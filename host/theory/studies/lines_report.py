"""What the lines show: special points, where lines end or meet, and how accurate they are."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypedDict, cast

from host.runs.answers import Answer
from host.runs.contract import Findings, Setting
from host.theory.analysis.chaos_edges import LASTING_S, LIFE_S, MANY, WHEELS
from host.theory.studies.lines_plane import plane_of
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
from host.theory.studies.lines_windows import VALUES, WINDOW_BANDS
from host.theory.studies.registry import LETTERS

_UNITS = {"tau": "s", "f": "s", "I": "s^2"}
_CYCLES = {
    "FB": " of forth-and-back cycles",
    "LLM": " of rotations",
    "windows": " of cycles in windows",
}
_NAMES = {
    "Hopf": "Hopf line",
    "merging": "merging line",
    "fold": "folds",
    "pitchfork": "pitchforks",
    "period-doubling": "period doublings",
    "neimark-sacker": "Neimark-Sacker line",
}
_ENDS = {
    "Hopf line": "end at a Bautin point",
    "merging": "join the merging line",
    "resonance 1:1": "ends where two multipliers are 1",
    "resonance 1:2": "ends where two multipliers are -1",
    "lost": "could not be followed further",
    "long": "was not followed further",
    "beside": "so close to the merging line that they are not followed",
}


class LineNumbers(TypedDict):
    """A line: how many points it has, and their least and greatest x and y.

    Attributes:
        crossings: after how many crossings its cycles repeat themselves, up to the symmetries.
    """

    line: str
    points: int
    crossings: list[int]
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
        crises: where chaos has a mean life of crisis_life_s, with x halfway between leaves and
            stays: the closest values at which its life is shorter and longer, with 95 % confidence.
        crisis_life_s: this life (s).
        greatest_off_by: the greatest relative difference with shorter time steps.
        not_drawn: what lines are not followed, or may be missed, in words.
    """

    constants: dict[str, float]
    axes: dict[str, str]
    special_points: list[dict[str, object]]
    ends: list[dict[str, object]]
    lines: list[LineNumbers]
    crises: list[dict[str, object]]
    crisis_life_s: float
    greatest_off_by: float | None
    not_drawn: list[str]


def report(rows: list[LinesRow], setting: Setting) -> Findings:
    """The lines. The paper claims nothing about them in numbers."""
    axes = {axis: setting.options[axis] for axis in ("x", "y")}
    chaos = chaos_edges_of(rows)
    specials, ends, lines = specials_of(rows), ends_of(rows), _lines(points_of(rows))
    beside = list(_beside_answers(ends, axes))
    missed = _missed_answer(setting, axes)
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
        "crises": [
            {
                "side": row["side"],
                "x": row["x"],
                "y": row["y"],
                "leaves": row["leaves"],
                "stays": row["stays"],
            }
            for row in chaos
        ],
        "crisis_life_s": LIFE_S,
        "greatest_off_by": max(differences, default=None),
        "not_drawn": [f"{answer.name}: {answer.in_words()}" for answer in (*beside, missed)],
    }
    answers = [
        *(_special_answer(row, axes) for row in specials if row["part"] != "windows"),
        *(
            _end_answer(row, axes)
            for row in ends
            if row["part"] != "windows" and row["type"] != "beside"
        ),
        *beside,
        *(_line_answer(one, axes) for one in lines),
        *_missing(lines),
        missed,
    ]
    if chaos:
        what = f"{MANY} of {WHEELS} wheels leave chaos in {LASTING_S:g} s, to where none does"
        answers.append(Answer(f"crisis: chaos lives {LIFE_S:g} s; in brackets, from where", what))
    answers += [_chaos_answer(row, axes) for row in chaos]
    return Findings([], numbers, answers=answers)


def _line_answer(line: LineNumbers, axes: dict[str, str]) -> Answer:
    words = _range(axes["x"], line["x"]) + ", " + _range(axes["y"], line["y"])
    if line["line"].endswith(_CYCLES["windows"]):
        words += ", period " + ", ".join(map(str, line["crossings"]))
    return Answer(line["line"], words)


def _missing(lines: list[LineNumbers]) -> Iterator[Answer]:
    """What is said of flips that were not found."""
    names = [line["line"] for line in lines]
    flips = [_name(part, "pitchfork") for part in ("FB", "LLM")]
    if not any(name in flips for name in names):
        yield Answer("pitchforks of symmetric cycles", "none; they cannot double their period")
    if _name("windows", "period-doubling") not in names:
        yield Answer(_name("windows", "period-doubling"), "none found")


def _missed_answer(setting: Setting, axes: dict[str, str]) -> Answer:
    """Which windows are too narrow to be found for sure."""
    window = plane_of(setting.options).window
    step, height = (window.x_to - window.x_from) / (VALUES - 1), window.y_to / WINDOW_BANDS
    words = (
        f"those narrower in {axes['x']} than {step:.2g}{_unit(axes['x'])}, or lower in {axes['y']}"
        f" than {height:.2g}{_unit(axes['y'])}"
    )
    return Answer("windows that may be missing", words)


def _beside_answers(ends: list[EndRow], axes: dict[str, str]) -> Iterator[Answer]:
    """Lines that run beside the merging line, each with the range in which they were seen."""
    found: dict[str, list[EndRow]] = {}
    for row in ends:
        if row["type"] == "beside":
            found.setdefault(_name(row["part"], row["on"]), []).append(row)
    for name, own in found.items():
        places = ", ".join(
            _range(letter, [min(values), max(values)])
            for letter, values in (
                (axes["x"], [row["x"] for row in own]),
                (axes["y"], [row["y"] for row in own]),
            )
        )
        gap = max((row["gap"] for row in own if row["gap"] is not None), default=None)
        words = places if gap is None else f"{places}, closer than {gap:.1e} of it"
        yield Answer(f"{name}: {_ENDS['beside']}", words)


def _lines(points: list[PointRow | CyclePointRow]) -> list[LineNumbers]:
    found: dict[str, list[PointRow | CyclePointRow]] = {}
    for row in points:
        found.setdefault(_name(row["part"], row["type"]), []).append(row)
    return [
        {
            "line": name,
            "points": len(own),
            "crossings": sorted(
                {cast("CyclePointRow", row)["crossings"] for row in own if "crossings" in row}
            ),
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
    (x, y), (low, high) = axes.values(), sorted((row["leaves"], row["stays"]))
    lasts = "above" if row["side"] == "lower" else "below"
    return Answer(
        f"chaos lasts {lasts}, {y} = {row['y']:g}{_unit(y)}",
        f"{x} = {row['x']:.5g}{_unit(x)} ({low:.5g} to {high:.5g})",
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
