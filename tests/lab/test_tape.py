"""What a page gets of a log: the log's bits, and equations whose text computes their numbers."""

import math

import pytest

from host.errors import WrongUse
from host.lab import tape as tapes
from host.lab.tape import Cut, make_tape
from host.lab.worked import NOT_COMPARABLE, OTHER, ROUNDED, SAME
from host.logs.log import Log
from host.logs.mcap_files import LogError
from host.logs.replay import replay
from robot.record import NAMES, Record
from robot.safety import RUNNING
from tests.fakes import eventful
from tests.lab.tapes import rows_of, twins_rows_of


@pytest.fixture(scope="module")
def log():
    return eventful().log()


@pytest.fixture(scope="module")
def tape(log):
    return make_tape(log, "eventful.mcap")


@pytest.fixture(scope="module")
def rows(tape):
    return rows_of(tape)


def test_the_records_are_those_of_the_log_in_every_bit(log, rows):
    assert [tuple(row[name] for name in NAMES) for row in rows] == log.records


def test_the_text_of_each_line_computes_its_number_in_every_bit(tape, rows):
    """What a pupil reads is what the robot's program does: Python evaluates the page's text."""
    seen = set()
    for row in rows:
        written = {name: f"({value!r})" for name, value in row.items()}
        for side in ("left", "right") if row["state"] == RUNNING else ():
            for line in tape["equations"][side]:
                if row["compared"] == NOT_COMPARABLE or (line["when"] and not row[line["when"]]):
                    continue
                if line["joint"] == "=" and line["symbol"] != "duty":
                    text = line["numbers"].format_map(written)
                    text = text.replace("·", "*")
                    assert eval(text, vars(math)) == row[line["result"]], line  # noqa: S307
                if line["logged"]:
                    assert row[line["logged"]] == row[line["result"]], line
                seen.add((side, line["symbol"], line["numbers"]))
    assert len(seen) == sum(map(len, tape["equations"].values()))


def test_a_tick_whose_past_is_unknown_has_forces_but_no_step(rows):
    whole = rows[60]
    assert whole["state"] == RUNNING
    first, second = rows_of(make_tape(eventful().log(60), "log"))[:2]
    assert first["compared"] == NOT_COMPARABLE
    assert math.isnan(first["left_eq_rate1"])
    assert first["left_eq_force"] == first["left_force"] == whole["left_force"]
    assert [second["left_eq_x1"], second["compared"]] == [rows[61]["left_x1"], SAME]


def test_the_first_tick_has_all_that_is_drawn_but_a_speed(rows):
    tape = make_tape(eventful().log(60), "log", motor="pybricks")
    for first in (rows_of(tape)[0], twins_rows_of(tape)[0]):
        assert math.isnan(first["left_omega_rad_s"])
        assert first["x_m"] == first["y_m"] == first["heading_rad"] == 0.0
        for name in ("target1", "target2", "seen1", "seen2", "lag_rad"):
            for side in ("left", "right"):
                assert first[f"{side}_{name}"] == rows[60][f"{side}_{name}"], name


def test_a_cut_knows_what_came_before_it(log, rows):
    begin = log.records[0].t_s
    cut = make_tape(log, "log", Cut(log.records[100].t_s - begin, log.records[120].t_s - begin))
    assert rows_of(cut) == rows[100:121]
    assert cut["events"][0]["event"]["event"] == "snapshot"
    assert cut["events"][0]["event"]["params"]["polarity_right"] == -1
    assert all(0 <= event["place"] <= 21 for event in cut["events"])
    assert cut["begin_s"] == begin
    assert cut["part"].startswith("from 3")
    verdict = cut["verdict"]
    assert (verdict["compared"], verdict["not_comparable"], verdict["missing"]) == (21, 0, 0)


@pytest.mark.parametrize("cut", [None, Cut(0.0, 5.0)])
def test_a_log_that_is_too_long_is_refused_with_the_remedy(log, monkeypatch, cut):
    monkeypatch.setattr(tapes, "MOST_TICKS", 100)
    with pytest.raises(WrongUse, match="more than 100 ticks") as refusal:
        make_tape(log, "log", cut)
    assert "--from 0 --to 300" in refusal.value.hint
    assert make_tape(log, "log", Cut(0.0, 2.0))["ticks"] < 100


def test_a_part_without_ticks_is_refused(log):
    with pytest.raises(WrongUse, match="no tick in this part: from 1000 s to its end"):
        make_tape(log, "log", Cut(1000.0))


def altered(log, tick, **changes):
    copy = Log(log.info)
    for item in log.stream():
        if isinstance(item, Record):
            copy.take_records([item._replace(**changes) if item.tick == tick else item])
        else:
            copy.take_event(item)
    return copy


def test_a_changed_log_says_in_which_tick(log, rows):
    forged = altered(log, 77, left_x1=rows[77]["left_x1"] + 1e-13)
    tape = make_tape(forged, "log")
    assert [row["tick"] for row in rows_of(tape) if row["compared"] == OTHER] == [77]
    assert not tape["verdict"]["reproduced"]
    assert tape["verdict"]["first_mismatch"] == str(replay(forged).first)
    forged.info["robot_machine"] = "armv5tejl CPython 3.5.3"
    elsewhere = make_tape(forged, "log")
    assert [row["tick"] for row in rows_of(elsewhere) if row["compared"] == ROUNDED] == [77]
    assert elsewhere["verdict"]["reproduced"]


def test_numbers_that_no_page_can_show_are_said(log):
    with pytest.raises(LogError, match=r"tick 77 .* numbers too large"):
        make_tape(altered(log, 77, left_phi_rad=1e300), "log")


def test_missing_ticks_and_a_second_start_of_the_program_have_their_places(log):
    pieces = Log(log.info)
    pieces.take_event(log.events[0])
    pieces.take_records([*log.records[:10], *log.records[14:20]])
    pieces.take_event({"event": "restart", "tick": 0})
    pieces.take_event(log.events[0])
    pieces.take_records(log.records[:5])
    tape = make_tape(pieces, "log")
    assert tape["gaps"] == [{"place": 10, "ticks": 4}]
    assert tape["verdict"]["missing"] == 4
    assert {"place": 16, "event": {"event": "restart", "tick": 0}} in tape["events"]
    rows = rows_of(tape)
    times = [row["t_s"] for row in rows]
    assert times == sorted(times)
    assert times[16] == times[15] + rows[16]["dt_s"]
    assert [row["tick"] for row in rows[16:]] == [0, 1, 2, 3, 4]
