"""One peer's conversation: who may do what, and that a refused request changes nothing."""

import pytest

from robot import commands, wire
from robot.beacon import LASTS_S
from robot.record import STATES
from robot.session import Session
from tests.link.sessions import refused, reply
from tests.rig import PERIOD, TOKEN
from tests.talk import Client

SEALED = [row.name for row in commands.TABLE.values() if row.sealed]
OPEN = [row.name for row in commands.TABLE.values() if not row.sealed]


def test_an_observer_may_look_and_stop_and_nothing_else(rig):
    observer = Client(rig.loop, token=None).greet()
    before = rig.fingerprint()
    for name in OPEN:
        observer.ask(name, **({"table": "params"} if name == "describe" else {}))
    for name in SEALED:
        refused("token", observer.ask, name)
    assert rig.fingerprint() == before
    assert not observer.session.closing
    assert observer.stop() == (3, "stopped", "'tester' stopped it", ())
    rig.run(1)
    assert (rig.last.state, rig.duties) == (3, (0, 0))


def test_a_stop_frame_needs_no_hello_no_token_and_no_sense(rig):
    session = Session(rig.loop, TOKEN, "boot")
    assert reply(session.receive(wire.STOP, b"\xff{NaN")) == {
        "id": None,
        "result": {
            "tick": 3,
            "state": "stopped",
            "reason": "somebody without a name stopped it",
            "unstopped": [],
        },
    }
    assert rig.duties == (0, 0)
    assert "somebody without a name" in rig.loop.safety.reason
    assert not session.closing


@pytest.mark.parametrize("kind", [wire.ASK, wire.AUTH, wire.COMMAND, wire.BEAT])
def test_before_the_hello_nothing_is_understood(rig, kind):
    session = Session(rig.loop, TOKEN, "boot")
    before = rig.fingerprint()
    assert reply(session.receive(kind, b'{"id":1,"do":"status"}'))["error"]["code"] == "broken"
    assert session.closing
    assert rig.fingerprint() == before


def test_the_token_alone_does_not_control(rig):
    client = Client(rig.loop).greet()
    before = rig.fingerprint()
    for name, arguments in (
        ("start", {}),
        ("stop", {}),
        ("clear", {}),
        ("kick", {"kick": {"id": "1", "mode": "membrane"}}),
        ("set", {"set": {"k": 1.0}}),
    ):
        refused("lease", client.tell, name, **arguments)
    assert rig.fingerprint() == before


def test_a_second_controller_is_refused_until_the_first_lets_go(rig, client):
    second = Client(rig.loop, name="second").greet()
    before = rig.fingerprint()
    assert "tester" in refused("lease", second.tell, "lease").message
    refused("lease", second.tell, "stop")
    second.tell("release")
    second.tell("heartbeat")
    assert rig.fingerprint() == before
    client.tell("release")
    second.tell("lease")
    refused("lease", client.tell, "stop")
    client.stop()
    assert rig.duties == (0, 0)


def test_others_words_do_not_keep_a_lease(rig, client):
    second = Client(rig.loop, name="second").greet()
    for _ in range(20):
        second.beat()
        client.ask("status")
        rig.run(1)
    assert client.ask("status")["controller"] is None
    assert rig.last.state == 3


@pytest.mark.parametrize("how", ["beat", "heartbeat"])
def test_a_beat_keeps_it_and_so_does_an_older_hosts_heartbeat(rig, client, how):
    show_life = client.beat if how == "beat" else lambda: client.tell("heartbeat")
    for _ in range(20):
        rig.run(10)
        show_life()
    assert client.ask("status")["controller"] == "tester"


def test_a_robot_is_taken_over_as_it_runs_and_the_loser_is_told(rig, client):
    teacher = Client(rig.loop, name="teacher").greet()
    assert client.tell("heartbeat") == {"tick": 3, "taken_over_by": None}
    teacher.tell("lease", take_over=True)
    assert (STATES[rig.loop.safety.state], rig.loop.safety.reason) == ("running", "started")
    assert rig.events[-1]["reason"] == "'teacher' has taken over from 'tester'"
    assert client.tell("heartbeat")["taken_over_by"] == "teacher"
    client.talk.taken_over_by = None
    assert client.beat() == "teacher"
    assert teacher.beat() is None
    for attempt in ("lease", "start", "stop"):
        assert "'teacher' has taken over" in refused("lease", client.tell, attempt).message
    for _ in range(20):
        client.beat()
        teacher.beat()
        rig.run(1)
    assert STATES[rig.last.state] == "running"
    status = client.ask("status")
    assert status["controller"] == "teacher"
    assert status["controller_held_s"] == pytest.approx(20 * PERIOD)


def test_a_takeover_does_not_spare_the_new_host_its_heartbeats(rig, client):
    Client(rig.loop, name="teacher").greet().tell("lease", take_over=True)
    for _ in range(20):
        client.tell("heartbeat")
        rig.run(1)
    assert (STATES[rig.last.state], rig.loop.safety.reason) == (
        "stopped",
        "'teacher' was silent for 0.5 s",
    )


def test_a_held_robot_goes_on_for_who_takes_over(rig, client):
    client.tell("set", set={"link_loss": "hold"})
    rig.run(20)
    assert STATES[rig.last.state] == "held"
    Client(rig.loop, name="teacher").greet().tell("lease", take_over=True)
    assert STATES[rig.loop.safety.state] == "running"


def test_a_hello_says_who_drives_since_when_and_who_has_taken_over(rig, client):
    rig.run(2)
    hello = Client(rig.loop, name="watcher", token=None).greet().talk.hello
    assert (hello["controller"], hello["taken_over_by"]) == ("tester", None)
    assert hello["controller_held_s"] == pytest.approx(2 * PERIOD)
    teacher = Client(rig.loop, name="teacher").greet()
    teacher.tell("lease", take_over=True)
    teacher.tell("release")
    hello = Client(rig.loop, name="tester").greet().talk.hello
    assert (hello["controller"], hello["controller_held_s"]) == (None, None)
    assert hello["taken_over_by"] == "teacher"


def test_a_robot_shows_itself_to_who_has_no_token_and_goes_on(rig):
    rig.loop.beacon.ways = ["lights", "beep"]
    before = rig.fingerprint()
    observer = Client(rig.loop, token=None, name="anna").greet()
    assert observer.ask("identify") == {"seconds": LASTS_S, "ways": ["lights", "beep"]}
    assert (rig.loop.beacon.by, rig.loop.beacon.number) == ("'anna'", 1)
    assert rig.fingerprint() == before
