"""The host's client when links break, and robots restart or stay away: logs are complete."""

import gc
import json
import socket
import threading
import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.client.robot import Robot, connect
from host.errors import NoLink, RefusedByRobot, WrongUse
from host.link.transport import TcpLink
from host.logs.log import Log
from host.util.own_name import own_name
from robot.session import Session
from tests.link.machines import RigLink, TcpRobot, open_files
from tests.rig import TOKEN, packed
from tests.talk import Client

# Cut links


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.integers(0, 3000), st.sampled_from(("kick", "set", "wait"))), max_size=12)
)
def test_a_log_misses_nothing_and_hears_nothing_twice_wherever_the_link_is_cut(cuts):
    link = RigLink()
    link.loop.set_params({"link_loss": "continue"})
    with Robot(link, link.token) as robot:
        log = Log()
        robot.add_tap(log)
        first = link.loop.blackbox.next_tick
        for place, what in cuts:
            link.left = place
            if what == "kick":
                robot.kick("membrane")
            elif what == "set":
                robot.set(k=place / 100.0)
            robot.wait(0.3)
        robot.wait(0.2)
        robot.remove_tap(log)
    assert [record.tick for record in log.records] == list(range(first, first + len(log.records)))
    assert packed(log.records) == packed(link.records()[first : first + len(log.records)])
    received = [event for event in log.events if event["event"] not in ("snapshot", "lost")]
    noted = json.loads(json.dumps([event for event in link.events() if event["tick"] >= first]))
    assert received == noted[: len(received)]
    assert all(event["tick"] > log.records[-1].tick for event in noted[len(received) :])
    assert len([event for event in received if event["event"] == "kick"]) == sum(
        what == "kick" for _, what in cuts
    )
    assert [event["event"] for event in log.events if event["event"] in ("snapshot", "lost")] == [
        "snapshot"
    ]


def test_a_command_that_the_link_swallowed_is_done_once(robot, link):
    """Cut before the robot has read it, and cut before its answer is back.

    The kick happens once, in the tick of the answer.
    """
    robot.set(link_loss="continue")
    for cut_the_answer in (False, True):
        before = len(link.events())
        send = link.send

        def swallow(data, send=send, cut_the_answer=cut_the_answer):
            link.send = send
            if cut_the_answer:
                send(data)
                link.run_tick()
            link.cut()

        link.send = swallow
        tick = robot.kick("membrane")
        robot.wait(0.1)
        kicks = [event for event in link.events()[before:] if event["event"] == "kick"]
        assert [event["tick"] for event in kicks] == [tick]


@pytest.mark.parametrize("arrives", [False, True], ids=["lost", "its answer lost"])
@pytest.mark.parametrize("command", ["start", "clear"])
def test_what_a_stop_must_end_is_not_sent_again(robot, link, command, arrives):
    """Somebody stops the robot, or a fault comes, while the link that swallowed it is down."""
    robot.stop()
    if command == "clear":
        link.loop.fail("first")
    send = link.send

    def swallow(data):
        link.send = send
        if arrives:
            send(data)
            link.run_tick()
        link.cut()
        if command == "clear":
            link.loop.fail("second")
        else:
            link.loop.stop("a person stopped it")

    robot.lease()
    link.send = swallow
    with pytest.raises(NoLink, match=f"'{command}' may not have reached the robot; it is not sent"):
        robot.command(command)
    robot.wait(0.5)
    state = {"start": "stopped", "clear": "fault"}[command]
    assert robot.status()["state"] == state
    assert robot.command(command) > 0
    assert robot.status()["state"] != state


def test_a_start_that_waits_for_a_lost_link_is_not_sent_when_it_is_back(robot, link):
    robot.stop()
    robot.lease()
    link.cut()
    with pytest.raises(NoLink, match="as somebody may have stopped the robot since"):
        robot.start()
    assert robot.status()["state"] == "stopped"
    robot.start()
    assert robot.status()["state"] == "running"


