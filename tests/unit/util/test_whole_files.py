"""Files appear under their names only when they are whole; else what was there before stays."""

import errno
import os
import subprocess
import sys
import threading

import pytest

from host.util.whole_files import FileTaken, descriptor_of, naming, whole_file, write_text
from tests.lint.sources import ROOT


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_file_appears_when_it_is_whole(tmp_path):
    path = tmp_path / "table.csv"
    with whole_file(path) as draft:
        draft.write_text("half")
        assert not path.exists()
        assert draft.suffix == ".csv"
        draft.write_text("whole")
    assert path.read_text() == "whole"
    assert names(tmp_path) == ["table.csv"]


@pytest.mark.parametrize("end", [ValueError, KeyboardInterrupt, OSError])
@pytest.mark.parametrize("new", [True, False])
def test_whoever_fails_leaves_what_was_there(tmp_path, end, new):
    path = tmp_path / "table.csv"
    if not new:
        path.write_text("old")

    def fail():
        with whole_file(path, new=new) as draft:
            draft.write_text("half")
            raise end

    with pytest.raises(end):
        fail()
    assert names(tmp_path) == ([] if new else ["table.csv"])
    assert new or path.read_text() == "old"


def test_a_block_that_writes_nothing_changes_nothing(tmp_path):
    with whole_file(tmp_path / "film.gif"):
        pass
    assert names(tmp_path) == []


def test_a_link_keeps_pointing_to_its_file_and_a_file_keeps_its_mode(tmp_path):
    path, link = tmp_path / "file", tmp_path / "link"
    path.write_text("old")
    path.chmod(0o640)
    link.symlink_to(path)
    write_text(link, "new")
    assert link.is_symlink()
    assert path.read_text() == "new"
    assert path.stat().st_mode & 0o777 == 0o640


def test_a_new_file_has_the_mode_that_the_user_gives_to_files(tmp_path):
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "file", "new")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o640


def test_a_pipe_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()))
    reader.start()
    write_text(pipe, "through it")
    reader.join()
    assert read == ["through it"]
    assert pipe.is_fifo()


_TO_STANDARD_OUTPUT = """
import sys
from host.util.whole_files import write_text
print("words before it")
write_text(sys.argv[1], "through it\\n")
"""


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"])
@pytest.mark.parametrize("kind", ["pipe", "file"])
def test_standard_output_is_written_to_whatever_is_behind_it(tmp_path, name, kind):
    """A file that standard output appends to is neither emptied nor replaced."""
    (tmp_path / "link").symlink_to("/dev/stdout")
    behind = tmp_path / "behind"
    behind.write_text("there before\n")
    command = [sys.executable, "-c", _TO_STANDARD_OUTPUT, name]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with behind.open("a") as file:
        out = subprocess.PIPE if kind == "pipe" else file
        done = subprocess.run(
            command, cwd=tmp_path, env=environment, stdout=out, text=True, check=True
        )
    text = done.stdout if kind == "pipe" else behind.read_text().removeprefix("there before\n")
    assert text == "words before it\nthrough it\n"
    assert behind.read_text().startswith("there before\n")
    assert names(tmp_path) == ["behind", "link"]


def test_a_file_that_is_open_is_no_descriptor(tmp_path):
    with (tmp_path / "1").open("w"):
        assert descriptor_of(tmp_path / "1") is None
    assert descriptor_of("/dev/null") is None
    assert descriptor_of("/proc/1/fd/1") is None


def test_a_folder_is_refused_before_anything_is_written(tmp_path):
    with pytest.raises(IsADirectoryError), whole_file(tmp_path):
        raise AssertionError("the block has begun")


def test_errors_name_the_file_and_not_the_draft(tmp_path):
    with pytest.raises(FileNotFoundError) as nowhere:
        write_text(tmp_path / "nowhere" / "file", "text")
    assert nowhere.value.filename == str(tmp_path / "nowhere" / "file")
    full = OSError(errno.ENOSPC, "No space left on device")
    with pytest.raises(OSError, match="No space") as caught, naming(tmp_path / "file"):
        raise full
    assert caught.value.filename == str(tmp_path / "file")


@pytest.mark.parametrize("links", [True, False])
def test_of_many_writers_of_one_new_name_one_gets_it(tmp_path, monkeypatch, links):
    """Some file systems, such as FAT, have no hard links."""
    if not links:

        def link(source, target):
            raise OSError(errno.EPERM, "Operation not permitted")

        monkeypatch.setattr(os, "link", link)
    barrier, refused = threading.Barrier(8), []

    def write(number):
        try:
            with whole_file(tmp_path / "log", new=True) as draft:
                draft.write_text(str(number))
                barrier.wait()
        except FileTaken:
            refused.append(str(number))

    writers = [threading.Thread(target=write, args=(number,)) for number in range(8)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert len(refused) == 7
    assert (tmp_path / "log").read_text() not in refused
    assert names(tmp_path) == ["log"]
