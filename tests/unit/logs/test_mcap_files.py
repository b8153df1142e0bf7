"""Logs read back bit for bit, also from files that were never finished; others are refused."""

import json
import random
import signal
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from host.logs import log_folder
from host.logs.log import Log
from host.logs.log_folder import in_folder, list_logs
from host.logs.mcap_files import LogError, McapTap
from robot.record import CHANNELS, KICK_NAMES, NAMES, STATES, STRUCT, Record, unpack
from tests.fakes import Rig, eventful

ROOT = Path(__file__).resolve().parents[3]
ZERO_S = 1795360500.25
INFO = {
    "brick": "tcp://127.0.0.1:9",
    "seed": 12,
    "boot": "7",
    "commit": "",
    "host_software": "1.0",
    "battery_v": None,
    "params": {"a": 4.0, "rods": 2, "link_loss": "stop"},
    "odd": ["null", "NaN", '"', "\u00e4\n", -0.0, 1e-320],
    "nan": "NaN",
    "clock_zero_s": ZERO_S,
}


def bits(log):
    return [STRUCT.pack(*record) for record in log.records]


def running(ticks):
    rig = Rig()
    rig.loop.start()
    rig.run(ticks)
    return rig.log(**INFO)


def unpack_f32(value):
    return unpack(STRUCT.pack(*[value if channel.code == "f" else 0 for channel in CHANNELS]))[
        0
    ].late_s


def test_a_log_comes_back_as_it_was(tmp_path):
    log = eventful().log(**INFO)
    log.records[2] = log.records[2]._replace(
        left_x1=-0.0, left_x2=5e-324, left_force=-1.7976931348623157e308, late_s=unpack_f32(0.1)
    )
    back = Log.load(log.save(tmp_path / "log.mcap"))
    assert repr(back.info) == repr(INFO)
    assert bits(back) == bits(log)
    assert repr(back.records) == repr(log.records)
    assert (back.events, back.places) == (log.events, log.places)


def records():
    """Any record of finite numbers; one with others is refused when it arrives."""
    by_code = {
        "I": st.integers(0, 2**32 - 1),
        "d": st.floats(allow_nan=False, allow_infinity=False),
        "f": st.floats(allow_nan=False, allow_infinity=False, width=32),
        "H": st.integers(0, 65535),
        "b": st.integers(-128, 127),
    }
    by_name = {
        "state": st.integers(0, len(STATES) - 1),
        "kick": st.integers(0, len(KICK_NAMES) - 1),
        "t_s": st.floats(0, 1e7),
    }
    return st.builds(
        Record,
        **{
            channel.name: by_name.get(channel.name, by_code.get(channel.code))
            for channel in CHANNELS
        },
    )


@settings(max_examples=60, deadline=None)
@given(batch=st.lists(records(), max_size=5))
def test_any_record_comes_back_bit_for_bit(tmp_path_factory, batch):
    log = Log()
    log.take_records(batch)
    back = Log.load(log.save(tmp_path_factory.mktemp("logs") / "log.mcap"))
    assert bits(back) == bits(log)
    assert back.info == {}


def test_the_file_is_what_viewers_expect(tmp_path):
    log = running(70)
    with log.save(tmp_path / "log.mcap").open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        statistics = reader.get_summary().statistics
        assert statistics.message_count == len(log.records) + len(log.events)
        assert statistics.chunk_count >= 2
        [metadata] = reader.iter_metadata()
        assert metadata.name == "kickctl"
        assert metadata.metadata["brick"] == INFO["brick"]
        assert json.loads(metadata.metadata["params"]) == INFO["params"]
        messages = list(reader.iter_messages(log_time_order=False))
    assert {channel.topic for _, channel, _ in messages} == {"/ticks", "/events"}
    assert {(schema.encoding, channel.message_encoding) for schema, channel, _ in messages} == {
        ("jsonschema", "json")
    }
    ticks = [
        (json.loads(schema.data), json.loads(message.data), message)
        for schema, channel, message in messages
        if channel.topic == "/ticks"
    ]
    python = {"string": str, "integer": int, "number": float}
    for (schema, data, message), record in zip(ticks, log.records, strict=True):
        assert schema["type"] == "object"
        assert list(schema["properties"]) == list(data) == list(NAMES)
        assert all(
            isinstance(value, python[schema["properties"][name]["type"]])
            for name, value in data.items()
        )
        assert (data["state"], data["kick"]) == (STATES[record.state], "")
        assert message.log_time == message.publish_time
        assert message.log_time / 1e9 == pytest.approx(ZERO_S + record.t_s, abs=1e-6)
    assert "[rad] wheel angle" in ticks[0][0]["properties"]["left_phi_rad"]["description"]
    for channel in CHANNELS:
        assert ticks[0][0]["properties"][channel.name]["description"].startswith(
            f"[{channel.unit}] "
        )