def test_a_host_that_comes_back_still_controls(robot, link):
    robot.set(link_loss="hold")
    link.cut(away_s=1.0)
    robot.wait(0.1)
    assert robot.status()["state"] == "running"
    assert [event["event"] for event in link.events()[-3:]] == ["link_loss", "hold", "resume"]
    link.cut(away_s=0.1)
    robot.set(k=5.0)
    assert link.events()[-1]["event"] == "params"


def test_a_host_whose_place_was_taken_is_told_so(robot, link):
    robot.set(link_loss="continue")
    link.cut(away_s=1.0)
    while link.loop.lease.holder is not None:
        link.run_tick()
    other = Client(link.loop, link.token, name="other")
    other.session._token = link.token
    other.greet().tell("lease")
    link.loop.params.link_loss_s = 10.0
    robot.wait(0.1)
    with pytest.raises(RefusedByRobot, match="other"):
        robot.kick("membrane")
    robot.stop()
    assert link.loop.safety.reason == f"'{own_name()}' stopped it"


def test_a_host_that_was_away_too_long_is_told_exactly_what_it_lost():
    link = RigLink(capacity=50)
    with Robot(link, link.token) as robot:
        log = Log()
        robot.add_tap(log)
        robot.wait(0.3)
        link.cut(away_s=6.0)
        robot.wait(6.5)
    (lost,) = [event for event in log.events if event["event"] == "lost"]
    assert log.missing() == [(lost["from"], lost["tick"])]
    ticks = [record.tick for record in log.records]
    assert lost["from"] in range(8, 14)
    assert lost["tick"] - lost["from"] > 100
    assert ticks == [*range(ticks[0], lost["from"]), *range(lost["tick"], ticks[-1] + 1)]
    assert log.events[-1]["event"] == "snapshot"


def test_a_robot_that_began_anew_is_noticed_and_followed(robot, link):
    log = Log()
    robot.add_tap(log)
    robot.wait(0.5)
    boot = robot.hello["boot"]
    link.restart()
    robot.wait(0.5)
    assert robot.hello["boot"] != boot
    assert [event["event"] for event in log.events] == ["snapshot", "restart", "snapshot", "start"]
    assert log.restarts() == [log.places[1]]
    after = log.records[log.places[1] :]
    assert [record.tick for record in after] == list(range(len(after)))
    assert log.missing() == []


def test_a_robot_that_stays_away_is_given_up_on(robot, link):
    robot.wait(0.1)
    begin = link.now()
    link.cut(away_s=1000.0)
    with pytest.raises(NoLink, match="did not come back"):
        robot.wait(1.0)
    assert Robot.reconnect_s <= link.now() - begin < Robot.reconnect_s + 1.0
    for call in (robot.status, robot.stop, lambda: robot.pump(0.0), lambda: robot.kick("phase")):
        with pytest.raises(NoLink):
            call()


# Calls


def test_a_pull_brings_the_whole_black_box_once(robot, link):
    robot.wait(0.5)
    robot.kick("position", ticks=2)
    robot.wait(0.5)
    log = Log()
    robot.pull(log)
    assert [event["event"] for event in log.events] == ["snapshot", "start", "kick"]
    assert packed(log.records) == packed(link.records()[: len(log.records)])
    assert log.records[0].tick == 0
    assert len(log.records) > 30
    again = Log()
    link.left = 2000
    robot.pull(again)
    assert packed(again.records)[: len(packed(log.records))] == packed(log.records)
    assert again.missing() == []


def test_a_lease_is_kept_while_waiting_and_given_back_at_the_end(link):
    with Robot(link, link.token) as robot:
        robot.lease()
        robot.wait(5.0)
        assert link.loop.lease.holder is not None
    assert link.loop.lease.holder is None
    link.run_tick()
    assert link.loop.safety.reason == "started"


def test_numbers_that_are_none_are_refused_before_they_are_sent(robot):
    for call in (
        lambda: robot.set(k=float("nan")),
        lambda: robot.kick("phase", shift=float("inf")),
    ):
        with pytest.raises(WrongUse):
            call()
    assert robot.status()["params"]["k"] == 8.0


