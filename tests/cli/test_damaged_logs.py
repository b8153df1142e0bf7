"""Who reads a log that is damaged gets what can be read, and learns what is missing."""

import json
import os
from pathlib import Path

import pytest
from mcap.writer import Writer

from host.logs import log_folder
from host.logs.log import Log
from host.logs.mcap_files import METADATA
from host.logs.messages import EVENTS, TICKS

READERS = {
    "csv": ("export",),
    "npz": ("export", "--out", "table.npz"),
    "parquet": ("export", "--out", "table.parquet"),
    "excel": ("export", "--excel"),
    "plot": ("plot", "--out", "figure.png"),
    "film": ("film", "--out", "film.gif", "--seconds", "0.1"),
    "replay": ("replay",),
}


@pytest.fixture
def log(kickctl):
    """A log of three seconds."""
    return Path(json.loads(kickctl("record", "3", "--seed", "1", "--json")[1])["log"])


def cut(log):
    path = Path("it's cut.mcap")
    path.write_bytes(log.read_bytes()[: log.stat().st_size * 2 // 3])
    return path


def with_a_damaged_place(log):
    path, data = Path("flip.mcap"), bytearray(log.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)
    return path


def with_nonsense(log):
    """The log as an older release might have written it, with numbers that are not finite."""
    whole, path = Log.load(log), Path("it's old.mcap")
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        info = {"format": "1", "battery_v": "NaN", "brick": "sim://"}
        info["params"] = json.dumps(whole.info["params"])
        writer.add_metadata(METADATA, info)
        ticks, events = (
            writer.register_channel(
                topic, "json", writer.register_schema(topic, "jsonschema", b"{}")
            )
            for topic in (TICKS, EVENTS)
        )
        for item in whole.stream():
            if isinstance(item, dict):
                message = item
            else:
                message = {**item._asdict(), "kick": "", "state": "running"}
                if item.tick % 40 == 9:
                    message["left_x1"] = float("nan")
            channel = events if isinstance(item, dict) else ticks
            writer.add_message(channel, 0, json.dumps(message).encode(), 0)
        writer.add_message(events, 0, b'{"event":"params","tick":9,"set":{"k":1e999}}', 0)
        writer.finish()
    return path


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("damage", [cut, with_nonsense])
def test_whoever_reads_a_damaged_log_says_what_is_missing(kickctl, log, damage, reader):
    path, (action, *more) = damage(log), READERS[reader]
    words = "breaks off or is damaged after tick" if damage is cut else "tick 9 (left_x1 is no"
    status, answer, err = kickctl("log", action, str(path), *more)
    assert status == 1
    assert words in err
    assert "kickctl log recover 'it'\"'\"'s" in err
    assert len(answer) > 10
    for file in more[1:2]:
        assert Path(file).stat().st_size > 1000
    out = ("--out", "another.csv") if reader in ("csv", "excel") else more[:2]
    line = ("log", action, str(path), *more, *out, "--json", *(["--force"] if out else []))
    status, answer, _ = kickctl(*line)
    facts = json.loads(answer)
    assert status == 1
    assert facts["truncated"] is True
    assert words in facts["damage"]
    status, answer, err = kickctl("log", action, str(log), *more, *(["--force"] if out else []))
    assert (status, "recover" in err, "damage" in err) == (0, False, False)


@pytest.mark.parametrize("kept", [lambda size: size - 10, lambda size: size * 2 // 3])
def test_a_log_without_its_end_is_not_said_to_lack_ticks(kickctl, log, kept):
    """Perhaps only the end of the index is lost: the reader cannot know."""
    path, data = Path("short.mcap"), log.read_bytes()
    path.write_bytes(data[: kept(len(data))])
    last = Log.load(path).records[-1].tick
    status, _, err = kickctl("log", "replay", str(path))
    assert status == 1
    words = f"breaks off or is damaged after tick {last}; what may follow was not read\n"
    assert words in err
    assert "missing" not in err


def test_recover_goes_on_behind_a_damaged_place_and_says_how_much_is_lost(kickctl, log):
    path, ticks = with_a_damaged_place(log), len(Log.load(log))
    status, answer, err = kickctl("log", "recover", path.name, "--json")
    facts = json.loads(answer)
    back = Log.load(facts["log"])
    assert status == 1
    assert (facts["ticks"], facts["total"]) == (len(back), ticks)
    assert facts["lost"] == ticks - len(back) > 0
    assert back.records[-1] == Log.load(log).records[-1]
    status, answer, err = kickctl("log", "recover", path.name)
    assert status == 1
    assert f"{len(back)} of {ticks} ticks of {path}, {facts['lost']} lost, are in" in answer
    assert f"{facts['lost']} ticks of {path} cannot be read" in err
    replayed = json.loads(kickctl("log", "replay", facts["log"], "--json")[1])
    assert replayed["missing"] == facts["lost"]
    assert replayed["compared"] + replayed["not_comparable"] == len(back)
    assert replayed["not_comparable"] > len(back) // 4
    assert "since they follow a gap" in replayed["why_not_comparable"]
    behind = kickctl("lab", "--export", "page.html", path.name, "--from", "2.9")
    assert behind[0] == 2
    assert f"kickctl log recover {path.name} also reads what is whole behind" in behind[2]


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize("reader", READERS)
def test_whoever_stops_at_a_damaged_place_says_the_loss_in_numbers(kickctl, log, reader):
    path, (action, *more) = with_a_damaged_place(log), READERS[reader]
    status, _, err = kickctl("log", action, str(path), *more)
    read, ticks = Log.load(path), len(Log.load(log))
    kept = len(read)
    assert status == 1
    assert f"after tick {read.records[-1].tick}; {ticks - kept} of {ticks} ticks are missing" in err
    assert "kickctl log recover" in err


def test_a_list_marks_a_log_with_a_damaged_place(kickctl, log):
    path = with_a_damaged_place(log)
    kept, ticks = len(Log.load(path)), len(Log.load(log))
    path.rename(log.with_name(path.name))
    status, answer, err = kickctl("log", "list")
    assert status == 0
    (line,) = [line for line in answer.splitlines() if path.name in line]
    assert f"{kept} ticks" in line
    assert f"damaged: {ticks - kept} of {ticks} ticks are missing" in line
    assert f"kickctl log recover logs/{path.name}" in err


def test_what_cannot_be_right_is_left_out_and_the_rest_is_read(kickctl, log):
    old = with_nonsense(log)
    expected = [record for record in Log.load(log).records if record.tick % 40 != 9]
    read = Log.load(old)
    assert [record.tick for record in read.records] == [record.tick for record in expected]
    assert read.info["truncated"] is True
    assert read.info["battery_v"] is None
    assert read.missing() != []
    status, answer, _ = kickctl("log", "recover", str(old), "--json")
    facts = json.loads(answer)
    assert (status, facts["was_whole"]) == (1, False)
    assert facts["lost"] == len(Log.load(log)) - len(expected)
    recovered = facts["log"]
    assert "truncated" not in Log.load(recovered).info
    assert kickctl("log", "export", recovered)[0] == 0


def test_a_replay_says_first_that_other_code_recorded_the_log(kickctl, log):
    assert "other sources" not in kickctl("log", "replay", str(log))[2]
    whole = Log.load(log)
    for name in ("sources", "robot_sources"):
        info = {**whole.info, name: "0123456789abcdef"}
        other = Log(info)
        whole.play(other)
        path = other.save(f"{name}.mcap")
        status, answer, err = kickctl("log", "replay", str(path), "--json")
        facts = json.loads(answer)
        assert (status, facts["exact"]) == (0, True)
        assert facts["other_sources"] == [err.splitlines()[0]]
        assert "0123456789abcdef" in err
    assert kickctl("log", "replay", str(path))[0] == 0


def test_a_list_names_what_is_wrong_with_each_file(kickctl, log):
    folder = Path("mixed")
    folder.mkdir()
    cut(log).rename(folder / "a.mcap")
    (folder / "b.mcap").write_bytes(b"")
    (folder / "c.mcap").mkdir()
    (folder / "d.mcap").symlink_to("nowhere")
    (folder / "e.mcap").symlink_to(log.resolve())
    os.mkfifo(folder / "f.mcap")
    status, answer, err = kickctl("log", "list", str(folder))
    assert status == 0
    for line, words in zip(
        answer.splitlines(),
        ("breaks off", "not an MCAP file", "directory", "No such file", "ticks", "a pipe"),
        strict=True,
    ):
        assert words in line
    assert "kickctl log recover mixed/a.mcap" in err
    rows = json.loads(kickctl("log", "list", str(folder), "--json")[1])["logs"]
    assert [Path(row["path"]).name[0] for row in rows] == list("abcdef")
    assert [bool(row["note"]) for row in rows] == [True, True, True, True, False, True]


def test_a_log_that_vanishes_is_not_listed(kickctl, log, monkeypatch):
    other = log.with_name("z.mcap")
    other.write_bytes(log.read_bytes())
    find = log_folder._summary_of_whole

    def summary(path):
        other.unlink(missing_ok=True)
        return find(path)

    monkeypatch.setattr(log_folder, "_summary_of_whole", summary)
    status, answer, _ = kickctl("log", "list", "--json")
    assert (status, [row["path"] for row in json.loads(answer)["logs"]]) == (0, [str(log)])


def test_a_folder_that_may_not_be_read_is_no_empty_one(kickctl, log, monkeypatch):
    """A user without rights; the tests may run as root, who has all."""

    def refuse(path):
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(Path, "iterdir", refuse)
    status, answer, err = kickctl("log", "list")
    assert (status, answer) == (2, "")
    assert "the folder logs cannot be read: Permission denied" in err


@pytest.mark.parametrize("action", ["export", "replay", "recover", "plot", "film"])
def test_what_can_be_read_only_once_is_no_log(kickctl, action):
    os.mkfifo("pipe")
    status, answer, err = kickctl("log", action, "pipe")
    assert (status, answer) == (2, "")
    assert "save it to a file first" in err
