"""Experiments run, resumed and broken off.

With a small one of their own on real robots, and with `reliability` on the simulated one.
"""

import json
import os
import signal
import subprocess
import sys
import time
import types
from contextlib import nullcontext
from pathlib import Path

import pytest

from host.errors import NoLink, NotDone, RobotFault
from host.experiments import registry as table
from host.perform import robots as run
from host.perform.run import perform
from host.runs.claims import Claim
from host.runs.contract import Findings
from tests.cli.test_desk import desk_robot

ROOT = Path(__file__).resolve().parents[2]
COUNT = 6


class Toy:
    """An experiment whose cells are numbers; `trouble` comes before a cell, once for each entry."""

    simulate = None

    def __init__(self):
        self.trouble = {}
        self.done = []

    def cells(self, options, *, batch):
        return [{"number": number} for number in range(options["cells"])]

    def world(self, cell):
        return {}

    def trial(self, cell, robot, log, setting):
        if self.trouble.get(cell["number"]):
            raise self.trouble[cell["number"]].pop(0)
        robot.wait(0.1)
        self.done.append(cell["number"])
        return [
            {"chance": setting.seed_of(cell), "ticks": len(log) > 0, "state": log.records[-1].state}
        ]

    def report(self, rows, setting):
        claim = Claim(
            "R1", "rows come", "all", len(rows), "1", None, len(rows) == setting.options["cells"]
        )
        return Findings([claim], {"sum": sum(row["chance"] for row in rows)}, {"note.txt": "kept"})


@pytest.fixture
def toy(monkeypatch):
    from matplotlib.figure import Figure

    experiment = Toy()
    monkeypatch.setitem(
        table.ROBOT,
        "toy",
        table.Entry("a toy", (table.Option("cells", COUNT, 1, 100, "how many"),), ("R1",)),
    )
    monkeypatch.setattr(run, "PAUSE_S", 0.1)
    monkeypatch.setitem(sys.modules, "host.experiments.robot.toy", experiment)
    monkeypatch.setitem(
        sys.modules,
        "host.figures.robot.toy",
        types.SimpleNamespace(draw=lambda rows, findings: Figure()),
    )
    return experiment


@pytest.fixture
def desk(tmp_path, monkeypatch):
    """The URI and the process of a robot on the desk, whose token this host has."""
    monkeypatch.setenv("KICK_TOKEN", str(tmp_path / "token"))
    with desk_robot(tmp_path) as (uri, process):
        yield uri, process


def results(folder):
    """What every file holds that a run leaves behind, its raw logs apart."""
    return {
        path.name: path.read_bytes()
        for path in folder.iterdir()
        if path.is_file() and path.suffix != ".svg"
    }


@pytest.mark.parametrize("cut", range(COUNT))
def test_a_run_that_was_interrupted_anywhere_comes_to_the_same(toy, tmp_path, cut):
    whole = perform("toy", "sim://", out=tmp_path / "whole")
    toy.trouble = {cut: [KeyboardInterrupt()]}
    with pytest.raises(KeyboardInterrupt) as interrupt:
        perform("toy", "sim://", out=tmp_path / "cut")
    (note,) = interrupt.value.__notes__
    assert f"{cut} of {COUNT} cells complete in" in note
    assert "resumes the run" in note
    toy.done.clear()
    resumed = perform("toy", "sim://", out=tmp_path / "cut")
    assert toy.done == list(range(cut, COUNT))
    assert resumed["numbers"] == whole["numbers"]
    one, other = (results(Path(summary["folder"])) for summary in (whole, resumed))
    del one["summary.json"], other["summary.json"]  # they name their folders
    assert one == other


def test_a_killed_process_goes_on_where_it_was(kickctl, tmp_path):
    """Killed in the middle of its work, the result is that of a run that was not."""
    arguments = ["--json", "experiment", "reliability", "--trials", "3"]
    command = [sys.executable, "-m", "host", *arguments]
    folder = tmp_path / "killed"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(
        [*command, "--out", str(folder)], cwd=tmp_path, env=environment, stderr=subprocess.DEVNULL
    ) as process:
        while process.poll() is None and not size(folder):
            time.sleep(0.001)
        process.send_signal(signal.SIGKILL)
    assert process.returncode == -signal.SIGKILL
    status, out, err = kickctl(*arguments, "--out", str(folder))
    assert status in (0, 1), err
    resumed = json.loads(out)
    status, out, err = kickctl(*arguments, "--out", str(tmp_path / "whole"))
    assert status in (0, 1), err
    whole = json.loads(out)
    assert resumed["numbers"] == whole["numbers"]
    for path, other in zip(resumed["tables"], whole["tables"], strict=True):
        assert Path(path).read_bytes() == Path(other).read_bytes()


