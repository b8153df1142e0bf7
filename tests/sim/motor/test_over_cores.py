"""Work that is spread over all cores."""

from threading import Barrier

import pytest

from sim_motor.compiled import on_one_core, over_cores

# The work of some core does not begin before that of all others has, or fails.
PATIENCE_S = 30.0


@pytest.mark.parametrize("count", [0, 1, 2, 3, 100])
def test_each_part_is_done_once(count):
    done = []
    over_cores(lambda core, cores: done.extend(range(core, count, cores)), count)
    assert sorted(done) == list(range(count))


def test_cores_work_side_by_side():
    parts, shares = 1000, []
    over_cores(lambda core, cores: shares.append(cores), parts)
    together = Barrier(shares[0])
    over_cores(lambda core, cores: together.wait(PATIENCE_S), parts)
    assert shares == [len(shares)] * len(shares)


def test_no_more_cores_are_taken_than_there_are_parts_or_than_are_allowed():
    shares = []
    over_cores(lambda core, cores: shares.append((core, cores)), 1)
    with on_one_core():
        over_cores(lambda core, cores: shares.append((core, cores)), 100)
    assert shares == [(0, 1), (0, 1)]


def test_who_calls_hears_of_a_failure():
    def work(core, cores):
        if core == cores - 1:
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        over_cores(work, 100)
