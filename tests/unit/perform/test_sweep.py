"""Sweeps: one table for all points, the same numbers as single runs, resumed cell by cell."""

import csv
import json
import pickle
from pathlib import Path

import pytest

from host.errors import WrongUse
from host.figures import sweep as figure
from host.logs.mcap_files import LogError
from host.perform.catalogue import find
from host.perform.run import perform
from host.perform.sweep import Sweep
from host.runs.answers import Answer
from host.runs.claims import Claim
from host.runs.contract import Findings, Part, Setting
from host.runs.registry import Option, complete_options
from host.runs.sweep import axes, quantities
from host.theory.studies import hopf


@pytest.fixture(autouse=True)
def _no_figure(monkeypatch):
    monkeypatch.setattr("host.perform.run.drawing", lambda *_: lambda *_: ([], ""))


def test_each_point_has_the_numbers_of_a_run_of_its_own(tmp_path):
    swept = perform("hopf", tau=[1.0, 0.25], a=3, out=tmp_path)
    rows = swept["numbers"]["rows"]
    for tau_s in (1.0, 0.25):
        alone = perform("hopf", tau=tau_s, a=3, out=tmp_path)["answers"]
        own = [row for row in rows if row["tau"] == tau_s]
        assert [(row["quantity"], row["value"] or row["word"], row["unit"]) for row in own] == [
            (answer["name"], answer["value"], answer["unit"]) for answer in alone
        ]
    assert swept["numbers"]["swept"] == [{"name": "tau", "unit": "s", "values": [1.0, 0.25]}]
    assert swept["claims"] == []
    with Path(swept["tables"][0]).open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    assert list(table[0]) == ["tau", "quantity", "value", "error", "unit", "word", "failed"]
    assert table == [
        {name: "" if value is None else str(value) for name, value in row.items()} for row in rows
    ]


def test_a_point_that_fails_is_a_row_with_the_reason(tmp_path, monkeypatch):
    simulate = hopf.simulate

    def fails_at_2(cell, setting):
        if setting.options["tau"] == 2.0:
            raise OverflowError("too large")
        return simulate(cell, setting)

    monkeypatch.setattr(hopf, "simulate", fails_at_2)
    found = perform("hopf", tau=[1.0, 2.0], f=[0.0, 0.5], out=tmp_path)
    failed = {
        (row["tau"], row["f"]): row["failed"]
        for row in found["numbers"]["rows"]
        if row["quantity"] is None
    }
    assert list(failed) == [(1.0, 0.0), (2.0, 0.0), (2.0, 0.5)]
    assert "Hopf" in failed[1.0, 0.0]
    assert failed[2.0, 0.5] == "OverflowError: too large"
    assert found["answers"][-1]["value"].startswith("3, the first at tau = 1 s, f = 0 s: ")


def test_a_sweep_on_a_simulated_robot_has_the_numbers_of_single_runs(tmp_path):
    """An experiment that runs the robot's whole loop. It has no tick of more than tau / 3."""
    swept = perform("timeline", trials=1, tick=[0.03, 0.09], out=tmp_path)
    alone = perform("timeline", trials=1, tick=0.03, out=tmp_path)["answers"]
    *own, failed = swept["numbers"]["rows"]
    assert [row["value"] for row in own] == [answer["value"] for answer in alone]
    assert [row["tick"] for row in own] == [0.03] * len(alone)
    assert (failed["tick"], failed["quantity"]) == (0.09, None)


def test_a_log_that_cannot_be_written_ends_a_sweep_and_fails_no_point(tmp_path, monkeypatch):
    """As in a folder that was moved meanwhile, or on a disk without room for one more file."""

    def refused(path, info):
        raise LogError(f"{path} cannot be written: No space left on device", "choose another")

    with monkeypatch.context() as full:
        full.setattr("host.perform.robots.McapTap", refused)
        with pytest.raises(LogError) as error:
            perform("timeline", trials=1, tick=[0.03, 0.09], out=tmp_path)
    assert "0 of 2 cells complete" in error.value.__notes__[-1]
    swept = perform("timeline", trials=1, tick=[0.03, 0.09], out=tmp_path)
    assert [row["tick"] for row in swept["numbers"]["rows"] if row["failed"]] == [0.09]


