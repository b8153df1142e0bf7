"""Cells that are computed side by side, one process for each core."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from multiprocessing import active_children

import pytest

from host.errors import NotDone
from host.runs.contract import Part
from host.runs.processes import compute_in_processes
from tests.unit.runs.cells import calls, counting


@pytest.fixture(autouse=True)
def _two_cores(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 1})


def test_cells_side_by_side_come_to_the_same_as_one_by_one():
    found = dict(compute_in_processes(calls, [abs, float, str], -3))
    assert found == {abs: Part([3]), float: Part([-3.0]), str: Part(["-3"])}
    assert dict(compute_in_processes(calls, [abs], -3)) == {abs: Part([3])}


@pytest.mark.parametrize("cells", [[3], [3, 2, 1]])
def test_parts_of_cells_come_one_by_one_and_on_from_those_that_are_kept(cells):
    kept = {3: [1], 2: [], 1: []}
    states = {3: Part([1], 1, 1 / 3)}
    shares = {cell: [] for cell in cells}
    for cell, part in compute_in_processes(counting, cells, None, states.get):
        kept[cell] += part.rows
        states[cell] = part
        shares[cell].append(part.share)
    assert {cell: kept[cell] for cell in cells} == {
        cell: list(range(1, cell + 1)) for cell in cells
    }
    assert shares[3] == [2 / 3, 1.0]


def test_work_that_is_broken_off_leaves_no_process_behind():
    """What sleeps for an hour is not waited for."""
    work = compute_in_processes(calls, [float, time.sleep], 3600.0)
    assert next(work) == (float, Part([3600.0]))
    left = active_children()
    work.close()
    for process in left:
        process.join(30)
    assert [process.is_alive() for process in left] == [False] * 2


def test_a_process_that_dies_is_an_error_in_words():
    with pytest.raises(NotDone, match="ended a process"):
        list(compute_in_processes(calls, [os._exit, float], 3))


def test_an_error_in_a_cell_is_that_error_here():
    with pytest.raises(ValueError, match="'x'"):
        list(compute_in_processes(calls, [float, int], "x"))


def test_processes_end_when_the_first_one_is_killed(tmp_path):
    """Their common standard output ends when the last of them does."""
    script = tmp_path / "script.py"
    script.write_text(
        "import os, time\n"
        "from host.runs import processes\n"
        "def work(cell, setting, begun):\n"
        "    os.write(1, b'works\\n')\n"
        "    time.sleep(3600.0)\n"
        "if __name__ == '__main__':\n"
        "    os.sched_getaffinity = lambda pid: {0, 1}\n"
        "    list(processes.compute_in_processes(work, [1, 2], None))\n"
    )
    with subprocess.Popen([sys.executable, str(script)], stdout=subprocess.PIPE) as first:
        try:
            assert first.stdout.readline() == b"works\n"
        finally:
            first.kill()
        first.stdout.read()


def test_a_script_without_a_main_block_gets_the_remedy(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import operator, os\n"
        "from host.errors import NotDone\n"
        "from host.runs import processes\n"
        "os.sched_getaffinity = lambda pid: {0, 1}\n"
        "try:\n"
        "    list(processes.compute_in_processes(operator.mul, [1, 2], 3))\n"
        "except NotDone as error:\n"
        "    print(error.hint)\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert "__name__ == '__main__'" in done.stdout


def test_a_process_hears_no_interrupt_from_its_first_step_on():
    mask = partial(signal.pthread_sigmask, signal.SIG_BLOCK)
    before = mask([])
    found = dict(compute_in_processes(calls, [mask, tuple], []))
    assert signal.SIGINT in found[mask].rows[0]
    assert mask([]) == before


def test_nor_does_the_first_one_of_a_program():
    """With it Python's tracker of resources begins, which a test before may have begun here."""
    script = (
        "import signal\n"
        "from concurrent.futures import ProcessPoolExecutor\n"
        "from multiprocessing import get_context\n"
        "from host.runs.processes import beginning_processes\n"
        "with beginning_processes():\n"
        "    pool = ProcessPoolExecutor(1, get_context('spawn'))\n"
        "    mask = pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, [])\n"
        "print(*mask.result())\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert str(int(signal.SIGINT)) in done.stdout.split()
