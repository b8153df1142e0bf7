"""A page reads every record once, and hears how many it has missed."""

from hypothesis import given
from hypothesis import strategies as st

from host.lab.ring import Ring

CAPACITY = 8


def packed(number):
    return number.to_bytes(4, "little")


@given(st.lists(st.tuples(st.integers(0, 2 * CAPACITY), st.integers(1, 5)), max_size=40))
def test_every_record_comes_once_and_in_order_or_is_counted_as_missed(steps):
    ring, place, number, got = Ring(4, CAPACITY), 0, 0, []
    for appended, most in steps:
        for _ in range(appended):
            ring.append(packed(number))
            number += 1
        portion = ring.read(place, most)
        assert portion.records <= most
        got += [None] * portion.missed
        got += [portion.data[i : i + 4] for i in range(0, len(portion.data), 4)]
        assert len(portion.data) == 4 * portion.records
        place = portion.place
        assert place == len(got)
    assert all(record in (None, packed(i)) for i, record in enumerate(got))
    assert number - place <= CAPACITY or ring.read(place, 1).missed


def test_who_comes_late_begins_with_the_latest():
    ring = Ring(4, CAPACITY)
    assert ring.latest(5) == 0
    for number in range(20):
        ring.append(packed(number))
    assert ring.read(ring.latest(3), 10).data == b"".join(map(packed, (17, 18, 19)))
    assert ring.latest(100) == 20 - CAPACITY
