"""A tick's record: its packed form is whole, exact, and described by its own table."""

import json
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot.kicks import MODES
from robot.record import CHANNELS, KICK_NAMES, NAMES, STATES, STRUCT, Record, describe, unpack

RANGES = {"I": (0, 2**32 - 1), "H": (0, 65535), "B": (0, 255), "b": (-128, 127)}
FIELD = {
    "d": st.floats(),
    "f": st.floats(width=32),
    **{code: st.integers(*ends) for code, ends in RANGES.items()},
}
records = st.tuples(*[FIELD[channel.code] for channel in CHANNELS])


@given(st.lists(records, max_size=5))
def test_records_come_back_bit_for_bit(written):
    data = b"".join(STRUCT.pack(*record) for record in written)
    read = unpack(data)
    assert b"".join(STRUCT.pack(*record) for record in read) == data
    assert all(isinstance(record, Record) for record in read)


@pytest.mark.parametrize("length", [1, STRUCT.size - 1, STRUCT.size + 1])
def test_a_piece_of_a_record_is_no_record(length):
    with pytest.raises(struct.error):
        unpack(bytes(length))


def test_the_table_describes_the_bytes():
    rows = json.loads(json.dumps(describe()))
    assert struct.calcsize("<" + "".join(row["code"] for row in rows)) == STRUCT.size
    assert len(set(NAMES)) == len(NAMES)
    assert all(row["unit"] and row["doc"] for row in rows)


def test_what_a_log_needs_for_a_replay_is_kept_in_full():
    exact = {channel.name for channel in CHANNELS if channel.code == "d"}
    assert {"t_s", "dt_s"} <= exact
    assert {
        side + name
        for side in ("left_", "right_")
        for name in ("phi_rad", "x1", "x2", "force", "torque")
    } <= exact


def test_every_state_and_mode_has_its_number():
    assert len(KICK_NAMES) == len(MODES) + 1
    assert KICK_NAMES[0] == ""
    assert len(STATES) < 256