def test_an_interrupted_sweep_goes_on_where_it_was(tmp_path, monkeypatch):
    simulate, done = hopf.simulate, []

    def interrupted(cell, setting):
        if len(done) == 4:
            raise KeyboardInterrupt
        done.append((setting.options["tau"], cell["part"]))
        return simulate(cell, setting)

    said = []
    monkeypatch.setattr(hopf, "simulate", interrupted)
    with pytest.raises(KeyboardInterrupt) as interrupt:
        perform("hopf", tau=[0.5, 1.0], out=tmp_path)
    assert "4 of 6 cells complete" in interrupt.value.__notes__[-1]
    monkeypatch.setattr(hopf, "simulate", simulate)
    perform("hopf", tau=[0.5, 1.0], out=tmp_path, say=said.append)
    assert "4 of 6 cells complete" in said[-1]
    assert len(set(done)) == 4


def test_a_sweep_goes_on_in_the_middle_of_a_cell(tmp_path, monkeypatch):
    """In parts, as long cells are: also where a point fails in its second one."""
    began = []

    def parts(cell, setting, begun):
        began.append((setting.options["tau"], begun))
        rows = hopf.simulate(cell, setting)
        if begun is None:
            yield Part(rows[:1], "state", 0.5)
            if len(began) == 4:
                raise KeyboardInterrupt
        if setting.options["tau"] == 2.0:
            raise ArithmeticError
        yield Part(rows[1:])

    expected = perform("hopf", tau=[1.0, 1.5], out=tmp_path / "whole")["numbers"]["rows"]
    monkeypatch.setattr(hopf, "parts", parts, raising=False)
    with pytest.raises(KeyboardInterrupt):
        perform("hopf", tau=[1.0, 1.5, 2.0], out=tmp_path)
    rows = perform("hopf", tau=[1.0, 1.5, 2.0], out=tmp_path)["numbers"]["rows"]
    first = hopf.simulate({"part": "point"}, Setting(1, {"tau": 1.5, "a": 4, "f": 0.5, "I": 0.05}))
    assert began[4] == (1.5, Part(first, "state", 0.5))
    assert [row for row in rows if not row["failed"]] == expected
    assert rows[-1]["failed"] == "ArithmeticError: "


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"tau": [1.0, 1.0]}, "each of them once"),
        ({"tau": []}, "one value or more"),
        ({"tau": [0.5, 0.0]}, "tau cannot be 0"),
        ({"tau": [0.5, "x"]}, "tau cannot be 'x'"),
        ({"f": [0.0], "a": [1.0, 2.0]}, "no Hopf"),
        ({"tau": [1, 2], "a": [1, 2], "f": [1, 2]}, "over 2 options at most"),
        ({"tau": range(1, 400), "I": range(1, 400)}, "has 159201 points"),
    ],
)
def test_a_sweep_that_makes_no_sense_is_refused_before_it_begins(tmp_path, options, words):
    with pytest.raises(WrongUse) as refused:
        perform("hopf", out=tmp_path, **options)
    assert words in f"{refused.value.message} {refused.value.hint}"
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("doc", "unit"),
    [
        ("time constant of the membrane potentials, s", "s"),
        ("moment of inertia of the wheel, s^2 (its torque has no unit)", "s^2"),
        ("how long to follow each of 64 wheels, s; beyond 250 s, more wheels", "s"),
        ("spring constant of the rods, without unit", ""),
        ("number of stars, sorted", ""),
    ],
)
def test_the_unit_of_an_option_is_that_of_its_help(doc, unit):
    assert Option("x", 1.0, 0.0, 1.0, doc).unit == unit


def test_a_run_without_answers_gives_its_claims_and_single_numbers():
    claim = Claim("R0", "is so", "1", 0.5, "Hz", None, holds=None)
    numbers = {"both": {"p": 0.25, "list": [1], "none": None}, "kind": "a", "in_words": "a line"}
    found = quantities(Findings([claim], numbers), {})
    assert [(one["quantity"], one["value"], one["word"], one["unit"]) for one in found] == [
        ("R0", 0.5, None, "Hz"),
        ("both: p", 0.25, None, ""),
        ("kind", None, "a", ""),
    ]


