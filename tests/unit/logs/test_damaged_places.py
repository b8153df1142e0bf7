"""One damaged place in a log's file costs the ticks in it, and no others."""

import io

import lz4.frame
import pytest
from mcap.records import Chunk
from mcap.stream_reader import StreamReader

from host.logs.log import Log
from host.logs.log_folder import list_logs
from host.logs.mcap_files import McapTap
from host.logs.mcap_index import read_index
from host.logs.recovery import recover
from host.logs.replay import replay
from host.logs.tap import Event
from robot.params import Params
from tests.unit.logs.test_mcap_files import INFO, bits, running
from tests.unit.logs.test_recovery import read_strictly

TICKS = 400


@pytest.fixture(scope="module")
def log():
    return running(TICKS)


@pytest.fixture
def whole(log, tmp_path):
    return log.save(tmp_path / "whole.mcap").read_bytes()


def chunks(data):
    """Where the chunks lie: (begin, end) of each."""
    found, at = [], 0
    while (at := data.find(b"\x03\0\0\0lz4", at)) > 0:
        begin = at - 37
        length = int.from_bytes(data[begin + 1 : begin + 9], "little")
        if data[begin] == 6 and begin + length < len(data) - 100:
            found.append((begin, begin + 9 + length))
        at += 1
    return found


def damaged(tmp_path, data, *places):
    data = bytearray(data)
    for begin, bytes_ in places:
        data[begin : begin + len(bytes_)] = bytes_
    path = tmp_path / "damaged.mcap"
    path.write_bytes(data)
    return path


def losses(log):
    return [event for event in log.events if event["event"] == "lost"]


def is_rest(log, back):
    """Whether a log has the others' records, but none else."""
    of = {record.tick: line for record, line in zip(log.records, bits(log), strict=True)}
    return bits(back) == [of[record.tick] for record in back.records]


