"""A lab's threads run before other programs, if the system grants it; what they start does not."""

import os
import subprocess
import sys
import threading

import pytest

from host.lab.server import Lab
from host.lab.urgent import PRIORITY, UrgentThread
from robot.schedule import LOOP_PRIORITY
from tests.lab.live import station_at

POLICY = "import os; print(os.sched_getscheduler(0), os.nice(0))"
# Whether this user may have real-time priority is asked of a process that ends with it.
MAY = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))"


@pytest.fixture(scope="module")
def granted():
    asked = subprocess.run([sys.executable, "-c", MAY], check=False, stderr=subprocess.DEVNULL)
    return asked.returncode == 0


def found_in(thread_class):
    """What a thread finds: (its policy, its priority, what a process that it starts finds)."""
    found = []

    def look():
        policy = os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK
        child = subprocess.check_output([sys.executable, "-c", POLICY], text=True)
        found.extend((policy, os.sched_getparam(0).sched_priority, child.split()))

    thread = thread_class(target=look)
    thread.start()
    thread.join()
    return found


def test_a_thread_comes_before_other_programs_and_after_the_robot(granted):
    policy, priority, child = found_in(UrgentThread)
    assert (policy, priority) == ((os.SCHED_FIFO, PRIORITY) if granted else (os.SCHED_OTHER, 0))
    assert priority < LOOP_PRIORITY
    # Nor is it nicer, or less so, than one that an ordinary thread starts.
    assert child == found_in(threading.Thread)[2]
    assert child[0] == str(os.SCHED_OTHER)


def test_all_threads_that_a_stop_goes_through_come_first(desk, granted):
    with station_at(desk.uri, desk.token) as station, Lab([station], port=0):
        policies = {
            thread.name: os.sched_getscheduler(thread.native_id)
            for thread in threading.enumerate()
            if thread.name == "lab server" or thread.name.endswith(" anna")
        }
    first = os.SCHED_FIFO | os.SCHED_RESET_ON_FORK if granted else os.SCHED_OTHER
    names = ("lab server", "lab watch anna", "lab drive anna", "lab stop anna")
    assert policies == dict.fromkeys(names, first)


def test_its_caller_stays_as_it_is():
    before = os.sched_getscheduler(0)
    found_in(UrgentThread)
    assert os.sched_getscheduler(0) == before


def test_where_it_is_not_granted_it_runs_all_the_same(monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert found_in(UrgentThread)[:2] == [os.SCHED_OTHER, 0]


def test_where_there_is_no_schedule_to_set_it_runs_all_the_same(monkeypatch):
    monkeypatch.delattr(os, "SCHED_FIFO")
    assert found_in(UrgentThread)[:2] == [os.SCHED_OTHER, 0]