def test_an_event_has_the_time_of_the_record_it_precedes(tmp_path):
    rig = Rig()
    rig.loop.start()
    rig.run(20)
    begin = rig.kick("position", ticks=3)
    rig.run(10)
    log = rig.log(**INFO)
    log.take_event({"event": "stop", "tick": 30, "reason": "nothing follows"})
    with log.save(tmp_path / "log.mcap").open("rb") as file:
        messages = [
            (channel.topic, message.log_time, json.loads(message.data))
            for _, channel, message in make_reader(file).iter_messages()
        ]
    times = [time for _, time, _ in messages]
    assert times == sorted(times)
    [kick_time] = [time for _, time, data in messages if data.get("event") == "kick"]
    assert kick_time == next(
        time for topic, time, data in messages if topic == "/ticks" and data["tick"] == begin
    )
    assert messages[-1][2]["event"] == "stop"
    assert messages[-1][1] == messages[-2][1]


def test_a_restarted_robot_has_a_new_zero_of_time(tmp_path):
    log = running(10)
    log.take_event({"event": "restart", "tick": 0, "boot": "b", "clock_zero_s": ZERO_S + 1000})
    Rig().feed(log)
    log.take_records(running(10).records)
    path = log.save(tmp_path / "log.mcap")
    with path.open("rb") as file:
        times = [
            message.log_time / 1e9 - ZERO_S
            for _, _, message in make_reader(file).iter_messages(topics="/ticks")
        ]
    assert times[:10] == pytest.approx([record.t_s for record in log.records[:10]], abs=1e-6)
    assert times[10:] == pytest.approx([1000 + record.t_s for record in log.records[10:]], abs=1e-6)
    assert Log.load(path).restarts() == [10]


def test_a_file_that_nobody_closed_holds_all_but_the_last_second(tmp_path):
    log = running(200)
    tap = McapTap(tmp_path / "log.mcap", INFO)
    for written, record in enumerate(log.records, 1):
        tap.take_records([record])
        if written % 20 == 0:
            back = Log.load(tap.path)
            assert back.info == {**INFO, "truncated": True}
            assert bits(back) == bits(log)[: len(back)]
            assert record.t_s - (back.records[-1].t_s if back.records else 0.0) <= 1.2
    tap.close()
    assert Log.load(tap.path).info == INFO


