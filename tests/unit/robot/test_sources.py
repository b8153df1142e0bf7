"""The fingerprint of sources: what changes it, and what does not."""

import os
import shutil

import pytest

from robot.sources import fingerprint, keep, of_robot, times


@pytest.fixture
def room(tmp_path):
    folder = tmp_path / "here" / "room"
    (folder / "inner").mkdir(parents=True)
    (folder / "a.py").write_text("x = 1\n")
    (folder / "inner" / "b.toml").write_text("y = 2\n")
    for name in ("a.py", "inner/b.toml"):
        os.utime(str(folder / name), (1, 1))  # long ago: a file system's clock is coarse
    return folder


def test_it_is_that_of_a_copy_elsewhere(room, tmp_path):
    shutil.copytree(str(room), str(tmp_path / "there" / "room"))
    assert fingerprint(str(room)) == fingerprint(str(tmp_path / "there" / "room"))


@pytest.mark.parametrize(
    "change",
    [
        lambda room: (room / "a.py").write_text("x = 2\n"),
        lambda room: (room / "a.py").rename(room / "c.py"),
        lambda room: (room / "inner" / "b.toml").write_text(""),
        lambda room: (room / "inner" / "new.py").write_text(""),
        lambda room: (room / "inner" / "b.toml").unlink(),
        lambda room: (room / "a.py").rename(room / "inner" / "a.py"),
    ],
)
def test_every_change_of_a_source_changes_it_and_the_times(room, change):
    before = fingerprint(str(room))
    times_before = times(str(room))
    change(room)
    assert fingerprint(str(room)) != before
    assert times(str(room)) != times_before


def test_what_is_no_source_does_not_change_it(room):
    before = fingerprint(str(room))
    (room / "inner" / "a.pyc").write_text("compiled")
    (room / "README.md").write_text("words")
    assert fingerprint(str(room)) == before


def test_hidden_files_are_no_sources(room):
    before = fingerprint(str(room))
    (room / ".#a.py").symlink_to("anna@machine.1234")  # Emacs's lock of a changed file
    (room / ".ipynb_checkpoints").mkdir()
    (room / ".ipynb_checkpoints" / "a-checkpoint.py").write_text("x = 0\n")
    assert fingerprint(str(room)) == before


def test_content_does_not_pass_from_one_file_to_the_next(room):
    (room / "a.py").write_text("12")
    (room / "b.py").write_text("3")
    before = fingerprint(str(room))
    (room / "a.py").write_text("1")
    (room / "b.py").write_text("23")
    assert fingerprint(str(room)) != before


def test_folders_count_in_their_order_and_files_by_themselves(room):
    inner = str(room / "inner")
    assert fingerprint(str(room), inner) != fingerprint(inner, str(room))
    assert fingerprint(str(room / "a.py")) != fingerprint(inner)


def test_the_kept_fingerprint_holds_until_a_source_changes(tmp_path, monkeypatch):
    folder = tmp_path / "robot"
    folder.mkdir()
    source, kept = folder / "a.py", folder / "__pycache__" / "fingerprint"
    source.write_text("x = 1\n")
    monkeypatch.setattr("robot.sources._FOLDER", str(folder))
    monkeypatch.setattr("robot.sources._KEPT", str(kept))
    keep()
    kept.write_text(kept.read_text().replace(fingerprint(str(folder)), "as kept"))
    assert of_robot() == "as kept"
    source.write_text("x = 1\ny = 2\n")
    assert of_robot() == fingerprint(str(folder))
    kept.write_text("")
    assert of_robot() == fingerprint(str(folder))
