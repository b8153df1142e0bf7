"""The black box against a naive one that forgets nothing."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from robot import blackbox
from robot.blackbox import BlackBox, Snapshot
from robot.record import CHANNELS, STRUCT, unpack

CAPACITY = 7
JOURNAL = 5
COPY = 2
PARAMS = {"k": 8.0, "a": 4.0, "link_loss": "stop"}


def fields(number):
    """A record's fields after its tick, told apart by the number."""
    return [number % 100 if channel.code in "bB" else number % 60000 for channel in CHANNELS[1:]]


def state_before(journal, tick):
    """(params, kick) in force before a tick's own events, from all events that there were."""
    params, kick = dict(PARAMS), None
    for event in journal:
        if event["tick"] >= tick:
            break
        if event["event"] == "params":
            params.update(event["set"])
        elif event["event"] == "kick":
            kick = event["kick"]
        elif event["event"] in ("start", "stop", "hold", "fault"):
            kick = None
    if kick is not None and kick["begin"] + kick["ticks"] <= tick:
        kick = None
    return params, kick


class BlackBoxMachine(RuleBasedStateMachine):
    """Ticks and events in any order.

    The box may forget, but what it says must have happened.
    """

    def __init__(self):
        super().__init__()
        self.before = blackbox.JOURNAL_CAPACITY, blackbox.EVENTS_PER_COPY
        blackbox.JOURNAL_CAPACITY, blackbox.EVENTS_PER_COPY = JOURNAL, COPY
        self.box = BlackBox(PARAMS, CAPACITY)
        self.ticks = 0
        self.journal = []

    def teardown(self):
        blackbox.JOURNAL_CAPACITY, blackbox.EVENTS_PER_COPY = self.before

    @rule(count=st.integers(1, 2 * CAPACITY))
    def tick(self, count):
        for _ in range(count):
            self.box.append(fields(self.ticks))
            self.ticks += 1

    def _note(self, event, **details):
        assert self.box.note(event, **details) == self.ticks
        self.journal.append(dict(details, event=event, tick=self.ticks, number=len(self.journal)))

    @rule(name=st.sampled_from(sorted(PARAMS)), value=st.integers(0, 9), times=st.integers(1, 2))
    def change(self, name, value, times):
        for _ in range(times):
            self._note("params", set={name: value})

    @rule(ticks=st.integers(1, 2 * CAPACITY))
    def kick(self, ticks):
        self._note("kick", kick={"begin": self.ticks, "ticks": ticks})

    @rule(name=st.sampled_from(("start", "stop", "hold", "resume", "fault", "clear", "link_loss")))
    def other(self, name):
        self._note(name, reason="so")

    @invariant()
    def memory_is_bounded(self):
        assert len(self.box._journal) <= JOURNAL
        assert len(self.box._copies) <= JOURNAL // COPY + 1
        assert len(self.box._ring) == CAPACITY * STRUCT.size

    @invariant()
    def the_oldest_tick_is_no_older_than_the_ring_and_no_younger_than_the_journal_makes_it(self):
        floor = max(0, self.ticks - CAPACITY)
        dropped = self.journal[: max(0, len(self.journal) - JOURNAL)]
        assert (
            floor <= self.box.oldest_tick <= max([floor, *(event["tick"] + 1 for event in dropped)])
        )

    @invariant()
    def what_can_be_read_is_what_was_written(self):
        read, tick = b"", max(0, self.box.oldest_tick)
        while tick < self.ticks:
            piece = self.box.read(tick, 3)
            assert len(piece) in (STRUCT.size, 2 * STRUCT.size, 3 * STRUCT.size)
            read += piece
            tick += len(piece) // STRUCT.size
        expected = [
            STRUCT.pack(number, *fields(number))
            for number in range(self.box.oldest_tick, self.ticks)
        ]
        assert read == b"".join(expected)
        assert self.box.read(self.ticks, 3) == b""

    @invariant()
    def a_snapshot_is_the_sum_of_all_that_happened_before(self):
        for tick in range(self.box.oldest_tick, self.ticks + 1):
            number, event = self.box.snapshot(tick)
            assert (event["params"], event["kick"]) == state_before(self.journal, tick)
            assert (event["event"], event["tick"]) == ("snapshot", tick)
            rest = []
            while self.box.event(number) is not None:
                rest.append(self.box.event(number))
                number += 1
            assert rest == [happened for happened in self.journal if happened["tick"] >= tick]

    @precondition(lambda self: self.journal)
    @invariant()
    def an_event_that_has_not_happened_is_none(self):
        assert self.box.event(len(self.journal)) is None
        assert self.box.event(-1) is None