def test_names_of_answers_are_the_same_at_all_points():
    answers = [
        Answer("phase at k = 2", "rest"),
        Answer("at 0", "focus"),
        *[Answer("  rate", 1.0)] * 2,
    ]
    found = quantities(Findings([], {}, answers=answers), {"k": 2.0})
    assert [one["quantity"] for one in found] == ["phase", "at 0", "at 0: rate", "at 0: rate (2)"]


def test_another_process_computes_the_same(tmp_path):
    entry = find("hopf").entry
    options = complete_options("hopf", entry, {"tau": [0.5, 1.0]})
    sweep, setting = Sweep("hopf", axes(entry, options)), Setting(1, options)
    cell = sweep.cells(options, batch=True)[3]
    there = pickle.loads(pickle.dumps(sweep.simulate))  # noqa: S301 - our own
    assert there(cell, setting) == sweep.simulate(cell, setting)
    assert there(cell, setting)[0]["row"]["tau"] == 1.0


def findings(swept):
    names = [axis["name"] for axis in swept]
    rows = [
        {
            **dict(zip(names, (k, tau), strict=False)),
            "quantity": quantity,
            "error": None,
            "unit": "Hz",
            "failed": None,
            "value": k * tau if quantity == "speed" else None,
            "word": ("rest" if k < 2 else "roll") if quantity == "motion" else None,
        }
        for k in swept[0]["values"]
        for tau in (swept[1]["values"] if len(swept) > 1 else [1.0])
        for quantity in ("speed", "motion")
    ]
    numbers = {"of": "study", "swept": swept, "constants": {"a": 4.0}, "rows": rows}
    return rows, Findings([], numbers)


K = {"name": "k", "unit": "", "values": [1.0, 2.0, 3.0, 4.0, 5.0]}
TAU = {"name": "tau", "unit": "s", "values": [0.1, 0.2]}


def test_the_figure_has_lines_over_one_constant_and_a_line_for_each_value_of_another():
    for swept in ([K], [K, TAU]):
        speed, motion = figure.draw(*findings(swept)).axes
        for n, line in enumerate(container.lines[0] for container in speed.containers):
            assert line.get_ydata() == pytest.approx(
                [k * ([1.0], TAU["values"])[len(swept) > 1][n] for k in K["values"]]
            )
        assert len(speed.containers) == (1 if len(swept) == 1 else 2)
        assert [text.get_text() for text in motion.get_yticklabels()] == ["rest", "roll"]
        assert speed.get_xlabel() == "k"
        assert speed.get_ylabel() == "Hz"


def test_what_is_0_but_for_its_error_is_not_spread_over_decades():
    rows, found = findings([K])
    own = [row for row in rows if row["quantity"] == "speed"]
    scales = []
    for error in (None, 1e-11):
        exponents = [
            {**row, "value": 1e-12 if row["k"] < 2 else 1.0, "error": error} for row in own
        ]
        scales.append(figure.draw(exponents, found).axes[0].get_yscale())
    assert scales == ["log", "linear"]


def test_the_figure_says_how_many_quantities_it_leaves_to_the_table():
    rows, found = findings([K])
    many = [{**row, "quantity": f"{row['quantity']} {n}"} for n in range(20) for row in rows]
    drawn = figure.draw(many, found)
    assert drawn.get_supxlabel() == "the first 9 of 40 quantities; all are in sweep.csv"
    assert figure.draw(rows, found).get_supxlabel() == ""


def test_two_constants_with_many_values_each_are_a_map():
    taus = {**TAU, "values": [0.3, 0.1, 0.2, 0.4, 0.5]}
    drawn = figure.draw(*findings([K, taus]))
    speed, motion = drawn.axes[:2]
    assert speed.get_xlabel(), speed.get_ylabel() == ("k", "tau (s)")
    first_row = speed.collections[0].get_array().reshape(5, 5)[0]
    assert first_row.tolist() == pytest.approx([0.1 * k for k in K["values"]])
    assert [text.get_text() for text in motion.get_legend().get_texts()] == ["rest", "roll"]


def test_the_answer_is_json_with_the_same_rows(tmp_path):
    found = perform("hopf", tau=[0.5, 1.0], out=tmp_path)
    kept = json.loads(Path(found["summary"]).read_text(encoding="utf-8"))
    assert kept["numbers"]["rows"] == found["numbers"]["rows"]
