"""A lab's threads run before other programs, if the system grants it; its computations do not."""

import os
import subprocess
import sys
import threading
from queue import SimpleQueue

import pytest

from host.lab.server import Lab
from host.lab.urgent import PRIORITY, UrgentThread
from host.lab.worker import Worker
from robot.schedule import LOOP_PRIORITY
from tests.lab.live import station_at

ORDINARY = (os.SCHED_OTHER, 0)
# Whether this user may have real-time priority is asked of a process that ends with it.
MAY = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))"


@pytest.fixture(scope="module")
def urgent():
    """The schedule of an urgent thread: (its policy, its priority)."""
    asked = subprocess.run([sys.executable, "-c", MAY], check=False, stderr=subprocess.DEVNULL)
    return ORDINARY if asked.returncode else (os.SCHED_FIFO, PRIORITY)


def schedule(thread=0):
    return os.sched_getscheduler(thread), os.sched_getparam(thread).sched_priority


def in_an_urgent_thread(function):
    """What a function returns there."""
    found = SimpleQueue()
    UrgentThread(target=lambda: found.put(function())).start()
    return found.get(timeout=60.0)


def test_a_thread_comes_before_other_programs_and_after_the_robot(urgent):
    assert in_an_urgent_thread(schedule) == urgent
    assert PRIORITY < LOOP_PRIORITY
    assert schedule() == ORDINARY


def test_a_thread_that_it_starts_does_not_hold_it_up(urgent):
    def start_one():
        found = SimpleQueue()
        threading.Thread(target=lambda: found.put(schedule())).start()
        return found.get(timeout=60.0)

    assert in_an_urgent_thread(start_one) == urgent


def schedule_of_a_process(_):
    return {"schedule": schedule(), "niceness": os.nice(0)}


def test_what_computes_is_an_ordinary_and_nice_process_and_what_brings_its_answers_is_not(urgent):
    worker, answers, before = Worker("computes", 7), SimpleQueue(), set(threading.enumerate())
    try:
        worker.ask(schedule_of_a_process, None, answers.put)
        answer = answers.get(timeout=60.0)
        threads = set(threading.enumerate()) - before
        schedules = [schedule(thread.native_id) for thread in threads]
    finally:
        worker.close()
    assert answer == {"schedule": ORDINARY, "niceness": os.nice(0) + 7}
    assert schedules == [urgent, urgent]


def test_all_threads_that_a_stop_goes_through_come_first(desk, urgent):
    with station_at(desk.uri, desk.token) as station, Lab([station], port=0):
        found = {
            thread.name: schedule(thread.native_id)
            for thread in threading.enumerate()
            if thread.name == "lab server" or thread.name.endswith(" anna")
        }
    names = ("lab server", "lab watch anna", "lab drive anna", "lab stop anna")
    assert found == dict.fromkeys(names, urgent)


def test_where_it_is_not_granted_a_thread_runs_all_the_same(monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert in_an_urgent_thread(schedule) == ORDINARY


def test_where_there_is_no_schedule_to_set_a_thread_runs_all_the_same(monkeypatch):
    monkeypatch.delattr(os, "SCHED_FIFO")
    assert in_an_urgent_thread(schedule) == ORDINARY
