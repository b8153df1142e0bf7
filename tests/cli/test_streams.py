"""kickctl as a process: closed, full and unread streams, closed terminals, and no odd letters."""

import json
import os
import pty
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mcap.reader import make_reader

from host.logs.log import Log
from tests.lint.sources import ROOT


def test_words_for_a_closed_standard_error_are_not_mixed_with_the_answer(shell):
    status, out, _ = shell("kickctl kick --mode phase --seed 1 --json 2>&-")
    assert status == 0
    assert json.loads(out)["reversed"] is True


@pytest.mark.parametrize("json_too", ["", " --json"])
def test_a_closed_standard_output_is_no_log_and_no_traceback(shell, tmp_path, json_too):
    status, _, err = shell(f"kickctl kick --mode phase --seed 1 {json_too} <&- >&-")
    assert status == 1
    assert "standard output cannot be written or read: it is closed" in err
    assert "reversed the robot" in err
    (log,) = (tmp_path / "logs").glob("*.mcap")
    assert f"log logs/{log.name}" in err
    assert "truncated" not in Log.load(log).info


@pytest.mark.parametrize("verb", ["status", "log export log.mcap", "watch --seconds 1 --json"])
def test_an_answer_that_a_closed_standard_output_does_not_take_is_a_failure(shell, kickctl, verb):
    assert kickctl("record", "1", "--seed", "1", "--out", "log.mcap")[0] == 0
    status, _, err = shell(f"kickctl {verb} >&-")
    assert status == 1
    assert "it is closed" in err


@pytest.mark.parametrize("verb", ["status", "kick --mode phase --seed 1", "params list", "--help"])
def test_an_answer_that_cannot_be_written_is_a_failure_in_words(shell, verb):
    status, _, err = shell(f"kickctl {verb} >/dev/full")
    assert status == 1
    assert "standard output cannot be written" in err
    assert "is the disk full?" in err
    assert "log logs/" in err or not verb.startswith("kick")


def test_words_that_cannot_be_written_stop_nothing(shell):
    status, out, _ = shell("kickctl kick --mode phase --seed 1 --json 2>/dev/full")
    assert status == 0
    assert json.loads(out)["reversed"] is True


def test_letters_that_a_terminal_cannot_show_are_shown_as_codes(shell):
    plain = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    # Both wheels go forward, so no plan has to be computed.
    status, out, _ = shell("kickctl plan --to forward --seed 6", **plain)
    assert status == 0
    assert "phase 269\\xb0" in out


def test_a_reader_that_leaves_is_no_error(shell):
    status, _, err = shell("{ kickctl params list; echo $? >&2; } | true")
    assert status == 0
    assert err.splitlines()[-1] in "01"


@pytest.fixture
def begin_recording(tmp_path):
    """A recording in its own process, and its log, as soon as that has grown a little."""
    processes = []

    def begin(**options):
        process = subprocess.Popen(
            [sys.executable, "-m", "host", "record", "900000", "--seed", "1", "--out", "log.mcap"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            **options,
        )
        processes.append(process)
        log = tmp_path / "log.mcap"
        while not (log.exists() and log.stat().st_size > 50_000):
            assert process.poll() is None
            time.sleep(0.01)  # another process writes it
        return process, log

    yield begin
    for process in processes:
        process.kill()


def is_indexed(log):
    with log.open("rb") as file:
        return make_reader(file).get_summary().statistics.message_count > 100


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_recording_that_is_ended_by_a_signal_leaves_an_indexed_log(begin_recording, number):
    process, log = begin_recording(stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for _ in range(5):
        process.send_signal(number)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert b"Traceback" not in err
    assert b"ticks in log.mcap" in out
    assert is_indexed(log)


def test_a_terminal_that_closes_leaves_an_indexed_log(begin_recording):
    terminal, inside = pty.openpty()
    process, log = begin_recording(
        stdin=inside, stdout=inside, stderr=inside, start_new_session=True
    )
    os.close(inside)
    process.send_signal(signal.SIGHUP)  # as a shell does whose terminal closes
    os.close(terminal)
    assert process.wait(60) == 130
    assert is_indexed(log)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_says_130_also_where_nobody_takes_the_answer(begin_recording, number):
    with Path("/dev/full").open("w") as full:
        process, log = begin_recording(stdout=full, stderr=subprocess.PIPE)
        process.send_signal(number)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert b"ticks in log.mcap" in err
    assert is_indexed(log)


def test_nohup_goes_on(begin_recording):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        process, log = begin_recording(stderr=subprocess.DEVNULL)
    finally:
        signal.signal(signal.SIGHUP, before)
    process.send_signal(signal.SIGHUP)
    size = log.stat().st_size
    while log.stat().st_size <= size + 50_000:
        assert process.poll() is None
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    assert process.wait(60) == 130
    assert is_indexed(log)
