"""Requests that make no sense: they are refused, and change nothing."""

import json
from math import inf, nan

import pytest

from host.errors import WrongUse
from robot import commands, wire
from robot.params import TABLE
from tests.link.sessions import refused, reply
from tests.talk import Client

OPEN = [row.name for row in commands.TABLE.values() if not row.sealed]


@pytest.mark.parametrize(
    ("do", "arguments"),
    [
        *(
            ("set", {"set": {name: value}})
            for name in TABLE
            for value in (None, "x", True, [], 1e9, -1e9)
        ),
        ("set", {}),
        ("set", {"set": {}}),
        ("set", {"set": {"k": 1.0, "speed": 1.0}}),
        ("set", {"set": {"polarity_left": -1}}),
        ("start", {}),
        ("clear", {}),
        ("stop", {"now": True}),
        ("kick", {}),
        ("kick", {"kick": []}),
        *(
            ("kick", {"kick": {"id": "1", "mode": "phase", "ticks": ticks}})
            for ticks in (0, -1, 1.5, None, 10**9)
        ),
        ("kick", {"kick": {"id": "1", "mode": "shove"}}),
        ("kick", {"kick": {"mode": "phase"}}),
        ("jump", {}),
        *(("lease", {"take_over": flag}) for flag in (None, 1, "yes", [])),
        ("describe", {"table": []}),
        ("describe", {"table": "secrets"}),
        ("describe", {}),
        *(("subscribe", {"from": tick}) for tick in (-1, 4, 1.0, True, "0", [], 10**30)),
    ],
)
def test_what_makes_no_sense_is_refused_and_changes_nothing(rig, client, do, arguments):
    client.tell("heartbeat")
    before = rig.fingerprint()
    refused("any", client.tell, do, **arguments)
    assert rig.fingerprint() == before
    assert not client.session.closing
    assert client.ask("status")["controller"] == "tester"


@pytest.mark.parametrize("do", [None, 7, ["status"], {}])
def test_a_command_whose_name_is_no_text_is_refused(rig, client, do):
    """A host of this release would not send it."""
    before = rig.fingerprint()
    error = reply(client.session.receive(wire.ASK, wire.dump({"id": 1, "do": do})))["error"]
    assert error["code"] == "unknown"
    assert rig.fingerprint() == before


@pytest.mark.parametrize("number", [nan, inf, -inf])
@pytest.mark.parametrize("do", ["set", "kick"])
def test_numbers_that_are_none_never_arrive(rig, client, do, number):
    """Neither as JSON that says NaN, nor as JSON that overflows."""
    arguments = (
        {"set": {"k": number}} if do == "set" else {"id": "1", "mode": "phase", "shift": number}
    )
    before = rig.fingerprint()
    for text in (
        json.dumps({"id": 9, "do": do, do: arguments}),
        f'{{"id":9,"do":"{do}","{do}":{{"id":"1","mode":"phase","shift":-1e999,"k":1e999}}}}',
    ):
        fresh = Client(rig.loop, client="tester").greet()
        sealed = wire.seal(fresh.talk._handshake.key, 1, text.encode())
        error = reply(fresh.session.receive(wire.COMMAND, sealed))["error"]
        assert error["code"] in ("broken", "range", "unknown", "usage")
        assert rig.fingerprint() == before


def test_a_kick_while_one_acts_is_refused(rig, client):
    client.tell("kick", kick={"id": "1", "mode": "position"})
    before = rig.fingerprint()
    refused("busy", client.tell, "kick", kick={"id": "2", "mode": "position"})
    assert client.tell("kick", kick={"id": "1", "mode": "position"}) == {"tick": 3}
    assert rig.fingerprint() == before


@pytest.mark.parametrize(
    "identity", [None, "1", 1.0, True, [], pytest.param(10**3900, id="huge"), -1, 2**70]
)
def test_a_request_without_a_number_is_not_carried_out(rig, client, identity):
    """Nobody would know which request it answers."""
    client.tell("heartbeat")
    before = rig.fingerprint()
    body = wire.dump({"id": identity, "do": "set", "set": {"k": 1.0}})
    sealed = wire.seal(client.talk._handshake.key, 99, body)
    answer = reply(client.session.receive(wire.COMMAND, sealed))
    assert answer["error"]["code"] == "broken"
    assert answer["id"] is None
    assert rig.fingerprint() == before


def test_the_tables_fit_into_a_frame_and_name_everything(rig, client):
    tables = {
        name: client.ask("describe", table=name)["table"]
        for name in ("params", "channels", "commands")
    }
    assert (
        [row["name"] for row in tables["params"]]
        == list(client.ask("status")["params"])
        == list(TABLE)
    )
    assert {row["name"] for row in tables["commands"] if not row["sealed"]} == set(OPEN)


def test_a_status_with_the_longest_names_fits_into_a_frame(rig):
    longest = Client(rig.loop, name="\U0001f9be" * 40, client="\U0001f9be" * 64).greet()
    longest.tell("lease")
    longest.tell("stop")
    assert longest.ask("status")["controller"] == "\U0001f9be" * 40


def test_a_status_fits_into_a_frame_whatever_a_motor_says(rig, client):
    """As the driver of somebody's own motors, which shows all that a bus has answered."""
    client.ask("subscribe")
    rig.loop.fail("\U0001f9be" * 5000)
    rig.run(1)
    client.flow()
    status = client.ask("status")
    assert status["state"] == "fault"
    assert set(status["reason"]) == {"\U0001f9be"}


@pytest.mark.parametrize(
    "number", ["1," + "0" * 4000, "1," + "\u0660" * 600], ids=["long", "in Arabic digits"]
)
def test_a_long_number_with_a_comma_is_refused_in_a_frame(client, number):
    with pytest.raises(WrongUse, match="k cannot be '1,"):
        client.tell("set", set={"k": number})


@pytest.mark.parametrize(
    "text",
    ["\U0001f9be" * 300, "\x7f" * 4000, "\u20ac" * 600, "\ud800" * 600, "'\\" * 900],
    ids=ascii,
)
@pytest.mark.parametrize(
    "request_",
    [
        {"do": "{}"},
        {"do": "status", "{}": 1},
        {"do": "describe", "table": "{}"},
        {"do": "subscribe", "from": "{}"},
    ],
)
def test_a_refusal_of_something_long_fits_into_a_frame(rig, client, text, request_):
    message = {
        name.replace("{}", text): value.replace("{}", text) if isinstance(value, str) else value
        for name, value in request_.items()
    }
    error = reply(client.session.receive(wire.ASK, json.dumps(dict(message, id=1)).encode()))[
        "error"
    ]
    assert len(error["message"]) <= 200
