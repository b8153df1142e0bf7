"""What holds for every experiment on simulated cars and trains."""

import importlib
import json
import sys
from typing import get_args

import pytest

from host.errors import WrongUse
from host.experiments.bodies import train_kick
from host.experiments.registry import BODIES, TABLE
from host.perform.run import perform
from host.util.installation import install_command
from tests.paper.bodies.short_runs import has_columns_of, module, plain, setting


@pytest.mark.parametrize("name", BODIES)
def test_cells_are_plain_data_and_no_two_are_the_same(name):
    cells = module(name).cells(setting(name).options, batch=True)
    assert plain(cells) == cells
    assert len({json.dumps(cell, sort_keys=True) for cell in cells}) == len(cells)


# train-goal takes longer, as its train must learn: test_train_goal.py.
@pytest.mark.parametrize("name", [name for name in BODIES if name != "train-goal"])
def test_a_short_run_ends_in_rows_numbers_and_a_figure(name, monkeypatch):
    """One cell of each kind of row is run, and stands for all others."""
    monkeypatch.setattr(train_kick, "START_S", 0.5)
    monkeypatch.setattr(train_kick, "WATCH_S", 0.5)
    experiment, chosen = module(name), setting(name)
    kinds_of_rows = get_args(experiment.Row) or (experiment.Row,)
    by_kind = {}
    for cell in experiment.cells(chosen.options, batch=True):
        by_kind.setdefault((*cell, cell.get("part")), []).append(cell)
    shown = getattr(experiment, "SHOWN", ({},))[0]
    rows = []
    for alike in by_kind.values():
        first = next((cell for cell in alike if shown.items() <= cell.items()), alike[0])
        results = experiment.simulate(first, chosen)
        assert plain(results) == results
        rows += [{**cell, **result} for cell in alike for result in results]
    for row in rows:
        assert sum(has_columns_of(row, kind) for kind in kinds_of_rows) == 1
    findings = experiment.report(rows, chosen)
    assert [claim.id for claim in findings.claims] == list(TABLE[name].claims)
    assert plain(findings.numbers) == findings.numbers
    figures = importlib.import_module("host.figures.bodies." + name.replace("-", "_"))
    figure = figures.draw(rows, findings)
    figure.canvas.draw()
    assert all(axes.has_data() for axes in figure.axes)


@pytest.mark.parametrize("name", ["car-slope", "train-kick"])
def test_a_robot_is_refused_before_anything_runs(name, tmp_path):
    with pytest.raises(WrongUse, match="simulated cars"):
        perform(name, "tcp://127.0.0.1:1", out=tmp_path)
    assert list(tmp_path.glob("*-*")) == []


def test_without_mujoco_its_extra_is_named_before_anything_runs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(WrongUse) as refused:
        perform("train-start", out=tmp_path)
    assert install_command("bodies") in refused.value.hint
    assert list(tmp_path.glob("*-*")) == []
