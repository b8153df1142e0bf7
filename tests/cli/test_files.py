"""No verb destroys a file, or loses one to another program."""

import json
import shutil
import threading
from pathlib import Path

import numpy as np
import pytest

from host.films.movie import Movie
from host.logs.log import Log
from host.logs.log_folder import in_folder
from host.logs.mcap_files import McapTap
from sim_motor.bodies.model import HERE


@pytest.fixture
def log(kickctl):
    """A log of a second."""
    return Path(json.loads(kickctl("record", "1", "--seed", "1", "--json")[1])["log"])


@pytest.mark.parametrize("form", ["csv", "npz"])
def test_an_export_never_replaces_a_log(kickctl, log, form):
    link = Path("link.csv")
    link.symlink_to(log)
    other = Path("other.csv")
    shutil.copy(log, other)
    before = log.read_bytes()
    for out in (log, link, other):
        status, answer, err = kickctl(
            "log", "export", str(log), "--format", form, "--out", str(out)
        )
        assert (status, answer) == (2, "")
        assert "is a log" in err
        assert out.read_bytes() == before
    assert {path.name for path in Path("logs").iterdir()} == {log.name}


def test_a_log_that_is_named_as_a_table_is_not_replaced_by_it(kickctl, log):
    odd = Path("odd.csv")
    shutil.copy(log, odd)
    status, answer, _ = kickctl("log", "export", str(odd), "--json")
    assert (status, json.loads(answer)["error"]["status"]) == (2, 2)
    assert odd.read_bytes() == log.read_bytes()


def test_an_export_that_fails_leaves_the_old_table(kickctl, log, monkeypatch):
    table = Path("table.csv")
    table.write_text("old")

    def fail(*_):
        raise MemoryError

    monkeypatch.setattr("host.logs.tables._rows", fail)
    status, _, err = kickctl("log", "export", str(log), "--out", str(table))
    assert status == 1
    assert "memory" in err
    assert table.read_text() == "old"
    assert {path.name for path in kickctl.folder.iterdir()} == {"logs", "table.csv"}


def test_logs_that_begin_in_the_same_second_have_names_of_their_own(kickctl):
    barrier, paths = threading.Barrier(4), []

    def record():
        barrier.wait()
        with in_folder("record", lambda path: McapTap(path, {})) as tap:
            paths.append(tap.path)

    recorders = [threading.Thread(target=record) for _ in range(4)]
    for recorder in recorders:
        recorder.start()
    for recorder in recorders:
        recorder.join()
    assert len(set(paths)) == 4
    assert all(Log.load(path).info == {} for path in paths)


def test_recover_writes_a_new_log(kickctl, log):
    cut = Path("cut.mcap")
    cut.write_bytes(log.read_bytes()[:-200])
    assert "log recover cut.mcap" in kickctl("log", "replay", "cut.mcap")[1]
    answer = json.loads(kickctl("log", "recover", "cut.mcap", "--json")[1])
    assert answer["log"] == "cut-recovered.mcap"
    assert answer["was_whole"] is False
    assert len(Log.load(answer["log"])) == answer["ticks"] > 0
    assert json.loads(kickctl("log", "replay", answer["log"], "--json")[1])["exact"] is True
    status, _, err = kickctl("log", "recover", "cut.mcap", "--out", str(log))
    assert status == 2
    assert "never overwritten" in err


@pytest.mark.parametrize("verb", ["export", "replay", "recover"])
def test_what_is_no_log_is_refused(kickctl, verb):
    Path("notes.txt").write_text("no log")
    status, _, err = kickctl("log", verb, "notes.txt")
    assert status == 2
    assert "not an MCAP file" in err


def test_a_scene_is_not_replaced_by_its_model(kickctl):
    scene = Path("mine.xml")
    shutil.copy(HERE / "scenes" / "world.xml", "world.xml")
    shutil.copy(HERE / "scenes" / "flat.xml", scene)
    before = scene.read_bytes()
    link = Path("link.xml")
    link.symlink_to(scene)
    for model in (scene, link):
        status, _, err = kickctl(
            "body", "car", "--scene", "mine.xml", "--time", "0.1", "--model", str(model)
        )
        assert status == 2
        assert "is the scene itself" in err
        assert scene.read_bytes() == before


def test_a_film_that_fails_leaves_the_one_before(tmp_path):
    path = tmp_path / "film.gif"
    picture = np.zeros((2, 2, 3), np.uint8)
    with Movie(path, (2, 2)) as movie:
        movie.add(picture)
    before = path.read_bytes()

    def fail():
        with Movie(path, (2, 2)) as movie:
            movie.add(picture)
            movie._writer.finish = full

    def full():
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        fail()
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.glob("*film*")] == ["film.gif"]
