"""What a log and a terminal learn of long work, and when they learn how long it still takes."""

import io
import sys

import pytest

from host.util import progress


@pytest.fixture
def run(monkeypatch):
    """Does steps: each pair says how long a step takes (s), and how much is done at its end."""

    def run_steps(total, steps, at_start=0.0):
        now_s = 1000.0
        monkeypatch.setattr(progress.time, "monotonic", lambda: now_s)
        with progress.progress("work", total) as advance:
            if at_start is not None:
                advance(at_start)
            for seconds, done in steps:
                now_s += seconds
                advance(done)

    return run_steps


def test_a_log_gets_a_line_now_and_then_with_the_time_left(capsys, monkeypatch):
    now_s = 1000.0
    monkeypatch.setattr(progress.time, "monotonic", lambda: now_s)
    with progress.progress("work", 40) as advance:
        # Ten pieces were done in an earlier run; each of these takes 8 s.
        for done in range(10, 41):
            advance(done)
            now_s += 8.0
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "work: 14 of 40, about 3 min left"
    assert lines[1] == "work: 18 of 40, about 3 min left"
    assert lines[-1] == "work: 38 of 40, about 16 s left"
    assert len(lines) == 7


def test_short_work_says_nothing(capsys):
    with progress.progress("work", 3) as advance:
        for done in range(4):
            advance(done)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("begun", [0, 10], ids=["first run", "resumed"])
def test_what_is_compiled_once_is_no_step_of_the_estimate(run, capsys, begun):
    steps = [(90.0, begun + 1), *((8.0, begun + done) for done in range(2, 31))]
    run(begun + 30, steps, begun)
    lines = capsys.readouterr().err.splitlines()
    total = begun + 30
    # Two lines come before the later steps have taken half of the 90 s.
    assert lines[0] == f"work: {begun + 1} of {total}"
    assert lines[1] == f"work: {begun + 5} of {total}"
    assert lines[2] == f"work: {begun + 9} of {total}, about 3 min left"
    assert all(" left" in line for line in lines[2:])


def test_a_simulation_that_first_compiles_has_no_time_left_of_hours(run, capsys):
    steps = [(68.0, 0.01), *((0.005, done / 100) for done in range(2, 300))]
    run(3, steps, at_start=None)
    assert capsys.readouterr().err == "work: 0 of 3\n"


def test_first_steps_that_end_together_do_not_look_fast(run, capsys):
    """Sixteen workers, each with cells of a minute."""
    steps = [
        (60.0 if worker == 0 else 0.1, 16.0 * turn + worker + 1)
        for turn in range(4)
        for worker in range(16)
    ]
    run(64, steps)
    lines = capsys.readouterr().err.splitlines()
    assert lines[:2] == ["work: 1 of 64", "work: 17 of 64, about 3 min left"]


def test_a_terminal_says_the_time_that_a_log_says(run, monkeypatch):
    """Also for steps of a minute: rich by itself forgets steps of more than 30 s ago."""

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setattr(sys, "stderr", Terminal())
    run(10, [(90.0, 1), (60.0, 2)])
    assert "about 8 min left" in sys.stderr.getvalue()
