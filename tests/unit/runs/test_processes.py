"""Cells that are computed side by side, one process for each core."""

import operator
import os
import time
from multiprocessing import active_children

import pytest

from host.errors import NotDone
from host.runs import processes


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 1})


def test_cells_side_by_side_come_to_the_same_as_one_by_one():
    found = dict(processes.compute_in_processes(operator.call, [abs, float, str], -3))
    assert found == {abs: 3, float: -3.0, str: "-3"}
    assert dict(processes.compute_in_processes(operator.call, [abs], -3)) == {abs: 3}


def test_work_that_is_broken_off_leaves_no_process_behind():
    """What sleeps for an hour is not waited for."""
    work = processes.compute_in_processes(operator.call, [float, time.sleep], 3600.0)
    assert next(work) == (float, 3600.0)
    left = active_children()
    work.close()
    for process in left:
        process.join(30)
    assert [process.is_alive() for process in left] == [False] * 2


def test_a_process_that_dies_is_an_error_in_words():
    with pytest.raises(NotDone, match="ended a process"):
        list(processes.compute_in_processes(operator.call, [os._exit, float], 3))


def test_an_error_in_a_cell_is_that_error_here():
    with pytest.raises(ZeroDivisionError):
        list(processes.compute_in_processes(operator.truediv, [1, 2], 0))
