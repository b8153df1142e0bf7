"""robot.show() and log.show(): what they take, and what they hand to a notebook."""

import re
import sys
from types import SimpleNamespace

import pytest

import kickctl
from host.lab import widgets
from host.lab.page_files import page_modules
from host.util.installation import install_command


@pytest.fixture(scope="module")
def log():
    with kickctl.connect("sim://", seed=1) as robot:
        return robot.record(1)


@pytest.fixture
def displayed(monkeypatch):
    """What is displayed in a notebook."""
    displayed = []
    monkeypatch.setattr(widgets, "get_ipython", lambda: SimpleNamespace(kernel=object()))
    monkeypatch.setattr(widgets, "display", displayed.append)
    yield displayed
    for widget in displayed:
        widget.close()


def test_outside_of_a_notebook_it_says_what_shows_robots_and_logs_there(log):
    with kickctl.connect("sim://") as robot, pytest.raises(kickctl.WrongUse) as error:
        robot.show()
    assert "kickctl lab" in error.value.hint
    with pytest.raises(kickctl.WrongUse, match="in a notebook") as error:
        log.show()
    assert "--replay" in error.value.hint


def test_without_the_extra_it_says_what_to_type(log, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(kickctl.WrongUse, match="anywidget") as error:
        log.show()
    assert install_command("notebook") in error.value.hint


def test_every_log_of_a_robot_can_be_shown(log, tmp_path):
    assert type(log) is kickctl.Log
    assert type(kickctl.Log.load(log.save(tmp_path / "a.mcap"))) is kickctl.Log
    with kickctl.connect("sim://") as robot, robot.recording() as growing:
        assert type(growing) is kickctl.Log


def test_a_log_is_shown_from_its_own_records_or_a_part_of_them(log, displayed):
    log.show()
    log.show(from_s=0.5)
    whole, part = (widget.tape for widget in displayed)
    assert (whole["ticks"], whole["part"]) == (len(log), "")
    assert 0 < part["ticks"] < len(log)
    with pytest.raises(kickctl.WrongUse, match="no tick in this part") as error:
        log.show(from_s=100)
    assert "log.show(from_s=0" in error.value.hint
    with pytest.raises(kickctl.WrongUse, match="from_s"):
        log.show(from_s="1")
    with pytest.raises(kickctl.WrongUse, match="is later than to_s"):
        log.show(from_s=0.8, to_s=0.2)
    with pytest.raises(kickctl.WrongUse, match="this log is empty"):
        kickctl.Log(log.info).show()


def test_a_robot_that_is_shown_follows_its_connection(displayed):
    with kickctl.connect("sim://", seed=1) as robot:
        robot.show()
        robot.wait(1)
        (widget,) = displayed
        assert widget.shown.ring.end > 30


def test_a_closed_robot_is_not_shown(displayed):
    robot = kickctl.connect("sim://")
    robot.close()
    with pytest.raises(kickctl.NoLink, match="closed"):
        robot.show()
    assert displayed == []


@pytest.mark.parametrize("first", ["notebook_robot.js", "notebook_log.js"])
def test_a_widgets_program_has_each_module_behind_all_that_it_imports(first):
    modules = page_modules(first)
    assert list(modules)[-1] == first
    assert {"draw/wheel.js", "draw/plane.js", "draw/strips.js"} <= set(modules)
    there = set()
    for path, text in modules.items():
        assert set(re.findall(r'"lab/([\w./]+)"', text)) <= there, path
        there.add(path)