def size(folder):
    return sum(path.stat().st_size for path in folder.glob("*/cells.jsonl"))


@pytest.mark.usefixtures("drawn")
def test_reliability_ends_with_its_claims_and_files(kickctl):
    status, out, err = kickctl("experiment", "reliability", "--trials", "25", "--json")
    summary = json.loads(out)
    assert status == 0, err
    assert [claim["id"] for claim in summary["claims"]] == ["R8", "R9", "R10"]
    assert all(claim["holds"] for claim in summary["claims"])
    assert summary["seed"] == 1
    rows = Path(summary["tables"][0]).read_text().splitlines()
    assert len(rows) == 1 + summary["trials"] == 1 + 31 * 2 * 25
    assert all(Path(figure).stat().st_size > 10000 for figure in summary["figures"])
    assert json.loads((Path(summary["folder"]) / "summary.json").read_text()) == summary
    status, out, err = kickctl("experiment", "reliability", "--trials", "25")
    assert "31 of 31 cells complete" in err
    assert "R9 holds" in out


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (("experiment", "reliability", "--trials", "0"), 2, "trials cannot be 0"),
        (("experiment", "reliability", "--trials", "many"), 2, "trials cannot be 'many'"),
        (("experiment", "reliabilty"), 2, "invalid choice"),
        (("experiment", "reliability", "--brick", "ftp://x"), 2, "no address of a robot"),
        (("experiment", "reliability", "--brick", "sim://?motor=none"), 2, "none"),
        (
            ("experiment", "reliability", "--brick", "sim://?battery=much"),
            2,
            "battery cannot be 'much'",
        ),
        (
            ("experiment", "reliability", "--brick", "tcp://127.0.0.1:1"),
            3,
            "no robot's program runs",
        ),
        (
            (
                "experiment",
                "reliability",
                "--brick",
                "tcp://127.0.0.1:1",
                "--scheduler",
                "tcp://127.0.0.1:2",
            ),
            2,
            "--scheduler",
        ),
        (("experiment", "reliability", "--brick", "sim://?walls=2.0"), 2, "says walls"),
        (
            ("experiment", "reliability", "--brick", "sim://?battery=0.5"),
            1,
            "0 rolled forward and 0 backward",
        ),
        (
            ("experiment", "reliability", "--scheduler", "bogus"),
            2,
            "no address of a Dask scheduler",
        ),
        (("reproduce", "--only", "R99"), 2, "there is no claim R99"),
    ],
)
def test_wrong_use_is_told_in_words(kickctl, arguments, status, words):
    done, _, err = kickctl(*arguments)
    assert done == status
    assert words in err
    assert "Traceback" not in err


def test_on_a_robot_a_try_into_which_a_fault_came_is_repeated_and_counted_apart(
    toy, desk, tmp_path
):
    toy.trouble = {2: [RobotFault("its cable came off"), RobotFault("its cable came off")]}
    summary = perform("toy", desk[0], out=tmp_path)
    assert summary["spoiled"] == ["its cable came off"] * 2
    assert summary["trials"] == COUNT
    assert toy.done == list(range(COUNT))
    assert len(list(Path(summary["logs"]).glob("*.mcap"))) == COUNT


def test_a_robot_that_stays_in_fault_ends_the_run_and_keeps_what_was_measured(toy, desk, tmp_path):
    toy.trouble = {2: [RobotFault("its cable came off")] * run.TRIES}
    with pytest.raises(RobotFault) as fault:
        perform("toy", desk[0], out=tmp_path)
    assert f"2 of {COUNT} cells complete" in fault.value.__notes__[-1]
    assert perform("toy", desk[0], out=tmp_path)["trials"] == COUNT


def test_a_link_that_ends_in_the_middle_is_told_and_what_was_measured_kept(
    toy, desk, tmp_path, monkeypatch
):
    monkeypatch.setattr("host.client.connection.Connection.reconnect_s", 0.5)
    uri, process = desk
    real = toy.trial

    def trial(cell, robot, log, setting):
        if cell["number"] == 3:
            process.kill()
            process.wait()
        return real(cell, robot, log, setting)

    toy.trial = trial
    with pytest.raises(NoLink, match="did not come back") as loss:
        perform("toy", uri, out=tmp_path)
    assert f"3 of {COUNT} cells complete" in loss.value.__notes__[-1]


def test_a_robot_that_runs_other_code_is_refused_before_anything_moves(
    toy, desk, tmp_path, monkeypatch
):
    monkeypatch.setattr(run, "of_robot", lambda: "0123456789abcdef")
    with pytest.raises(NotDone, match="other sources than this host") as refused:
        perform("toy", desk[0], out=tmp_path)
    assert "deploy" in refused.value.hint
    assert toy.done == []


