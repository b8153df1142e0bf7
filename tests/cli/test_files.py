"""No verb destroys a file, or loses one to another program."""

import json
import os
import shutil
import threading
from pathlib import Path

import numpy as np
import pytest

from host.errors import NotDone
from host.films.movie import Movie
from host.logs.log import Log
from host.logs.log_folder import in_folder
from host.logs.mcap_files import McapTap
from sim_motor.bodies.model import HERE


@pytest.fixture
def log(kickctl):
    """A log of a second."""
    return Path(json.loads(kickctl("record", "1", "--seed", "1", "--json")[1])["log"])


# Each writes a file whose name the user gives.
WRITERS = (
    ("log", "export", "LOG", "--out", "OUT.csv"),
    ("log", "export", "LOG", "--out", "OUT.npz"),
    ("log", "export", "LOG", "--out", "OUT.parquet"),
    ("log", "plot", "LOG", "--out", "OUT.png"),
    ("log", "film", "LOG", "--seconds", "0.1", "--out", "OUT.gif"),
    ("rods", "--out", "OUT.gif"),
    ("body", "car", "--time", "0.1", "--model", "OUT.xml"),
    ("body", "car", "--time", "0.1", "--film", "OUT.gif"),
)


def command(writer, log, out):
    """The command line of a writer, and the file that it writes."""
    name = writer[-1].replace("OUT", str(out))
    return [*writer[:-1], name] if "LOG" not in writer else [
        *(str(log) if word == "LOG" else word for word in writer[:-1]),
        name,
    ], Path(name)


def everything():
    """All files here but those of caches, which matplotlib fills when it is first imported."""
    return {
        path: path.read_bytes()
        for path in Path().rglob("*")
        if path.is_file() and path.parts[0] != "cache"
    }


@pytest.mark.parametrize("writer", WRITERS, ids=" ".join)
@pytest.mark.parametrize("force", [(), ("--force",)])
def test_no_verb_replaces_a_log(kickctl, log, writer, force):
    line, out = command(writer, log, "other")
    shutil.copy(log, out)
    link, to_link = command(writer, log, "link")
    to_link.symlink_to(log)
    mcap = [*line[:-1], str(log)]
    before = everything()
    for words in (line, link, mcap, [*line[:-1], "empty.mcap"]):
        status, answer, err = kickctl(*words, *force)
        assert (status, answer) == (2, "")
        assert "log" in err or "end its name with" in err
    assert everything() == before


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize("writer", WRITERS, ids=" ".join)
def test_a_file_is_replaced_only_by_force(kickctl, log, writer):
    line, out = command(writer, log, "mine")
    for words in (b"my own words", b"", b"12345"):
        out.write_bytes(words)
        before = everything()
        status, answer, err = kickctl(*line)
        assert (status, answer) == (2, "")
        assert f"{out} exists already" in err
        assert "--force" in err
        assert everything() == before
    if writer[:1] == ("log",):
        assert kickctl(*line, "--force")[0] == 0
        assert out.stat().st_size > 100


def test_two_exports_to_one_name_make_one(kickctl, log, monkeypatch):
    """The other program was faster, after this one had found the name free."""
    monkeypatch.setattr(
        "host.commands.log.require_place", lambda options, path: path.write_text("theirs")
    )
    status, _, err = kickctl("log", "export", str(log), "--out", "table.csv")
    assert status == 2
    assert "exists already" in err
    assert Path("table.csv").read_text() == "theirs"


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--out", "a.csv", "--format", "npz"), "its ending says csv"),
        (("--out", "a.npz", "--format", "csv"), "its ending says npz"),
        (("--out", "a.xlsx"), "does not say which table"),
        (("--out", "a.npz", "--excel"), "kind of csv"),
        (("--json",), "name a file with --out"),
        (("--json", "--out", "/dev/stdout"), "name a file with --out"),
        (("--out", "logs"), "is a folder"),
        (("--out", "nowhere/a.csv"), "there is no folder nowhere"),
    ],
)
def test_an_export_that_nobody_can_mean_is_refused(kickctl, log, words, reason):
    before = everything()
    status, answer, err = kickctl("log", "export", str(log), *words)
    assert status == 2
    assert reason in err
    assert "--json" in words or answer == ""
    assert everything() == before


