"""A running robot's twin: what a replay's twin does, tick by tick, and what pages hear of it."""

import struct

import pytest

from host.client.robot import connect
from host.errors import WrongUse
from host.lab import derived
from host.lab.allowance import Allowance
from host.lab.keys import Keys
from host.lab.live_twin import BURST, LiveTwin
from host.lab.outgoing import outgoing
from host.lab.session import Session
from host.lab.stepped_station import SteppedStation
from host.lab.tape import make_tape
from host.logs.log import Log
from robot.record import NAMES, STRUCT, Record, unpack
from tests.lab.conftest import Visit
from tests.lab.live import Ears
from tests.lab.own_lab import HEADER
from tests.lab.tapes import twins_rows_of

CHANNELS = [row.name for row in derived.CHANNELS]


def compared(station):
    """What pages have heard of kicks of the robot and its twin."""
    return [one for one in station.pages.heard if one["type"] == "twin"]


def rows_of(ring):
    """The records of a ring with their derived channels."""
    rows, place = [], ring.latest(10_000)
    while place < ring.end:
        portion = ring.read(place, 200)
        place = portion.place
        for at in range(0, len(portion.data), derived.SIZE):
            packed = portion.data[at : at + derived.SIZE]
            (record,) = unpack(packed[: STRUCT.size])
            values = struct.unpack(f"<{len(CHANNELS)}f", packed[STRUCT.size :])
            rows.append({**record._asdict(), **dict(zip(CHANNELS, values, strict=True))})
    return rows


def own(row):
    return Record(*(row[name] for name in NAMES))


class LoggedStation(SteppedStation):
    """A station that keeps a log of all that it hears."""

    def __init__(self, twin):
        self.robot = connect("sim://?seed=3")
        self.log = Log(self.robot.info())
        super().__init__(self.robot, "anna", twin=twin)
        self.pages = Ears()

    def take_records(self, records):
        self.log.take_records(records)
        super().take_records(records)

    def take_event(self, event):
        self.log.take_event(event)
        super().take_event(event)


@pytest.fixture(scope="module")
def run():
    """A robot and its twin that roll, are kicked, stopped and started again; and a log of it."""
    station = LoggedStation(LiveTwin("nxt_unroller"))
    robot = station.robot
    station.step(2.0)
    robot.kick("phase", ticks=4, wheel="left")
    station.step(6.5)
    robot.kick("membrane")
    station.step(0.3)
    station.stop()
    station.step(0.5)
    robot.start()
    station.step(2.0)
    yield station, station.log
    station.close()


def test_it_does_bit_for_bit_what_the_twin_of_a_replay_does(run):
    station, log = run
    tape = make_tape(log, "log", motor="nxt_unroller")
    replayed = twins_rows_of(tape)[1:]  # the first record has no speed, and pages do not get it
    twin = rows_of(station.twin.ring)
    assert len(twin) > 300
    assert twin == [{name: row[name] for name in (*NAMES, *CHANNELS)} for row in replayed]


def test_what_both_did_is_said_of_each_kick_with_an_outcome(run):
    station, _ = run
    (message,) = compared(station)
    assert message["robot"] == "anna"
    assert message["robot_did"]["result"] == message["twin_did"]["result"] == {"left": "reverses"}
    assert message["same"]
    assert message["score"] == {"same": 1, "kicks": 1}
    assert station.twin_description()["compared"][0]["kick_id"] == message["kick_id"]


def test_where_a_twin_begins_again_its_speed_is_the_robots(run):
    station, log = run
    (start,) = [event["tick"] for event in log.events if event["event"] == "start"]
    first = next(row for row in rows_of(station.twin.ring) if row["tick"] == start)
    same = next(row for row in rows_of(station.ring) if row["tick"] == start)
    assert own(first) == own(same)
    assert first["left_omega_rad_s"] == same["left_omega_rad_s"]


def test_it_stands_as_long_as_the_robot_is_stopped(run):
    station, log = run
    (stop,) = [event["tick"] for event in log.events if event["event"] == "stop"]
    rows = [row for row in rows_of(station.twin.ring) if stop + 10 <= row["tick"] < stop + 16]
    assert len(rows) == 6
    assert {row["left_duty_pct"] for row in rows} == {0}
    assert {row["left_phi_rad"] for row in rows} == {rows[0]["left_phi_rad"]}