def test_a_machine_without_the_token_may_look_and_stop(link):
    with Robot(link, None) as robot:
        assert robot.status()["state"] == "running"
        assert len(robot.record(0.3).records) >= 10
        for call in (
            robot.start,
            robot.lease,
            lambda: robot.kick("phase"),
            lambda: robot.set(k=1.0),
            robot.clear,
        ):
            with pytest.raises(RefusedByRobot, match="token"):
                call()
        robot.stop()
        assert robot.status()["state"] == "stopped"


def test_who_has_another_robots_token_looks_on_and_leaves_nothing_open(link, caplog):
    gc.collect()
    files = open_files()
    with Robot(link, b"x" * 32) as robot:
        assert link.opened == 1  # ssh would ask a person for the password again
        assert robot.record(0.3).missing() == []
        for call in (robot.start, robot.lease, robot.clear):
            with pytest.raises(RefusedByRobot, match="the token of another robot"):
                call()
        link.cut()
        robot.wait(0.3)  # over another connection
        robot.stop()
        assert robot.status()["state"] == "stopped"
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert "not that of the robot" in caplog.text
    del robot
    gc.collect()
    assert open_files() == files


def test_an_older_robot_hangs_up_on_a_wrong_token_and_is_looked_at_over_a_new_link(
    link, monkeypatch
):
    refuse = Session._authenticate

    def refuse_and_hang_up(session, message):
        answer = refuse(session, message)
        session.closing = not session.trusted
        return answer

    monkeypatch.setattr(Session, "_authenticate", refuse_and_hang_up)
    with Robot(link, b"x" * 32) as robot:
        assert link.opened == 2
        assert robot.status()["state"] == "running"
        assert robot.token_refused


def test_a_session_leaves_nothing_open():
    with connect("sim://", seed=1) as robot:
        robot.wait(0.1)
        files = open_files()
    assert open_files() == files - 2


# Real links


@pytest.fixture
def machine():
    machine = TcpRobot(link_loss_s=0.2)
    yield machine
    machine.close()


def test_closing_waits_for_no_robot_that_is_looked_for(machine):
    lost = threading.Event()
    robot = Robot(machine.link(), TOKEN)
    robot.reconnect_s = 1e9
    robot.on_trouble = lambda words: lost.set()
    robot.lease()
    machine.close()
    assert lost.wait(60.0)
    robot.close()
    with pytest.raises(NoLink, match="closed"):
        robot.status()


def test_an_idle_notebook_keeps_its_lease_and_its_record(machine):
    """Real time: nothing but the client's own thread keeps the link alive here."""
    machine.loop.params.link_loss_s = 1.0
    with Robot(machine.link(), TOKEN) as robot:
        robot.lease()
        log = Log()
        robot.add_tap(log)
        time.sleep(1.5)
        assert machine.loop.lease.holder is not None
        assert machine.loop.safety.reason == "started"
        assert len(log) > 40
        assert log.missing() == []


def break_connection(robot):
    """Break a robot's connection once there is one."""
    while True:
        try:
            robot.link._socket.shutdown(socket.SHUT_RDWR)
        except OSError:  # the one before is broken, and this one is not made yet
            robot.wait(0.01)
        else:
            return


def test_a_tcp_link_that_breaks_comes_back_without_a_gap(machine):
    with Robot(machine.link(), TOKEN) as robot:
        log = Log()
        robot.add_tap(log)
        for _ in range(5):
            robot.wait(0.05)
            break_connection(robot)
        robot.wait(0.05)
        assert log.missing() == []
        assert len(log) > 25
        assert [event["event"] for event in log.events] == ["snapshot"]


def test_where_nobody_listens_is_told_in_words():
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        with pytest.raises(NoLink, match="no robot's program runs"):
            Robot(TcpLink(f"tcp://127.0.0.1:{port}", "127.0.0.1", port), None)