def test_the_ending_decides_the_format(kickctl, log):
    assert kickctl("log", "export", str(log), "--out", "a.npz")[0] == 0
    assert len(np.load("a.npz")["tick"]) > 10
    assert kickctl("log", "export", str(log), "--out", "a.CSV")[0] == 0
    assert Path("a.CSV").read_text() == kickctl("log", "export", str(log))[1]


@pytest.mark.parametrize("verb", ["record", "recover", "pull"])
def test_a_log_has_no_name_of_another_kind_of_file(kickctl, log, verb):
    words = {
        "record": ("record", "1"),
        "recover": ("log", "recover", str(log)),
        "pull": ("log", "pull"),
    }[verb]
    status, answer, err = kickctl(*words, "--out", "table.csv")
    assert (status, answer) == (2, "")
    assert "end its name with .mcap" in err
    assert not Path("table.csv").exists()


def test_an_export_that_fails_leaves_the_old_table(kickctl, log, monkeypatch):
    table = Path("table.csv")
    table.write_text("old")

    def fail(*_):
        raise MemoryError

    monkeypatch.setattr("host.logs.tables.rows_of", fail)
    status, _, err = kickctl("log", "export", str(log), "--out", str(table), "--force")
    assert status == 1
    assert "memory" in err
    assert table.read_text() == "old"
    assert {path.name for path in kickctl.folder.iterdir()} == {"logs", "table.csv"}


def test_a_table_goes_through_a_pipe(kickctl, log):
    os.mkfifo("pipe")
    read = []
    reader = threading.Thread(target=lambda: read.append(Path("pipe").read_text()))
    reader.start()
    status, answer, _ = kickctl("log", "export", str(log), "--out", "pipe", "--json")
    reader.join()
    assert (status, json.loads(answer)["table"]) == (0, "pipe")
    assert read == [kickctl("log", "export", str(log))[1]]


def test_logs_that_begin_in_the_same_second_have_names_of_their_own(kickctl):
    barrier, paths = threading.Barrier(4), []

    def record():
        barrier.wait()
        with in_folder("record", {}, lambda path: McapTap(path, {})) as tap:
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
    assert "log recover cut.mcap" in kickctl("log", "replay", "cut.mcap")[2]
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

    with pytest.raises(NotDone, match="No space"):
        fail()
    assert path.read_bytes() == before
    assert [file.name for file in tmp_path.glob("*film*")] == ["film.gif"]


@pytest.mark.parametrize(
    "line",
    [
        ("record", "1", "--out", "NAME.mcap"),
        ("log", "recover", "LOG", "--out", "NAME.mcap"),
        ("log", "pull", "--out", "NAME.mcap"),
        ("log", "export", "LOG", "--out", "NAME.csv"),
        ("log", "plot", "LOG", "--out", "NAME.png"),
        ("log", "film", "LOG", "--out", "NAME.gif"),
        ("body", "car", "--model", "NAME.xml"),
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("form", [(), ("--json",)], ids=["words", "json"])
def test_a_name_that_nobody_can_type_is_refused(kickctl, log, line, form):
    before = sorted(Path().rglob("*"))
    name = os.fsdecode(b"n\xff\xfe")
    words = [word.replace("NAME", name).replace("LOG", str(log)) for word in line]
    status, _, err = kickctl(*words, *form)
    assert status == 2
    assert "no text in UTF-8" in err
    assert "choose another name" in err
    assert sorted(Path().rglob("*")) == before


def test_a_log_with_such_a_name_is_still_read(kickctl, log):
    path = Path(os.fsdecode(b"n\xff.mcap"))
    path.write_bytes(log.read_bytes())
    assert kickctl("log", "replay", str(path))[0] == 0
    assert kickctl("log", "export", str(path), "--out", "a.csv")[0] == 0
