"""The stream of a subscription, from the session that sends it to the host that follows it.

All of it, once, and in order.
"""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from host.client.conversation import Conversation
from host.client.subscription import Subscription
from host.errors import KickctlError, NoLink
from host.logs.log import Log
from robot import record, wire
from robot.blackbox import BlackBox
from tests.rig import TOKEN, Rig
from tests.talk import Client


def test_events_stand_before_the_record_they_concern(rig, client):
    client.ask("subscribe", **{"from": 0})
    rig.run(2)
    client.tell("kick", kick={"id": "1", "mode": "membrane"})
    client.tell("set", set={"k": 2.0})
    rig.run(2)
    client.flow()
    shape = [item["event"] if isinstance(item, dict) else item.tick for item in client.stream]
    assert shape == ["snapshot", "start", 0, 1, 2, 3, 4, "kick", "params", 5, 6]
    assert client.events[0]["params"]["k"] == 8.0


def test_a_subscription_from_now_begins_with_what_is_in_force(rig, client):
    client.tell("set", set={"k": 2.0})
    client.tell("kick", kick={"id": "1", "mode": "position"})
    rig.run(1)
    assert client.ask("subscribe") == {"tick": 4}
    client.flow()
    rig.run(1)
    client.flow()
    (snapshot,) = client.events
    assert (snapshot["params"]["k"], snapshot["kick"]["id"], snapshot["tick"]) == (2.0, "1", 4)
    assert [record.tick for record in client.records] == [4]


def test_who_reads_too_slowly_is_told_exactly_what_is_lost(rig, client):
    client.ask("subscribe", **{"from": 0})
    client.flow(3)
    assert [record.tick for record in client.records] == [0, 1, 2]
    client.tell("set", set={"k": 2.0})
    rig.run(250)
    client.flow()
    lost = [event for event in client.events if event["event"] == "lost"]
    assert [(event["from"], event["tick"]) for event in lost] == [(3, 153)]
    ticks = [record.tick for record in client.records]
    assert ticks == [0, 1, 2, *range(153, 253)]
    assert client.events[-1]["event"] == "snapshot"
    assert client.events[-1]["params"]["k"] == 2.0


def test_a_loss_that_was_not_told_yet_is_not_forgotten_when_more_is_lost(rig, client):
    """The peer reads nothing between two losses, and must learn of both."""
    client.ask("subscribe", **{"from": 0})
    rig.run(250)
    client.ask("subscribe", **{"from": 3})
    rig.run(250)
    client.flow()
    lost = [event for event in client.events if event["event"] == "lost"]
    assert [(event["from"], event["tick"]) for event in lost] == [(3, 403)]
    assert [record.tick for record in client.records] == list(range(403, 503))


def test_unsubscribed_is_silent(rig, client):
    client.ask("subscribe")
    client.ask("unsubscribe")
    rig.run(3)
    client.flow()
    assert client.stream == []


def test_a_new_hello_ends_the_subscription_and_the_trust(rig, client):
    client.ask("subscribe")
    client.talk.token = None
    client.greet()
    rig.run(2)
    client.flow()
    assert client.stream == []
    with pytest.raises(KickctlError, match="lease"):
        client.ask("lease")


# What comes from the robot

scraps = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=8),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3)
    ),
    max_leaves=6,
)
fields = st.sampled_from(
    (
        "id",
        "result",
        "error",
        "event",
        "tick",
        "number",
        "from",
        "params",
        "kick",
        "nonce",
        "host_nonce",
        "boot",
        "proof",
        "code",
    )
)
messages = st.dictionaries(
    fields, scraps | st.sampled_from(("snapshot", "lost", "params", "kick", "00" * 16)), max_size=6
).map(wire.dump)


