"""The table of commands, from the robot's side alone: this runs on the brick's Python too."""

import pytest

from robot import commands, wire
from robot.errors import Refused
from robot.loop import LATENESS_EDGES_S
from robot.session import Session
from tests.rig import TOKEN, Rig

TABLES = ("params", "channels", "commands")


@pytest.fixture
def session():
    session = Session(Rig().loop, TOKEN, "boot")
    session.client, session.name = "1", "anna"
    return session


def execute(session, do, sealed=True, **arguments):
    request = dict(arguments, id=1, do=do)
    return wire.load(commands.execute(session._loop, session, request, sealed))


def refusal(session, do, **arguments):
    with pytest.raises(Refused) as error:
        execute(session, do, **arguments)
    return error.value


def test_every_command_of_the_table_is_there_and_its_answer_fits_into_a_frame(session):
    execute(session, "lease")
    arguments = {
        "describe": {"table": "params"},
        "kick": {"kick": {"id": "1", "mode": "phase"}},
        "set": {"set": {"k": 7.0}},
    }
    # In an order in which each may be done.
    order = ["start", "kick", "stop", "set", "clear"]
    for name in order + sorted(set(commands.TABLE) - set(order)):
        if name == "clear":
            session._loop.fail("the test")
        result = execute(session, name, **arguments.get(name, {}))
        assert len(wire.encode_json(wire.REPLY, {"id": 1, "result": result}))
    for table in TABLES:
        assert wire.encode_json(wire.REPLY, execute(session, "describe", table=table))


@pytest.mark.parametrize("name", sorted(commands.TABLE))
def test_what_moves_the_robot_or_changes_it_needs_the_token(session, name):
    row = commands.TABLE[name]
    if row.sealed:
        assert refusal(session, name, sealed=False).code == "token"
    elif name == "describe":
        assert execute(session, name, sealed=False, table="params")
    else:
        execute(session, name, sealed=False)


@pytest.mark.parametrize(
    ("do", "arguments", "code"),
    [
        ("dance", {}, "unknown"),
        (["status"], {}, "unknown"),
        ("status", {"now": 1}, "usage"),
        ("describe", {"table": "\U0001f9be"}, "usage"),
        ("subscribe", {"from": 10**12}, "range"),
        ("subscribe", {"from": True}, "range"),
        ("lease", {"take_over": "\ud800"}, "usage"),
        ("kick", {"kick": 1}, "lease"),
        ("start", {}, "lease"),
    ],
)
def test_what_cannot_be_done_is_refused_in_words(session, do, arguments, code):
    refused = refusal(session, do, **arguments)
    assert refused.code == code
    assert refused.message
    assert refused.hint


def test_a_kick_needs_a_request(session):
    execute(session, "lease")
    assert refusal(session, "kick", kick=1).code == "usage"


def test_the_status_says_what_holds_now(session):
    loop = session._loop
    before = execute(session, "status")
    execute(session, "lease")
    execute(session, "set", set={"k": 7.0})
    execute(session, "start")
    loop.missed += 1
    loop.lateness[0] += 1
    after = execute(session, "status")
    assert {name for name in before if before[name] != after[name]} == {
        "state",
        "reason",
        "controller",
        "controller_held_s",
        "missed",
        "params",
        "lateness",
    }
    assert after["params"] == dict(before["params"], k=7.0)
    assert after["lateness"]["edges_s"] == list(LATENESS_EDGES_S)
    assert after["lateness"]["counts"] == loop.lateness