TestBlackBox = BlackBoxMachine.TestCase


@given(st.integers(1, 9), st.integers(0, 40))
def test_the_ring_keeps_the_latest(capacity, ticks):
    box = BlackBox(PARAMS, capacity)
    for number in range(ticks):
        box.append(fields(number))
    assert box.oldest_tick == max(0, ticks - capacity)
    kept = b"".join(box.read(tick, 1) for tick in range(box.oldest_tick, ticks))
    assert [record.tick for record in unpack(kept)] == list(range(box.oldest_tick, ticks))


def test_a_snapshot_does_not_change_with_what_happens_after_it():
    box = BlackBox(PARAMS, 5)
    box.note("params", set={"k": 1.0})
    box.append(fields(0))
    _, snapshot = box.snapshot(1)
    box.note("params", set={"k": 2.0})
    box.append(fields(1))
    assert snapshot["params"]["k"] == 1.0
    snapshot["params"]["k"] = 99.0
    assert box.snapshot(1)[1]["params"]["k"] == 1.0


@pytest.mark.parametrize("events", [blackbox.JOURNAL_CAPACITY, blackbox.JOURNAL_CAPACITY + 1])
def test_a_flood_of_events_in_one_tick_is_bounded(events):
    box = BlackBox(PARAMS)
    box.append(fields(0))
    for number in range(events):
        box.note("params", set={"k": float(number)})
    box.append(fields(1))
    assert len(box._journal) == blackbox.JOURNAL_CAPACITY
    assert box.oldest_tick == (0 if events == blackbox.JOURNAL_CAPACITY else 2)
    assert box.snapshot(2)[1]["params"]["k"] == events - 1.0


@pytest.mark.parametrize("capacity", [blackbox.DEFAULT_CAPACITY, 600])
def test_a_snapshot_of_any_tick_replays_few_events(monkeypatch, capacity):
    """Anyone may subscribe; two thousand events would take longer than several ticks."""
    draw = random.Random(1)
    box = BlackBox(PARAMS, capacity)
    journal, replayed = [], []
    kinds = ("params", "params", "kick", "start", "stop", "battery")
    for tick in range(2000):
        for _ in range(draw.choice((0, 1, 1, 4))):
            kind = draw.choice(kinds)
            details = {
                "params": {"set": {draw.choice(sorted(PARAMS)): draw.random()}},
                "kick": {"kick": {"begin": tick, "ticks": draw.randrange(1, 50)}},
            }.get(kind, {})
            box.note(kind, **details)
            journal.append(dict(details, event=kind, tick=tick))
        box.append(fields(tick))
    assert len(journal) > blackbox.JOURNAL_CAPACITY
    real = Snapshot.take
    monkeypatch.setattr(Snapshot, "take", lambda *what: replayed.append(what) or real(*what))
    number, model = 0, Snapshot(PARAMS)
    for tick in range(2001):
        while number < len(journal) and journal[number]["tick"] < tick:
            real(model, journal[number])
            number += 1
        if tick >= box.oldest_tick:
            replayed.clear()
            assert box.snapshot(tick) == (number, model.as_event(tick))
            assert len(replayed) < blackbox.EVENTS_PER_COPY
