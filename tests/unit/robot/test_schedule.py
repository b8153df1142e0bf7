"""The garbage collector's own hours. tests/sysfs/test_one_core.py is about priorities."""

import gc
import weakref

import pytest

from robot.schedule import COLLECT_S, Collector
from tests.rig import Rig


class Circle:
    """Something that only a collector finds to be garbage."""

    def __init__(self):
        self.itself = self


@pytest.fixture
def collector():
    collector = Collector()
    yield collector
    collector.close()
    assert gc.isenabled()


def test_python_looks_for_no_garbage_by_itself_while_the_loop_runs(collector):
    assert not gc.isenabled()


def test_garbage_is_found_once_a_second_and_not_between(collector):
    rig = Rig()
    collector.serve(rig.loop)
    circle = weakref.ref(Circle())
    rig.clock.time += 0.9 * COLLECT_S
    collector.serve(rig.loop)
    assert circle() is not None
    rig.clock.time += 0.2 * COLLECT_S
    collector.serve(rig.loop)
    assert circle() is None
