"""Figures are the project's own, and one that fails swallows no result."""

import json
import os
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure

from host.client.robot import connect
from host.figures.robot import kick as kick_figure
from host.kicking.outcome import kick_and_watch, wait_settled
from host.logs.log import Log
from host.logs.mcap_files import McapTap
from tests.lint.sources import ROOT

# What a matplotlibrc may say.
FOREIGN = {
    "text.usetex": True,
    "text.color": "white",
    "axes.labelcolor": "white",
    "axes.facecolor": "black",
    "figure.facecolor": "black",
    "savefig.dpi": 20,
    "savefig.bbox": "tight",
    "savefig.facecolor": "none",
    "font.size": 40,
    "font.family": "monospace",
    "lines.linewidth": 9,
    "axes.prop_cycle": mpl.cycler(color=["white"]),
    "svg.fonttype": "path",
    "svg.hashsalt": "theirs",
}


@pytest.fixture(scope="module")
def log():
    """The log of a kick."""
    with connect("sim://", 1) as robot, robot.recording() as log:
        wait_settled(robot)
        kick_and_watch(robot, log, "phase")
    return log


@pytest.mark.parametrize("ending", ["png", "svg"])
def test_figures_are_the_same_whatever_matplotlibrc_says(log, ending):
    own = kick_figure.draw(log, Path(f"own.{ending}"), "A kick").read_bytes()
    with mpl.rc_context(FOREIGN):
        foreign = kick_figure.draw(log, Path(f"foreign.{ending}"), "A kick").read_bytes()
        assert mpl.rcParams["text.usetex"] is True
    assert own == foreign


def fail(*_, **__):
    raise RuntimeError("latex could not be found")


def full(*_, **__):
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("failure", [fail, full])
@pytest.mark.parametrize(
    "verb", [("kick", "--mode", "phase", "--ticks", "4"), ("drive", "forward")]
)
def test_the_answer_comes_before_a_figure_that_fails(kickctl, monkeypatch, failure, verb):
    monkeypatch.setattr(Figure, "savefig", failure)
    status, out, err = kickctl(*verb, "--seed", "1", "--json")
    answer = json.loads(out)
    assert status == 0
    assert answer["figure"] is None
    assert answer["figure_error"] in err
    assert len(Log.load(answer["log"])) > 10
    status, out, err = kickctl(*verb, "--seed", "1")
    assert status == 0
    assert "log logs/" in out
    assert "figure" not in out
    assert "no figure" in err
    assert {path.suffix for path in Path("logs").iterdir()} == {".mcap"}


def test_an_interrupt_while_drawing_loses_no_answer(kickctl, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(Figure, "savefig", interrupted)
    status, out, _ = kickctl("kick", "--mode", "phase", "--seed", "1", "--json")
    assert status == 130
    assert json.loads(out)["reversed"] is True


@pytest.mark.usefixtures("drawn")
def test_a_log_that_finds_no_more_room_loses_no_kick(kickctl, monkeypatch):
    monkeypatch.setattr(McapTap, "take_records", full)
    status, out, err = kickctl("kick", "--mode", "phase", "--seed", "1", "--json")
    answer = json.loads(out)
    assert status == 1
    assert answer["reversed"] is True
    assert answer["log_error"] in err
    assert Path(answer["figure"]).exists()


def test_a_run_is_answered_without_its_files(kickctl, monkeypatch):
    monkeypatch.setattr(Figure, "savefig", fail)
    status, out, err = kickctl("theory", "hopf", "--json")
    assert status == 0
    assert json.loads(out)["figures"] == []
    assert "latex could not be found" in err
    monkeypatch.setattr("host.runs.folder.Study.write_table", full)
    status, out, err = kickctl("theory", "hopf", "--json")
    answer = json.loads(out)
    assert status == 1
    assert answer["tables"] == []
    assert [claim["id"] for claim in answer["claims"]] == ["M3"]
    assert "No space left" in answer["unwritten"]["table"]


def test_a_body_is_answered_without_its_figure(kickctl, monkeypatch):
    monkeypatch.setattr(Figure, "savefig", fail)
    status, out, err = kickctl("body", "car", "--time", "0.1", "--json")
    answer = json.loads(out)
    assert status == 0
    assert set(answer["unwritten"]) == {"body.png", "body.svg"}
    assert "latex could not be found" in err
    assert (Path(answer["folder"]) / "state.csv").exists()


@pytest.mark.parametrize(
    "spoiled",
    [
        {"MPLBACKEND": "nosuch"},
        {"MPLBACKEND": "module://nosuch"},
        {"MATPLOTLIBRC": "nowhere/matplotlibrc"},
        {"MATPLOTLIBRC": "spoiled"},
        {},
    ],
    ids=str,
)
def test_damaged_settings_of_matplotlib_cost_no_figure(shell, tmp_path, spoiled):
    (tmp_path / "spoiled").write_bytes(b"\xff\xfe font.size")
    if not spoiled:  # the first place where matplotlib looks
        (tmp_path / "spoiled").rename(tmp_path / "matplotlibrc")
    status, out, err = shell("kickctl kick --mode phase --seed 1 --json", **spoiled)
    answer = json.loads(out)
    assert status == 0
    assert (tmp_path / answer["figure"]).read_bytes().startswith(b"\x89PNG")
    assert "figure_error" not in answer
    assert len(err.splitlines()) == 1


def test_a_notebook_keeps_its_own_settings_of_matplotlib(tmp_path):
    (tmp_path / "matplotlibrc").write_text("font.size: 33\n")
    code = (
        "import host.figures, matplotlib, os;"
        "print(matplotlib.rcParams['backend'], matplotlib.rcParams['font.size'],"
        " os.environ['MPLBACKEND'], 'MATPLOTLIBRC' in os.environ)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT), "MPLBACKEND": "svg"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == ["svg", "33.0", "svg", "False"]
