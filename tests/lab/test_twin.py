"""A twin goes its own way under the robot's kicks, from where the robot stood."""

import pytest

from host.client.robot import connect
from host.errors import WrongUse
from host.lab.tape import Cut, make_tape
from host.logs.log import Log
from host.logs.replay import replay
from robot.kicks import WHEELS
from robot.record import NAMES, Record
from tests.lab.tapes import rows_of, twins_rows_of


@pytest.fixture(scope="module")
def log():
    """A robot that rolls, is kicked thrice, the third time too late, stops and starts again."""
    with connect("sim://?seed=3") as robot, robot.recording() as log:
        robot.wait(2.0)
        robot.kick("phase", ticks=4, wheel="left")
        robot.wait(3.5)
        robot.kick("membrane")
        robot.wait(3.5)
        robot.kick("position", ticks=3)
        robot.wait(0.5)
        robot.stop()
        robot.wait(0.5)
        robot.start()
        robot.wait(1.0)
    return log


@pytest.fixture(scope="module")
def tape(log):
    return make_tape(log, "log", motor="pybricks")


def travel(rows, begin, end):
    return rows[end]["left_phi_rad"] - rows[begin]["left_phi_rad"]


def own(row):
    return Record(*(row[name] for name in NAMES))


def test_it_begins_with_the_robots_bits_and_again_at_each_start(log, tape):
    twin = [own(row) for row in twins_rows_of(tape)]
    starts = [
        place
        for event, place in zip(log.events, log.places, strict=True)
        if event["event"] == "start"
    ]
    assert len(starts) == 1
    for place in (0, *starts):
        assert twin[place] == log.records[place]
    assert twin[50].left_phi_rad != log.records[50].left_phi_rad
    assert [record.t_s for record in twin] == [record.t_s for record in log.records]


def test_it_runs_the_robots_program(log, tape):
    copy = Log(log.info)
    twin = iter([own(row) for row in twins_rows_of(tape)])
    for item in log.stream():
        if isinstance(item, dict):
            copy.take_event(item)
        else:
            copy.take_records([next(twin)])
    result = replay(copy)
    assert result.exact
    assert result.compared == len(log) - 1


def test_the_same_motor_does_the_same_under_each_kick_that_was_left_alone(tape):
    kicks = tape["twin"]["kicks"]
    both = dict.fromkeys(WHEELS, "reverses")
    assert [kick["robot"] for kick in kicks] == [{"left": "reverses"}, both]
    assert [kick["twin"] for kick in kicks] == [{"left": "reverses"}, both]


def test_another_motor_turns_at_another_speed(log, tape):
    other = make_tape(log, "log", motor="nxt_unroller")
    assert other["twin"]["motor"] == "nxt_unroller"
    turned = [travel(twins_rows_of(one), 30, 60) for one in (tape, other)]
    assert turned[1] != pytest.approx(turned[0], rel=0.02)


def test_a_part_of_a_log_has_a_twin_from_its_first_tick(log):
    part = make_tape(log, "log", Cut(1.0, 4.0), "pybricks")
    rows, twin = rows_of(part), twins_rows_of(part)
    assert len(rows) == len(twin)
    assert own(twin[0]) == own(rows[0])
    assert travel(twin, 0, 30) == pytest.approx(travel(rows, 0, 30), rel=0.1)


def test_a_log_in_which_nothing_happens_has_a_twin_too():
    with connect("sim://?seed=3") as robot:
        log = robot.record(1.0)
    tape = make_tape(log, "log", motor="pybricks")
    assert tape["twin"]["kicks"] == []
    assert len(rows_of(tape)) == len(twins_rows_of(tape)) == len(log)


def test_a_motor_that_nobody_knows_is_refused(log):
    with pytest.raises(WrongUse, match="none"):
        make_tape(log, "log", motor="none")
    other = Log({**log.info, "motor": "none"})
    with pytest.raises(WrongUse, match="does not know the motors of the log's robot, 'none'"):
        make_tape(other, "log", motor="")


def test_the_log_says_which_motors_its_robot_has(log):
    tape = make_tape(log, "log", motor="")
    assert tape["facts"]["motor"] == tape["twin"]["motor"] == log.info["motor"] == "pybricks"
    assert tape["robot"]["stall"] == pytest.approx(0.1)