@pytest.mark.parametrize(
    "hit",
    [
        lambda begin, end: ((begin + end) // 2, b"\xff\x00"),
        lambda begin, end: (begin, bytes(500)),
        lambda begin, end: (begin + 1, b"\xff" * 8),
        lambda begin, end: (begin + 44, b"\x10\0"),
        lambda begin, end: (end - 300, bytes(500)),
        lambda begin, end: (begin, b"\x77"),
        lambda begin, end: (begin, b"\x99"),
        lambda begin, end: (begin, b"\x02"),
    ],
    ids=[
        "content",
        "zeros",
        "endless",
        "short",
        "over the end",
        "no opcode",
        "private",
        "a footer",
    ],
)
def test_the_ticks_behind_a_damaged_place_are_recovered(tmp_path, log, whole, hit):
    places = chunks(whole)
    begin, end = places[len(places) // 2]
    path = damaged(tmp_path, whole, hit(begin, end))
    assert Log.load(path).info["truncated"] is True
    found = recover(path)
    back = Log.load(found.path)
    (gap,) = back.missing()
    assert (found.total, found.lost) == (TICKS, gap[1] - gap[0])
    assert found.ticks == len(back) == TICKS - found.lost
    assert 0 < found.lost < TICKS // 4
    assert back.records[-1].tick == TICKS - 1
    assert is_rest(log, back)
    assert [(event["from"], event["tick"]) for event in losses(back)] == [gap]
    assert read_strictly(found.path) == [len(back.records) + len(back.events)] * 3


def test_each_of_two_damaged_places_is_marked(tmp_path, log, whole):
    places = chunks(whole)
    hits = [(sum(places[number]) // 2, b"\xff\x00") for number in (3, 6)]
    found = recover(damaged(tmp_path, whole, *hits))
    back = Log.load(found.path)
    assert len(back.missing()) == 2
    assert [(event["from"], event["tick"]) for event in losses(back)] == back.missing()
    assert found.lost == sum(end - first for first, end in back.missing())
    assert is_rest(log, back)


def test_damage_in_the_first_and_the_last_part_is_marked(tmp_path, log, whole):
    places = chunks(whole)
    hits = [(sum(places[number]) // 2, b"\xff\x00") for number in (0, 1, -1)]
    found = recover(damaged(tmp_path, whole, *hits))
    back = Log.load(found.path)
    assert is_rest(log, back)
    first, last = losses(back)
    assert first["tick"] == back.records[0].tick
    assert last["from"] == back.records[-1].tick + 1
    assert found.lost == TICKS - len(back)


def test_without_an_index_the_gaps_count(tmp_path, log, whole):
    places = chunks(whole)
    begin, end = places[3]
    path = damaged(tmp_path, whole[: places[-1][0] + 50], ((begin + end) // 2, b"\xff\x00"))
    found = recover(path)
    ((first, end),) = Log.load(found.path).missing()
    assert (found.total, found.lost) == (None, end - first)


def test_a_log_that_only_breaks_off_has_lost_nobody_knows_how_much(tmp_path, whole):
    found = recover(damaged(tmp_path, whole[: len(whole) // 2]))
    assert (found.was_whole, found.total, found.lost) == (False, None, None)
    assert losses(Log.load(found.path)) == []


def test_damage_that_costs_no_tick_is_no_loss(tmp_path, log, whole):
    end = chunks(whole)[3][1]
    path = damaged(tmp_path, whole, (end + 12, b"\xff"))  # in the index of its messages
    found = recover(path)
    assert (found.was_whole, found.ticks, found.lost) == (False, TICKS, 0)
    assert bits(Log.load(found.path)) == bits(log)
    assert losses(Log.load(found.path)) == []


def test_replay_compares_nothing_behind_a_gap_whose_events_are_unknown(tmp_path, log, whole):
    begin, end = chunks(whole)[4]
    back = Log.load(recover(damaged(tmp_path, whole, ((begin + end) // 2, b"\xff\x00"))).path)
    ((first, _),) = back.missing()
    result = replay(back)
    assert result.exact
    behind = sum(record.tick >= first for record in back.records)
    assert result.compared <= first
    assert result.not_comparable >= result.behind_gaps == behind
    assert f"{behind} ticks cannot be compared, since they follow a gap" in result.why_behind_gaps
    assert result.compared + result.not_comparable == len(back)


def test_a_snapshot_behind_a_gap_lets_replay_compare_again(log):
    """As the robot sends one after a gap in its stream."""
    gapped = Log(log.info)
    snapshot: Event = {
        "event": "snapshot",
        "tick": 200,
        "params": dict(Params().values()),
        "kick": None,
    }
    for item in log.stream():
        if isinstance(item, dict):
            gapped.take_event(item)
        elif item.tick == 200:
            gapped.take_event({"event": "lost", "tick": 200, "from": 150})
            gapped.take_event(snapshot)
            gapped.take_records([item])
        elif not 150 <= item.tick < 200:
            gapped.take_records([item])
    assert replay(gapped).exact
    assert replay(gapped).compared >= TICKS - 50 - 3


def test_a_restart_in_a_damaged_place_is_noticed(tmp_path, log):
    path = tmp_path / "log.mcap"
    with McapTap(path, INFO) as tap:
        log.play(tap)
        tap.take_event({"event": "restart", "tick": 0, "clock_zero_s": INFO["clock_zero_s"]})
        log.play(tap)
    whole = path.read_bytes()
    holds_restart = [b'"restart"' in content for content in unpacked(whole)]
    begin, end = chunks(whole)[holds_restart.index(True)]
    found = recover(damaged(tmp_path, whole, ((begin + end) // 2, b"\xff\x00")))
    back = Log.load(found.path)
    assert len(back.restarts()) == 1
    assert found.lost == 2 * TICKS - len(back)
    assert len(losses(back)) == 1
    assert replay(back).exact


def unpacked(data):
    """The contents of the chunks."""
    items = StreamReader(io.BytesIO(data), emit_chunks=True).records
    return [lz4.frame.decompress(item.data) for item in items if isinstance(item, Chunk)]


def test_a_list_says_that_a_log_is_damaged(tmp_path, whole):
    begin, end = chunks(whole)[4]
    path = damaged(tmp_path, whole, ((begin + end) // 2, b"\xff\x00"))
    hurt, fine = list_logs(tmp_path)
    assert (fine.ticks, fine.note) == (TICKS, "")
    kept = len(Log.load(path))
    assert hurt.ticks == kept
    assert hurt.note == f"damaged: {TICKS - kept} of {TICKS} ticks are missing"


def test_an_index_that_is_damaged_itself_says_nothing(tmp_path, whole):
    for place in (len(whole) - 100, len(whole) - 20, len(whole) - 37, len(whole) - 1):
        path = damaged(tmp_path, whole, (place, bytes([whole[place] ^ 1])))
        assert read_index(path) is None
    path = damaged(tmp_path, whole)
    index = read_index(path)
    assert (index.ticks, index.intact) == (TICKS, True)


@pytest.mark.parametrize("text", [b"x", b'"', b"-", b"["])
def test_a_log_with_a_damaged_clock_is_recovered(tmp_path, log, whole, text):
    """The information about the log has no checksum of its own."""
    at = whole.index(str(INFO["clock_zero_s"]).encode())
    found = recover(damaged(tmp_path, whole, (at, text)))
    assert (found.was_whole, found.lost) == (False, 0)
    back = Log.load(found.path)
    assert bits(back) == bits(log)
    assert "clock_zero_s" not in back.info