@given(
    st.lists(
        st.tuples(st.sampled_from(wire.TYPES), st.binary(max_size=300) | messages), max_size=6
    ),
    st.booleans(),
)
def test_no_frame_of_a_strange_robot_raises_anything_but_words(frames, greeted):
    talk = Conversation(TOKEN, "n", "c")
    place = Subscription()
    talk.begin()
    talk.hello_frame()
    if greeted:
        link = Client(Rig().loop)
        link.talk = talk
        link.greet()
    for kind, payload in frames:
        try:
            for item in talk.feed(wire.encode(kind, payload)):
                place.take_event(item) if isinstance(item, dict) else place.take_samples(item)
            talk.answer(1)
        except KickctlError as error:
            assert error.message


def test_answers_to_who_used_the_line_before_are_not_taken_for_ones_own():
    """Over a serial line, what the robot still has to say to the one before comes first."""
    rig = Rig()
    before, after = Client(rig.loop).greet(), Conversation(TOKEN, "n", "c")
    after.begin()
    stale = before.session.receive(wire.ASK, wire.dump({"id": 1, "do": "status"}))
    hello = before.session.receive(*_frame(before.talk.hello_frame()))
    list(before.talk.feed(hello))
    stale += hello + before.session.receive(*_frame(before.talk.auth_frame()))
    hello = after.hello_frame()
    list(after.feed(stale))
    assert after.hello == {}
    list(after.feed(before.session.receive(*_frame(hello))))
    assert after.hello
    number, _ = after.request("status", {}, sealed=False)
    assert number == 1
    assert after.answer(number) is None
    list(after.feed(before.session.receive(*_frame(after.auth_frame()))))
    assert after.trusted


def _frame(data):
    decoder = wire.Decoder()
    decoder.feed(data)
    return decoder.next()


@settings(max_examples=60)
@given(st.data())
def test_a_line_that_loses_frames_costs_time_and_nothing_else(data):
    """Any frame may get lost: the client notices, asks again, and all passes once and in order."""
    rig = Rig()
    rig.loop.blackbox = BlackBox(rig.loop.params.values(), 40)
    rig.loop.start()
    client = Client(rig.loop, token=None).greet()
    place, log = Subscription(), Log()

    def arrive(frame):
        for item in client.talk.feed(frame):
            if isinstance(item, dict):
                event = place.take_event(item)
                if event is not None:
                    log.take_event(event)
            else:
                log.take_records(place.take_samples(item))

    place.begin(client.ask("subscribe")["tick"])
    ticks_of_events = [0]
    pauses = st.integers(0, 3) | st.just(60) if data.draw(st.booleans()) else st.integers(0, 3)
    for number in range(data.draw(st.integers(5, 40))):
        changes = data.draw(st.integers(0, 3))
        ticks_of_events += [rig.loop.set_params({"k": float(number % 90)}) for _ in range(changes)]
        rig.run(data.draw(pauses))
        while (frame := client.session.stream()) is not None:
            if data.draw(st.integers(0, 3)):
                arrive(frame)
        if not place.following and data.draw(st.booleans()):
            client.session.subscribe(place.next_tick)
    for _ in range(2):
        rig.run(1)
        client.session.subscribe(place.next_tick)
        while (frame := client.session.stream()) is not None:
            arrive(frame)
    missing = [(event["from"], event["tick"]) for event in log.events if event["event"] == "lost"]
    gone = {tick for first, end in missing for tick in range(first, end)}
    ticks = [record.tick for record in log.records]
    assert sorted({*ticks, *gone}) == list(range(rig.loop.blackbox.next_tick))
    assert len(ticks) + len(gone) == rig.loop.blackbox.next_tick
    numbers = [
        event["number"] for event in log.events if event["event"] not in ("snapshot", "lost")
    ]
    assert numbers == sorted(set(numbers))
    assert {number for number, tick in enumerate(ticks_of_events) if tick not in gone} <= set(
        numbers
    )


@pytest.mark.parametrize("number", [float("nan"), float("inf")])
def test_a_record_whose_numbers_are_not_finite_is_none(number):
    fields = dict.fromkeys(record.NAMES, 0) | {"tick": 7, "left_x1": number}
    frame = wire.encode_samples(1, record.STRUCT.pack(*fields.values()))
    with pytest.raises(NoLink, match="not finite in tick 7"):
        Conversation(TOKEN, "n", "c").feed(frame)
