"""Compiled functions on disk: the same bits, not another function's, no harm if it fails."""

import json
import os
import pwd
import subprocess
import sys
from pathlib import Path

import pytest

import sim_motor.kept_files
from sim_motor.constants import load
from tests.sim.motor.compiled_line import build, counts, line

ROOT = Path(__file__).parents[3]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """The folder of compiled functions: this test's own."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "numba"))
    sim_motor.kept_files._say_once.cache_clear()
    yield Path(line.__globals__["jit"](lambda: 0)._cache.cache_path)
    sim_motor.kept_files._say_once.cache_clear()


@pytest.fixture
def homeless(monkeypatch):
    """A user without HOME and without an entry in the table of users."""

    def unknown(uid):
        raise KeyError(uid)

    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.setattr(pwd, "getpwuid", unknown)


# Other processes: each has loaded numba, and compiled nothing of ours.
PROCESSES = r"""
import json, os, sys
from numba import njit
from tests.sim.motor.compiled_line import *
number = 0
ready, groups = json.loads(sys.argv[1])
if ready:
    njit(lambda: 0)()
for together in groups:
    for script in together:
        if os.fork() == 0:
            os.write(1, f"{number} {eval(script)}\n".encode())  # whole, beside others' lines
            os._exit(0)
        number += 1
    for _ in together:
        assert os.wait()[1] == 0
"""


def run(*scripts, ready=True):
    """What other processes find: one after the other, those of a list at the same time.

    ready: whether numba has already prepared itself in them, which takes longer than to compile a
    small function.
    """
    groups = [one if isinstance(one, list) else [one] for one in scripts]
    command = [sys.executable, "-c", PROCESSES, json.dumps([ready, groups])]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    lines = [line.partition(" ") for line in done.stdout.splitlines()]
    return [found for _, _, found in sorted(lines, key=lambda line: int(line[0]))]


def test_a_function_is_compiled_once(folder):
    first, again = line(3.0), line(3.0)
    assert (first(2.0), counts(first)) == (6.0, (1, 0))
    assert (again(2.0), counts(again)) == (6.0, (0, 1))
    assert len(list(folder.iterdir())) == 2


def test_each_kind_of_argument_is_kept_by_itself():
    line(3)(2.0)
    again = line(3)
    assert (again(2), type(again(2))) == (6, int)
    assert counts(again) == (1, 0)
    assert again(2.0) == 6.0
    assert counts(again) == (1, 1)


def test_a_change_in_what_went_into_a_function_is_another_function():
    assert [line(factor)(2.0) for factor in (3.0, 4.0, 3.0, 4.0)] == [6.0, 8.0, 6.0, 8.0]


def test_a_change_after_definition_is_neither_kept_nor_missed():
    source = "def f(x):\n    return factor * x"
    for _ in range(2):
        changed, names = build(source, factor=3.0)
        names["factor"] = 5.0
        assert changed(2.0) == 10.0
        assert build(source, factor=3.0)[0](2.0) == 6.0


def test_functions_of_the_same_name_loaded_side_by_side_stay_apart():
    both = "[call(f, 2.0) for f in (line(4.0), line(3.0))]"
    *_, found = run("call(line(3.0), 2.0)", "call(line(4.0), 2.0)", both)
    assert found == "[(8.0, (0, 1)), (6.0, (0, 1))]"


def test_a_warm_start_has_the_same_bits_and_compiles_nothing():
    cold, warm = run("motors_run()", "motors_run()", ready=False)
    assert cold.endswith(" True")
    assert warm == cold.replace("True", "False")


def test_processes_that_compile_at_the_same_time_do_not_harm_each_other(folder):
    scripts = ["call(line(3), 2.0)", "call(line(3), 2)"]
    *at_once, real, whole = run(2 * scripts, *scripts)
    assert [found.partition(",")[0] for found in at_once] == 2 * ["(6.0", "(6"]
    assert (real, whole) == ("(6.0, (0, 1))", "(6, (0, 1))")
    assert len(list(folder.iterdir())) == 4


def test_a_damaged_file_is_compiled_again(folder):
    line(3.0)(2.0)
    for path in folder.iterdir():
        content = bytearray(path.read_bytes())
        content[-200] ^= 1
        path.write_bytes(content)
    again, warm = line(3.0), line(3.0)
    assert (again(2.0), counts(again)) == (6.0, (1, 0))
    assert (warm(2.0), counts(warm)) == (6.0, (0, 1))


def test_where_nothing_can_be_kept_it_is_said_once_and_all_works(capsys, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "file"))
    assert (line(3.0)(2.0), line(4.0)(2.0)) == (6.0, 8.0)
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "compiled functions cannot be kept" in err
    assert "Not a directory" in err


@pytest.mark.parametrize("named", [{}, {"NUMBA_CACHE_DIR": "~/.c"}, {"XDG_CACHE_HOME": "~/.c"}])
def test_without_a_home_folder_nothing_is_kept(capsys, tmp_path, monkeypatch, homeless, named):
    for name in ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name)
    for name, value in named.items():
        monkeypatch.setenv(name, value)
    assert sim_motor.kept_files.place("kind") is None
    assert line(3.0)(2.0) == 6.0
    assert "no home folder" in capsys.readouterr().err
    assert not (tmp_path / "~").exists()


def test_without_a_home_folder_there_are_no_own_motors(tmp_path, monkeypatch, homeless):
    for name in ("KICK_MOTORS", "XDG_CONFIG_HOME"):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(ValueError, match="there is no motor 'mine'"):
        load("mine")


def test_a_home_folder_that_is_named_by_a_tilde_is_found(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "~/own")
    assert sim_motor.kept_files.place("kind") == tmp_path / "own/kickctl/compiled/kind"


def test_a_full_disk_leaves_nothing_behind(capsys, folder, monkeypatch):
    def full(source, target):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    assert line(3.0)(2.0) == 6.0
    assert "No space left on device" in capsys.readouterr().err
    assert list(folder.iterdir()) == []


def test_the_files_that_were_not_used_for_longest_are_removed(folder, monkeypatch):
    for factor in (3.0, 4.0):
        line(factor)(2.0)
    files = list(folder.iterdir())
    for path in files:
        os.utime(path, (1, 1))
    line(3.0)(2.0)
    used = [path for path in files if path.stat().st_mtime > 1]
    assert len(used) == 1
    room = 3.5 * max(path.stat().st_size for path in files)
    monkeypatch.setattr(sim_motor.kept_files, "MOST_BYTES", room)
    line(5.0)(2.0)
    assert [path for path in files if path.exists()] == used


def test_the_files_of_others_are_left_alone(tmp_path, monkeypatch):
    other = tmp_path / "numba" / "other" / "file"
    other.parent.mkdir(parents=True)
    other.write_text("theirs")
    monkeypatch.setattr(sim_motor.kept_files, "MOST_BYTES", 0)
    line(3.0)(2.0)
    assert other.exists()


def test_a_function_that_is_given_functions_is_not_kept(folder):
    apply, _ = build("def f(g, x):\n    return g(x)")
    assert apply(line(3.0), 2.0) == 6.0
    again, _ = build("def f(g, x):\n    return g(x)")
    assert again(line(4.0), 2.0) == 8.0
    assert len(list(folder.iterdir())) == 4