def test_what_pushes_the_robot_does_not_push_its_twin():
    station = LoggedStation(LiveTwin())
    robot = station.robot
    station.step(2.0)
    way = robot.newest.left_torque
    robot.kick("membrane", wheel="left")
    robot.link.brick.set_load(0, 0.2 if way > 0 else -0.2)  # it has to go on as before
    station.step(6.5)
    (message,) = compared(station)
    assert message["robot_did"]["result"] == {"left": "continues"}
    assert message["twin_did"]["result"] == {"left": "reverses"}
    assert not message["same"]
    assert message["score"] == {"same": 0, "kicks": 1}
    station.close()


def test_after_a_gap_it_begins_where_the_robot_is(run):
    _, log = run
    twin, records = LiveTwin(), log.records
    twin.meet({}, None)
    twin.take_records(records[:50], 0.0)
    twin.take_records(records[80:120], 3.0)
    rows = {row["tick"]: row for row in rows_of(twin.ring)}
    first = records[80]
    assert own(rows[first.tick]) == first
    assert own(rows[records[119].tick]) != records[119]


def test_it_begins_again_with_the_robots_program(run):
    """The robot's clock and its ticks begin again, too."""
    _, log = run
    twin, records = LiveTwin(), log.records[:40]
    twin.meet({}, None)
    twin.take_records(records, 0.0)
    first = rows_of(twin.ring)
    twin.take_event({"event": "restart", "tick": 0})
    twin.take_records(records, 2.0)
    again = rows_of(twin.ring)[len(first) :]
    assert [row["tick"] for row in again] == [row["tick"] for row in first]
    assert again[-1]["left_phi_rad"] == pytest.approx(first[-1]["left_phi_rad"], abs=0.1)
    assert first[-1]["left_phi_rad"] != records[-1].left_phi_rad


def test_what_comes_all_at_once_is_passed_over(run):
    _, log = run
    twin = LiveTwin()
    twin.meet({}, None)
    burst = int(BURST)
    assert len(log.records) > burst
    twin.take_records(log.records[:-1], 10.0)
    assert twin.ring.end == burst - 1
    twin.take_records(log.records[-1:], 11.0)
    assert own(rows_of(twin.ring)[-1]) == log.records[-1]


def test_numbers_that_nobody_can_compute_with_do_not_end_the_stream(run):
    _, log = run
    twin = LiveTwin()
    twin.meet({}, None)
    twin.take_event(log.events[0])
    twin.take_event({"event": "params", "tick": 0, "set": {"a": 1e6}})
    huge = [record._replace(left_x1=-1e6) for record in log.records[:5]]
    assert twin.take_records(huge, 0.0) is None
    twin.take_event(log.events[0])
    end = twin.ring.end
    twin.take_records(log.records[5:10], 1.0)
    assert twin.ring.end > end


def test_of_a_robot_with_unknown_motors_there_is_none_and_it_says_why():
    twin = LiveTwin()
    twin.meet({"motor": "none"}, 8.0)
    told = twin.description({})
    assert "does not know the motors of this robot, 'none'" in told["why"]
    assert "--twin NAME" in told["hint"]
    assert twin.take_records([], 0.0) is None
    named = LiveTwin("pybricks")
    named.meet({"motor": "none"}, 8.0)
    assert named.trouble is None
    with pytest.raises(WrongUse, match="none"):
        LiveTwin("none")


def test_pages_get_the_twin_behind_all_robots_and_cannot_drive_it():
    keys = Keys()
    anna = LoggedStation(LiveTwin())
    bert = SteppedStation("sim://?seed=4", "bert")
    session = Session(keys, [anna, bert])

    class Here:
        now = 0.0

    here = Here()
    here.session = session
    visit = Visit(here, keys.drive)
    welcome = visit.latest("welcome")
    assert [one["name"] for one in welcome["robots"]] == ["anna", "bert"]
    assert [(one["name"], one["robot"]) for one in welcome["twins"]] == [("twin of anna", "anna")]
    assert welcome["twins"][0]["motor"] == "pybricks"
    anna.step(0.3)
    packed = [one for one in outgoing(visit.page, session.rings) if isinstance(one, bytes)]
    assert [HEADER.unpack_from(one)[1] for one in packed] == [0, 2]
    for fields in ({"command": "start"}, {"command": "kick", "arguments": {"mode": "phase"}}):
        refused = visit.ask("do", robot="twin of anna", **fields)["error"]
        assert "a twin does what its robot is asked to" in refused["message"]
    assert not visit.drives
    anna.close()
    bert.close()


def test_an_allowance_fills_by_itself_up_to_its_edge():
    allowance = Allowance(0.0, 10.0, 3.0)
    assert [allowance.take(5.0) for _ in range(4)] == [True, True, True, False]
    assert [allowance.take(5.15) for _ in range(2)] == [True, False]
