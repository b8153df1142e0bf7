"""A log in memory keeps the order of the stream, and derives from it no more than it says."""

import subprocess
import sys

import numpy as np
import pytest

import kickctl
from host.errors import KickctlError
from host.logs.log import Log
from host.logs.tables import COLUMNS
from robot.record import NAMES
from tests.fakes import Rig, eventful


def running(ticks, joined=0):
    rig = Rig()
    rig.loop.start()
    rig.run(ticks)
    return rig.log(joined)


def test_the_stream_comes_out_as_it_went_in():
    rig = eventful()
    log = rig.log()
    copy = Log()
    log.play(copy)
    assert (copy.records, copy.events, copy.places) == (log.records, log.events, log.places)
    for event, place in zip(log.events, log.places, strict=True):
        assert (
            log.records[place].tick == event["tick"]
            if place < len(log)
            else event["tick"] == log.records[-1].tick + 1
        )
    assert list(log.stream()) == list(copy.stream())
    assert len(list(log.stream())) == len(log.records) + len(log.events)


def test_columns_are_the_channels_and_the_speeds():
    log = eventful().log()
    arrays = log.arrays()
    assert tuple(arrays) == (*NAMES, "left_omega_rad_s", "right_omega_rad_s")
    for name in NAMES:
        assert arrays[name].tolist() == [getattr(record, name) for record in log.records]
    assert np.all(np.diff(arrays["tick"]) == 1)
    assert arrays["left_duty_pct"].min() < 0
    assert set(arrays) == set(COLUMNS)
    assert log.column("left_omega_rad_s").tolist() == arrays["left_omega_rad_s"].tolist()


def test_a_log_that_grows_meanwhile_has_columns_of_one_length(monkeypatch):
    log = running(20)
    column = log.column

    def look(name):
        found, last = column(name), log.records[-1]
        log.take_records([last._replace(tick=last.tick + 1, t_s=last.t_s + last.dt_s)])
        return found

    monkeypatch.setattr(log, "column", look)  # as if a robot's thread came in between
    assert {len(column) for column in log.arrays().values()} == {20}
    speeds = log.omega("left")
    assert len(speeds) == 20
    log.column("tick")
    assert len(log) == 21
    assert log.until_now().omega("left")[:20].tolist() == speeds.tolist()


def test_what_a_log_has_now_stays_so():
    log = eventful().log()
    before, stream = log.until_now(), list(log.stream())
    walk = log.stream()
    begun = [next(walk) for _ in range(3)]
    log.take_event({"event": "stop", "tick": log.records[-1].tick + 1})
    log.take_records(log.records[-2:])
    assert [*begun, *walk] == stream == list(before.stream())
    assert len(before) == len(log) - 2
    assert before.info == log.info


def test_no_event_is_lost_in_a_log_whose_records_were_cut():
    log = eventful().log()
    del log.records[:20]
    events = [item for item in log.stream() if isinstance(item, dict)]
    assert events == log.events


def test_an_event_that_comes_meanwhile_is_there_as_soon_as_its_records_are():
    class Late(list):
        """Places that get one more whenever somebody takes a part of them."""

        def __getitem__(self, key):
            self.append(place)
            return super().__getitem__(key)

    for place, there in ((5, True), (30, False)):
        log = running(20)
        log.events, log.places = [{"event": "stop", "tick": place}], Late()
        assert bool(log.until_now().events) is there


def test_what_a_log_has_now_is_a_log_of_the_same_kind():
    log = kickctl.Log()
    running(3).play(log)
    assert type(log.until_now()) is kickctl.Log


def test_an_event_is_in_a_log_as_soon_as_its_place_is():
    log = eventful().log()
    whole = log.kicks(), log.restarts(), list(log.stream())
    log.events.append({"event": "kick", "kick": {}})
    assert (log.kicks(), log.restarts(), list(log.stream())) == whole


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("x1", "'left_x1'"),
        ("left_omega", "'left_omega_rad_s'"),
        ("rihgt_torque", "'right_torque'"),
        ("time", "t_s"),
        ("", "t_s"),
    ],
)
def test_an_unknown_column_is_answered_with_what_was_meant(name, meant):
    with pytest.raises(KickctlError, match="no column") as refusal:
        Log().column(name)
    assert meant in refusal.value.hint


def test_differences_of_ticks_do_not_wrap_around():
    log = running(3)
    log.records.reverse()
    assert np.diff(log.column("tick")).tolist() == [-1, -1]


def test_speed_is_the_turn_over_the_time_since_the_record_before():
    log = running(30)
    omega = log.omega("left")
    for row in (1, 7, 22, 29):
        before, now = log.records[row - 1], log.records[row]
        assert omega[row] == (now.left_phi_rad - before.left_phi_rad) / (now.t_s - before.t_s)
    assert omega[0] == omega[1]
    assert np.abs(omega).max() > 5
    assert np.isnan(running(1).omega("left")).tolist() == [True]
    assert Log().omega("right").tolist() == []


def test_no_speed_spans_a_restart():
    log = running(20)
    log.take_event({"event": "restart", "tick": 0, "boot": "b"})
    # Ticks and times go on as if nothing had been: only the event says so.
    log.take_records(
        [
            record._replace(right_phi_rad=record.right_phi_rad + 100)
            for record in running(35).records[20:]
        ]
    )
    assert log.restarts() == [20]
    omega = log.omega("right")
    assert omega[20] == omega[21]
    assert np.abs(omega).max() < 20
    first, second = log.records[:20], log.records[20:]
    assert log.seconds == first[-1].t_s - first[0].t_s + second[-1].t_s - second[0].t_s


@pytest.mark.parametrize(
    ("pieces", "gaps"),
    [
        ([(0, 20)], []),
        ([(7, 20)], []),
        ([(0, 5), (5, 20)], []),
        ([(0, 5), (6, 9), (15, 20)], [(5, 6), (9, 15)]),
    ],
)
def test_gaps_are_found(pieces, gaps):
    whole = running(20)
    log = Log()
    for first, end in pieces:
        log.take_records(whole.records[first:end])
    assert log.missing() == gaps


def test_what_a_restarted_robot_no_longer_has_is_missing():
    log = running(20)
    log.take_event({"event": "restart", "tick": 0, "boot": "b"})
    log.take_records(running(40).records[30:])
    assert log.missing() == [(0, 30)]
    log.take_event({"event": "restart", "tick": 0, "boot": "c"})
    log.take_records(running(5).records)
    assert log.missing() == [(0, 30)]


def test_kicks_are_found_at_the_record_in_which_they_begin():
    rig = Rig()
    rig.loop.start()
    rig.run(10)
    begin = rig.kick("phase", ticks=4)
    rig.run(10)
    log = rig.log(tick=3)
    [(row, kick)] = log.kicks()
    assert log.records[row].tick == kick["begin"] == begin
    assert log.records[row].kick != 0
    assert log.records[row - 1].kick == 0


def test_a_log_introduces_itself():
    log = running(20)
    log.info["brick"] = "sim://"
    assert repr(log).startswith("<Log: 20 ticks, 0.")
    assert "sim://" in repr(log)
    assert "missing" not in repr(log)
    del log.records[4:6]
    assert "2 ticks missing" in repr(log)
    assert repr(Log()) == "<Log: 0 ticks, 0.00 s, kicks: 0>"


def test_a_log_alone_loads_nothing_heavy():
    heavy = {"numpy", "mcap", "matplotlib"}
    code = f"import sys, host.logs.log; sys.exit(bool({heavy} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
