"""Frames and messages against noise, damage and malice."""

import hashlib
import hmac
import json
import zlib

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from robot import wire

kinds = st.sampled_from(wire.TYPES)
payloads = (
    st.binary(max_size=200) | st.integers(0, wire.MAX_PAYLOAD).map(bytes) | st.just(wire.SYNC * 20)
)
frames = st.tuples(kinds, payloads)
# Bytes that look like the beginning of a frame, more often than chance would make them.
noise = st.lists(
    st.binary(max_size=30)
    | st.just(wire.SYNC)
    | st.just(wire.SYNC + b"\x08\x00")
    | st.just(b"\xa5"),
    max_size=30,
).map(b"".join)


def decode(chunks):
    """(frames, decoder) of bytes that arrive in pieces, taken as they come."""
    decoder = wire.Decoder()
    taken = []
    for chunk in chunks:
        decoder.feed(chunk)
        taken += iter(decoder.next, None)
    return taken, decoder


def cut(data, places):
    """The bytes in pieces that end at the places."""
    ends = [*sorted(place % (len(data) + 1) for place in places), len(data)]
    # zip(strict=) is of 3.10.
    return [data[begin:end] for begin, end in zip([0, *ends], ends)]  # noqa: B905


@given(st.lists(frames, max_size=6), st.lists(st.integers(0, 1 << 16), max_size=12))
def test_frames_come_back_however_the_bytes_are_cut(sent, places):
    data = b"".join(wire.encode(kind, payload) for kind, payload in sent)
    taken, decoder = decode(cut(data, places))
    assert taken == sent
    assert decoder.discarded == 0
    assert not decoder._buffer


def test_frames_come_back_byte_by_byte():
    sent = [(wire.ASK, b"{}"), (wire.STOP, b""), (wire.SAMPLES, bytes(range(256)) * 16)]
    data = b"".join(wire.encode(kind, payload) for kind, payload in sent)
    assert decode(bytes([byte]) for byte in data)[0] == sent


def test_what_does_not_fit_into_a_frame_is_refused():
    assert len(wire.encode(wire.ASK, bytes(wire.MAX_PAYLOAD))) == wire.MAX_PAYLOAD + wire.OVERHEAD
    with pytest.raises(ValueError, match="4097"):
        wire.encode(wire.ASK, bytes(wire.MAX_PAYLOAD + 1))


@given(
    st.lists(noise | frames.map(lambda frame: wire.encode(*frame)), max_size=8),
    st.lists(st.integers(0, 1 << 16), max_size=8),
)
def test_whatever_arrives_nothing_is_raised_and_memory_is_bounded(pieces, places):
    data = b"".join(pieces)
    taken, decoder = decode(cut(data, places))
    assert len(decoder._buffer) <= wire.MAX_PAYLOAD + wire.OVERHEAD
    assert decoder.discarded + len(decoder._buffer) + sum(
        len(payload) + wire.OVERHEAD for _, payload in taken
    ) == len(data)
    assert all(kind in wire.TYPES for kind, _ in taken)


@given(
    st.binary(max_size=3000).filter(
        lambda data: wire.SYNC not in data and not data.endswith(wire.SYNC[:1])
    ),
    frames,
)
def test_noise_in_front_of_a_frame_is_skipped(garbage, frame):
    taken, decoder = decode([garbage + wire.encode(*frame)])
    assert taken == [frame]
    assert decoder.discarded == len(garbage)


@pytest.mark.parametrize(
    "lead",
    [
        b"\xa5",
        b"\xa5\xa5",
        b"K",
        wire.SYNC,
        wire.SYNC + b"\x08",
        wire.SYNC + b"\x63\x00\x00",
        wire.SYNC * 5,
    ],
)
def test_half_a_frame_in_front_of_a_frame_is_skipped_as_soon_as_it_shows(lead):
    """What looks like a header may have to wait for as many bytes as it claims.

    The frames behind it are not lost.
    """
    stop = wire.encode(wire.STOP, b"")
    taken, _ = decode([lead + stop, *[stop] * 5000])
    assert len(taken) > 4000


@given(frames, st.data())
def test_a_flipped_bit_never_makes_another_frame(frame, data):
    whole = bytearray(wire.encode(*frame))
    place = data.draw(st.integers(0, 8 * len(whole) - 1))
    whole[place // 8] ^= 1 << place % 8
    taken, _ = decode([bytes(whole)])
    # What the payload holds may be a frame itself; it is not this one, changed.
    assume(wire.SYNC not in frame[1])
    assert taken == []


@given(st.binary(min_size=1, max_size=100), kinds)
def test_a_wrong_checksum_is_no_frame(payload, kind):
    whole = wire.encode(kind, payload)
    wrong = (zlib.crc32(whole[:-4]) + 1) & 0xFFFFFFFF
    assume(wire.SYNC not in payload)
    assert decode([whole[:-4] + wrong.to_bytes(4, "big")])[0] == []


@pytest.mark.parametrize(
    "header", [b"\x00\x00\x00", b"\x0a\x00\x00", b"\x01\x10\x01", b"\xff\xff\xff"]
)
def test_an_unknown_type_or_length_is_no_frame_whatever_its_checksum(header):
    body = wire.SYNC + header + bytes(int.from_bytes(header[1:], "big"))
    taken, decoder = decode([body + zlib.crc32(body).to_bytes(4, "big")])
    assert taken == []
    assert len(decoder._buffer) <= 1


def test_the_cost_of_false_starts_is_bounded(monkeypatch):
    """Sync marks all along would cost a checksum of 4096 bytes each."""
    sums = []
    monkeypatch.setattr(wire.zlib, "crc32", lambda data: sums.append(len(data)) or 0)
    decoder = wire.Decoder()
    decoder.feed((wire.SYNC + b"\x03\x0f\xff") * 3000)
    while len(decoder._buffer) > wire.MAX_PAYLOAD + wire.OVERHEAD:
        before = len(sums)
        decoder.next()
        assert len(sums) - before <= wire.MAX_FALSE_STARTS


# Messages

json_values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=15,
)