def test_a_robot_that_does_not_say_its_sources_is_taken_as_it_is():
    run._require_same_sources(types.SimpleNamespace(hello={"software": "0.1.0"}))


def test_a_try_in_which_the_robots_program_began_anew_does_not_count(
    toy, desk, tmp_path, monkeypatch
):
    real = toy.trial
    broken = []

    def trial(cell, robot, log, setting):
        rows = real(cell, robot, log, setting)
        if cell["number"] == 1 and not broken:
            broken.append(log)
            log.take_event({"event": "restart", "tick": 0})
        return rows

    toy.trial = trial
    summary = perform("toy", desk[0], out=tmp_path)
    assert len(summary["spoiled"]) == 1
    assert "restarted" in summary["spoiled"][0]
    assert toy.done == [0, 1, 1, 2, 3, 4, 5]


@pytest.mark.parametrize("fails", [False, True])
def test_a_robot_is_measured_with_the_papers_parameters_and_gets_its_own_back(
    toy, desk, tmp_path, fails
):
    from host.client.robot import connect

    own = {"k": 2.0, "tick_s": 0.02, "tau_s": 0.5, "max_duty_pct": 20.0}
    with connect(desk[0]) as robot:
        robot.set(**own)
    seen = []
    real = toy.trial

    def trial(cell, robot, log, setting):
        params = robot.status()["params"]
        seen.append(tuple(params[name] for name in own))
        robot.set(k=1.0, tau_s=1.0)  # as an experiment may
        return real(cell, robot, log, setting)

    toy.trial = trial
    if fails:
        toy.trouble = {2: [NotDone("it does not run")] * run.TRIES}
    with pytest.raises(NotDone) if fails else nullcontext():
        perform("toy", desk[0], out=tmp_path)
    assert seen == [(8.0, 0.03, 0.25, 85.0)] * (2 + run.TRIES if fails else COUNT)
    with connect(desk[0]) as robot:
        params = robot.status()["params"]
    assert {name: params[name] for name in own} == own


def test_a_simulated_robots_seed_may_stand_in_its_address(toy, tmp_path):
    summaries = [
        perform("toy", uri, seed, out=tmp_path)
        for uri, seed in (("sim://?seed=7", None), ("sim://", 7), ("sim://", 8))
    ]
    assert [summary["seed"] for summary in summaries] == [7, 7, 8]
    assert summaries[0]["numbers"] == summaries[1]["numbers"] != summaries[2]["numbers"]


@pytest.mark.parametrize("named", [True, False])
def test_no_real_robot_is_sent_against_a_wall_that_nobody_has_built(monkeypatch, tmp_path, named):
    from host.perform import reproduce

    asked = []

    def perform(name, uri, *_, **__):
        asked.append((name, uri))
        claims = [
            Claim(number, "", "", 1.0, "1", None, True).as_dict()
            for number in table.TABLE[name].claims
        ]
        return {
            "claims": claims,
            "brick": uri,
            "seed": 1,
            "version": "",
            "commit": "",
            "figures": [str(figure)],
            "experiment": name,
            "options": {},
        } | ({"spoiled": [], "trials": 1, "folder": ""})

    figure = tmp_path / "figure.png"
    figure.write_bytes(b"")
    monkeypatch.setattr(reproduce, "perform", perform)
    monkeypatch.setenv("KICK_BRICK", "tcp://robot:5425")
    done = reproduce.reproduce(only=["R13"] if named else [], out=tmp_path)
    assert {uri for _, uri in asked} == {"tcp://robot:5425"}
    assert ("wall" in {name for name, _ in asked}) == named
    assert ("R13" in done.skipped) == (not named)


def test_after_an_experiment_the_robot_stands_still(toy, desk, tmp_path):
    from host.client.robot import connect

    perform("toy", desk[0], out=tmp_path)
    with connect(desk[0]) as robot:
        assert robot.status()["state"] == "stopped"


@pytest.mark.usefixtures("drawn")
def test_reproduce_writes_one_page_with_table_and_figures(kickctl):
    status, out, _ = kickctl("reproduce", "--only", "r8,R10", "--json")
    claims, at_preset = (json.loads(out)[name] for name in ("claims", "at_preset"))
    assert status == 0
    assert [claim["id"] for claim in claims] == ["R8", "R10"]
    assert [(claim["id"], claim["holds"]) for claim in at_preset] == [("R8", True), ("R10", True)]
    assert set(claims[0]) == {
        "id",
        "claim",
        "paper",
        "measured",
        "unit",
        "interval",
        "holds",
        "verdict",
        "note",
    }
    page = Path("results/report-R8-R10.html").read_text()
    assert page.count("<img") == page.count("data:image/png;base64,") == 2
    assert "http" not in page
    for claim in claims:
        assert f"<td>{claim['id']}</td>" in page
