"""What a log learns of long work; terminals have a bar."""

from host.util import progress


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
