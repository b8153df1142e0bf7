"""Which files a figure is written to, and the parameters of a run in its corner."""

import json
from pathlib import Path

import pytest

from host.errors import WrongUse
from host.figures.caption import in_words
from host.perform.catalogue import find
from host.perform.drawings import files, parameters
from host.perform.run import perform
from host.runs.contract import Setting
from host.runs.registry import complete_options
from host.theory.studies import hopf

_ALONG_A = "τ = 0.25 s   k = 1.85   f = 0.5 s   I = 0.05 s²   dry friction 0"


def test_what_cannot_be_drawn_is_refused_before_work_begins(tmp_path, monkeypatch):
    monkeypatch.setattr(hopf, "simulate", None)
    with pytest.raises(WrongUse, match="cannot be written as 'jpg'"):
        perform("hopf", formats="png,jpg", out=tmp_path)
    with pytest.raises(WrongUse, match="no panel 'x'") as caught:
        perform("hopf", panel="x", out=tmp_path)
    assert caught.value.hint == "its panels are line, ratio, coefficient, frequency"
    assert not list(tmp_path.iterdir())


def test_a_panel_has_a_file_of_its_own(tmp_path):
    found = perform("hopf", panel="frequency", formats=["pdf", "PNG"], out=tmp_path)
    assert [Path(path).name for path in found["figures"]] == [
        "hopf-frequency.pdf",
        "hopf-frequency.png",
    ]
    assert json.loads(Path(found["summary"]).read_text(encoding="utf-8"))["unwritten"] == {}


def test_a_panel_that_only_the_results_rule_out_costs_no_results(tmp_path):
    found = perform("hopf", tau=[0.5, 1.0], panel="x", formats="svg", out=tmp_path)
    assert [Path(path).name for path in found["figures"]] == ["sweep.svg"]
    assert list(found["unwritten"]) == ["panel"]
    words = "no panel 'x', so all are drawn: its panels are Hopf bifurcation at k, the paper's"
    assert words in found["unwritten"]["panel"]
    assert "--panel" not in Path(found["figures"][0]).read_text(encoding="utf-8")
    again = perform("hopf", tau=[0.5, 1.0], panel="wheels swing with", formats="svg", out=tmp_path)
    assert [Path(path).name for path in again["figures"]] == ["sweep-wheels-swing-with.svg"]
    assert again["unwritten"] == {}


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("portrait", {}, "a = 4   τ = 0.25 s   f = 0.5 s   I = 0.05 s²"),
        (
            "branch",
            {"along": "a", "k": 2.0, "rods": 1},
            "τ = 0.25 s   k = 2   f = 0.5 s   I = 0.05 s²   rods: 1   dry friction 0.1",
        ),
        ("lines", {}, "a = 4   f = 0.5 s   I = 0.05 s²"),
        ("hopf", {"tau": [0.1, 0.2]}, "a = 4   f = 0.5 s   I = 0.05 s²"),
        ("timeline", {"tick": 0.02}, "a = 4   τ = 0.25 s   k = 8   tick 0.02 s"),
        ("primitives", {}, "a = 4   τ = 0.25 s   k = 8   tick 0.03 s"),
        (
            "timeline",
            {"preset": "paper"},
            "a = 4   τ = 0.25 s   k = 8   tick 0.03 s   rods 0.006 s older",
        ),
        ("bifurcation", {}, "a = 4   τ = 0.25 s   tick 0.03 s"),
        ("leave-chaos", {}, "a = 4   τ = 1 s   k = 15   tick 0.03 s"),
        ("train-start", {}, "a = 2   τ = 0.05 s   k = 0.5 N (paper), 2 N (snake2019)"),
        ("train-slope", {}, "a = 2   τ = 0.05 s"),
        ("train-kick", {}, "a = 2   τ = 0.05 s   k = 0.5 N"),
        ("car-route", {}, ""),
        ("branch", {"along": "a", "dry": 0.0}, _ALONG_A),
    ],
)
def test_the_corner_has_the_parameters_that_the_run_had(name, options, words):
    found = find(name)
    setting = Setting(1, complete_options(name, found.entry, options))
    assert in_words(parameters(found, setting, name)) == words


def test_formats_are_written_once_and_in_their_order():
    assert files("host.figures.theory.hopf", "svg, png,svg", None, {}).formats == ("svg", "png")


@pytest.mark.parametrize(
    ("name", "options", "there"),
    [
        ("portrait", {}, "k=1.65"),
        ("portrait", {"k": 2.0}, "k=2"),
        ("basins", {}, "kicks-phase-plus-sampled"),
    ],
)
def test_a_panel_that_depends_on_the_run_is_refused_before_it(name, options, there):
    found = find(name)
    complete = complete_options(name, found.entry, options)
    assert files(found.figures, "png", there, complete).panel == there
    with pytest.raises(WrongUse, match="no panel 'k=3'"):
        files(found.figures, "png", "k=3", complete)


def test_panels_of_kicks_are_refused_before_the_run_if_no_wheel_rolls(tmp_path):
    with pytest.raises(WrongUse, match="no panel 'kicks-position-sampled'") as caught:
        perform("basins", k=1.0, panel="kicks-position-sampled", out=tmp_path)
    assert caught.value.hint == "its panels are starts-continuous, starts-sampled"
    assert not list(tmp_path.iterdir())