_KILLED = """
import os, signal, sys
from host.logs.mcap_files import McapTap
from tests.unit.logs.test_mcap_files import INFO, running
log = running(100)
tap = McapTap(sys.argv[1], INFO)
log.play(tap)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_a_killed_process_leaves_a_file_that_reads(tmp_path):
    path = tmp_path / "log.mcap"
    assert (
        subprocess.run([sys.executable, "-c", _KILLED, str(path)], cwd=ROOT, check=False).returncode
        == -signal.SIGKILL
    )
    log, back = running(100), Log.load(path)
    assert back.info["truncated"] is True
    assert len(back) > 60
    assert bits(back) == bits(log)[: len(back)]
    assert back.events == log.events


def test_wherever_a_file_breaks_off_the_rest_is_right(tmp_path):
    log = running(75)
    whole = log.save(tmp_path / "log.mcap").read_bytes()
    path = tmp_path / "cut.mcap"
    lengths, readable = [], False
    for size in [*range(0, len(whole), 53), *range(len(whole) - 40, len(whole))]:
        path.write_bytes(whole[:size])
        try:
            back = Log.load(path)
        except LogError:
            assert not readable
            continue
        readable = True
        assert back.info == {**INFO, "truncated": True}
        assert bits(back) == bits(log)[: len(back)]
        lengths.append(len(back))
    assert lengths == sorted(lengths)
    assert lengths[0] == 0
    assert lengths[-1] == len(log)


def test_damage_never_becomes_data(tmp_path):
    log = running(75)
    whole = log.save(tmp_path / "log.mcap").read_bytes()
    path = tmp_path / "damaged.mcap"
    dice = random.Random(3)
    for _ in range(400):
        damaged = bytearray(whole)
        damaged[dice.randrange(len(whole))] ^= 1 << dice.randrange(8)
        path.write_bytes(damaged)
        try:
            back = Log.load(path)
        except LogError:
            continue
        assert bits(back) == bits(log)[: len(back)]
        assert len(back) == len(log) or back.info["truncated"] is True


def test_a_chunk_that_is_skipped_for_damage_does_not_go_unnoticed(tmp_path):
    path = running(75).save(tmp_path / "log.mcap")
    with path.open("r+b") as file:
        begin = make_reader(file).get_summary().chunk_indexes[-1].chunk_start_offset
        file.seek(begin)
        file.write(b"\x7f")  # a kind of record that no reader knows yet
    back = Log.load(path)
    assert len(back) < 75
    assert back.info["truncated"] is True


def foreign(path):
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata("somebody", {"else": "1"})
        writer.finish()


def of_the_future(path):
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata("kickctl", {"format": "2"})
        writer.finish()


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda path: None, "No such file"),
        (lambda path: path.mkdir(), "directory"),
        (lambda path: path.write_bytes(b""), "not an MCAP file"),
        (lambda path: path.write_text("tick,t_s\n0,0.0\n"), "not an MCAP file"),
        (foreign, "no log of kickctl"),
        (of_the_future, "log format 2"),
    ],
)
def test_what_is_no_log_is_refused_in_words(tmp_path, make, complaint):
    path = tmp_path / "some.mcap"
    make(path)
    with pytest.raises(LogError, match=complaint) as refusal:
        Log.load(path)
    assert str(path) in refusal.value.message
    assert refusal.value.hint


def test_a_log_is_never_overwritten(tmp_path):
    path = tmp_path / "log.mcap"
    running(10).save(path)
    before = path.read_bytes()
    with pytest.raises(LogError, match="exists already"):
        running(20).save(path)
    assert path.read_bytes() == before


def test_where_no_log_can_be_is_refused_in_words(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(LogError, match="cannot be written"):
        McapTap(tmp_path / "file" / "log.mcap", {})


def test_new_logs_have_names_of_their_own_in_the_present_folder(tmp_path, monkeypatch):
    class Now(datetime):
        @classmethod
        def now(cls, tz=None):
            return cls(2026, 11, 22, 15, 30, 12, tzinfo=tz)

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(log_folder, "datetime", Now)
    log = running(3)
    paths = [in_folder("kick-phase-4-ticks", {"brick": "sim://?k=2"}, log.save) for _ in range(3)]
    assert [path.relative_to("logs").name for path in paths] == [
        "20261122-153012-sim-kick-phase-4-ticks.mcap",
        "20261122-153012-sim-kick-phase-4-ticks-2.mcap",
        "20261122-153012-sim-kick-phase-4-ticks-3.mcap",
    ]
    assert in_folder("record", {}, log.save).name == "20261122-153012-record.mcap"
    named = {"robot": "anna", "brick": "tcp://192.168.0.7"}
    assert in_folder("record", named, log.save).name == "20261122-153012-anna-record.mcap"


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("sim://", "sim"),
        ("sim://?motor=a/b", "sim"),
        ("tcp://192.168.0.7:5425", "192.168.0.7-5425"),
        ("tcp://[fe80::1%usb0]", "fe80-1-usb0"),
        ("ssh://robot@ev3dev.local", "ev3dev.local"),
        ("serial:///dev/ttyUSB0?baud=115200", "ttyUSB0"),
        ("", ""),
        ("tcp://host/../..", "tcp"),
        ("tcp://" + 60 * "a", 40 * "a"),
    ],
)
def test_a_logs_name_says_which_robot_it_is_of(address, name):
    assert log_folder.robot_in_name(address) == name


def test_the_list_of_logs_separates_whole_broken_and_foreign_files(tmp_path):
    log = running(100)
    log.save(tmp_path / "a.mcap")
    (tmp_path / "b.mcap").write_bytes((tmp_path / "a.mcap").read_bytes()[:-100])
    foreign(tmp_path / "c.mcap")
    (tmp_path / "notes.txt").touch()
    running(0).save(tmp_path / "d.mcap")
    whole, broken, other, empty = list_logs(tmp_path)
    assert whole[:3] == (tmp_path / "a.mcap", 100, pytest.approx(log.seconds, abs=1e-6))
    assert (whole.brick, whole.note) == (INFO["brick"], "")
    assert broken[1:3] == (100, log.seconds)
    assert broken.note == "breaks off"
    assert "no log of kickctl" in other.note
    assert (empty.ticks, empty.seconds, empty.note) == (0, 0.0, "")
    assert list_logs(tmp_path / "nowhere") == []


def test_a_finished_log_is_listed_without_being_read(tmp_path, monkeypatch):
    running(100).save(tmp_path / "a.mcap")
    monkeypatch.setattr(log_folder, "LogFile", None)
    assert list_logs(tmp_path)[0].ticks == 100


def test_what_is_no_json_is_not_written(tmp_path):
    with McapTap(tmp_path / "log.mcap", {}) as tap, pytest.raises(ValueError, match="JSON"):
        tap.take_records([Record(*dict.fromkeys(NAMES, 0).values())._replace(left_x1=float("nan"))])