@given(st.dictionaries(st.text(), json_values, max_size=5))
def test_messages_come_back(message):
    assert wire.load(wire.dump(message)) == message


@given(
    st.binary(max_size=300)
    | json_values.map(lambda value: json.dumps(value).encode())
    | st.sampled_from((b"[" * 4096, b'{"a":' * 800))
)
def test_any_payload_is_a_message_or_a_bad_one(payload):
    try:
        message = wire.load(payload)
    except wire.BadMessage:
        return
    assert isinstance(message, dict)


@pytest.mark.parametrize(
    "text",
    [
        '{"a": NaN}',
        '{"a": Infinity}',
        '{"a": -Infinity}',
        "[]",
        "1",
        '"a"',
        "null",
        "",
        "{",
        '{"a": 1}x',
        "\ufeff{}",
        "\xa0{}",
    ],
)
def test_what_is_no_json_object_is_a_bad_message(text):
    with pytest.raises(wire.BadMessage):
        wire.load(text.encode())


def test_json_may_have_spaces_around_it():
    assert wire.load(b' \t\r\n{"a": 1}\n ') == {"a": 1}


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_no_message_carries_what_json_has_no_words_for(value):
    with pytest.raises(ValueError, match="JSON"):
        wire.dump({"a": [value]})


# Seals

KEY = b"k" * 32


@given(st.integers(1, 2**64 - 1), st.binary(max_size=200))
def test_a_sealed_command_opens_once(counter, body):
    sealed = wire.seal(KEY, counter, body)
    assert wire.unseal(KEY, counter - 1, sealed) == (counter, body)
    for used in (counter, 2**64 - 1):
        with pytest.raises(wire.BadMessage):
            wire.unseal(KEY, used, sealed)


@given(st.integers(1, 2**63), st.binary(max_size=60), st.data())
def test_any_changed_bit_breaks_the_seal(counter, body, data):
    sealed = bytearray(wire.seal(KEY, counter, body))
    place = data.draw(st.integers(0, 8 * len(sealed) - 1))
    sealed[place // 8] ^= 1 << place % 8
    with pytest.raises(wire.BadMessage):
        wire.unseal(KEY, 0, bytes(sealed))


@given(st.binary(max_size=60), st.integers(0, 30))
def test_a_shortened_or_longer_command_is_refused(body, length):
    sealed = wire.seal(KEY, 1, body)
    for changed in (sealed[:length] if length < len(sealed) else b"", sealed + b"\0", sealed[:-1]):
        with pytest.raises(wire.BadMessage):
            wire.unseal(KEY, 0, changed)


def test_another_key_does_not_open_it():
    with pytest.raises(wire.BadMessage):
        wire.unseal(b"j" * 32, 0, wire.seal(KEY, 1, b"{}"))


@given(st.lists(st.binary(max_size=5), max_size=4), st.lists(st.binary(max_size=5), max_size=4))
def test_no_two_lists_of_parts_have_one_digest(one, other):
    assert (wire.digest(KEY, *one) == wire.digest(KEY, *other)) == (one == other)


def test_both_ends_of_a_handshake_agree_and_nobody_else():
    derived = [
        wire.Handshake(token, host, robot)
        for token in (b"t" * 32, b"u" * 32)
        for host in (b"h", b"i")
        for robot in (b"r", b"s")
    ]
    for name in ("host_proof", "robot_proof", "key"):
        assert len({getattr(handshake, name) for handshake in derived}) == len(derived)
    one = derived[0]
    assert len({one.host_proof, one.robot_proof, one.key}) == 3
    assert vars(wire.Handshake(b"t" * 32, b"h", b"r")) == vars(one)


@pytest.mark.parametrize("key", [b"t" * wire.TOKEN_BYTES, b"", b"k" * 64])
def test_a_digest_is_the_hmac_of_its_parts_behind_their_lengths_also_the_second_time(key):
    expected = hmac.new(key, b"\0\0\0\2ab\0\0\0\0\0\0\0\1c", hashlib.sha256).digest()
    assert [wire.digest(key, b"ab", b"", b"c") for _ in range(2)] == [expected] * 2
