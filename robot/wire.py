"""Frames and messages as bytes, without any I/O: what PROTOCOL.md says, for both ends of a link."""

import json
import struct
import zlib
from functools import lru_cache

from robot.bare import compare_digest, sha256

PROTOCOL = (1, 3)
# Where robots listen: KICK on a telephone's keys.
PORT = 5425
# The speed of a serial line to one, in baud.
BAUD = 115200

SYNC = b"\xa5K"
_HEADER = struct.Struct(">2sBH")
_CHECK = struct.Struct(">I")
_SAMPLES = struct.Struct(">I")
_SEAL = struct.Struct(">Q16s")
_LENGTH = struct.Struct(">I")
_SEALED = struct.Struct(">IQI")
_COUNTER_BYTES = 8
MAX_PAYLOAD = 4096
MAX_SAMPLES = MAX_PAYLOAD - _SAMPLES.size
_HEADER_BYTES = _HEADER.size
OVERHEAD = _HEADER_BYTES + _CHECK.size
# Noise can look like the beginning of a frame. Each time costs a checksum, and a peer may make
# noise on purpose, so the number of tries has a bound.
MAX_FALSE_STARTS = 16
_TRIES = range(MAX_FALSE_STARTS)

# Frame types. A number is never given to another type.
HELLO, AUTH, ASK, COMMAND, REPLY, EVENT, SAMPLES, STOP, BEAT = range(1, 10)
TYPES = (HELLO, AUTH, ASK, COMMAND, REPLY, EVENT, SAMPLES, STOP, BEAT)
# What a stop that had no turn begins with, and how many such beginnings are tried at a link's end,
# within one tick.
_STOP_MARK = SYNC + bytes([STOP])
_STOP_TRIES = range(4)

NONCE_BYTES = 16
TOKEN_BYTES = 32
# The robot's token, and the keys of the sessions that seal commands.
KEYS_KEPT = 8
# What HMAC makes of a key, see RFC 2104.
_BLOCK_BYTES = 64
_INNER = bytes(byte ^ 0x36 for byte in range(256))
_OUTER = bytes(byte ^ 0x5C for byte in range(256))


def _no_constant(name):
    raise ValueError("{} is not a number in JSON".format(name))


# JSONEncoder.encode makes this function for each message, which takes a brick 0.6 ms. Its
# arguments: no search for circles, what refuses an unknown type, what writes text, no indent, both
# separators, and neither sorted keys, nor skipped ones, nor NaN.
_TO_JSON = json.encoder.c_make_encoder(  # type: ignore[attr-defined]
    None,
    json.JSONEncoder().default,
    json.encoder.encode_basestring_ascii,
    None,
    ":",
    ",",
    False,
    False,
    False,
)
# Not `decode`, which looks for spaces around the text with regular expressions.
_FROM_JSON = json.JSONDecoder(parse_constant=_no_constant).raw_decode
_JSON_SPACES = " \t\n\r"


class BadMessage(Exception):
    """A frame arrived whole, but what it carries is not what its type says."""


def encode(kind, payload):
    """Make a frame.

    Args:
        kind: The frame's type.
        payload: What it carries, bytes.

    Returns:
        The frame, bytes.

    Raises:
        ValueError: The payload is too long for a frame.
    """
    length = len(payload)
    if length > MAX_PAYLOAD:
        raise ValueError(
            "a payload of {} bytes does not fit into a frame of {}".format(length, MAX_PAYLOAD)
        )
    header = _HEADER.pack(SYNC, kind, length)
    check = zlib.crc32(payload, zlib.crc32(header))
    return b"".join((header, payload, _CHECK.pack(check)))


def encode_json(kind, message):
    """Make a frame that carries JSON.

    Args:
        kind: The frame's type.
        message: A dictionary.

    Returns:
        The frame, bytes.

    Raises:
        ValueError: The message is too long, or holds NaN or an infinity.
    """
    return encode(kind, dump(message))


def dump(message):
    """Write compact JSON.

    Args:
        message: A dictionary or list.

    Returns:
        Bytes.

    Raises:
        ValueError: It holds NaN or an infinity, which JSON has no words for.
    """
    return "".join(_TO_JSON(message, 0)).encode("ascii")


def join(first, second):
    """Make one JSON object of two.

    Args:
        first: A JSON object with at least one field, bytes.
        second: Another one, with other fields.

    Returns:
        An object with all fields, bytes.
    """
    return first[:-1] + b"," + second[1:]


def encode_samples(number, records):
    """Make a frame of records.

    Args:
        number: The number of the first event behind these records.
        records: Whole packed records, at most MAX_SAMPLES bytes.

    Returns:
        The frame, bytes.
    """
    return encode(SAMPLES, _SAMPLES.pack(number) + records)


def open_samples(payload):
    """Take a frame of records apart.

    Args:
        payload: What the frame carries, bytes.

    Returns:
        (number of the first event behind the records, packed records).

    Raises:
        BadMessage: It is too short.
    """
    if len(payload) < _SAMPLES.size:
        raise BadMessage("too short for samples")
    return _SAMPLES.unpack_from(payload)[0], payload[_SAMPLES.size :]


def load(payload):
    """Read JSON.

    Args:
        payload: Bytes.

    Returns:
        The dictionary that they hold.

    Raises:
        BadMessage: They hold anything else.
    """
    try:
        text = payload.decode("utf-8").strip(_JSON_SPACES)
        message, end = _FROM_JSON(text)
    except (ValueError, RecursionError) as error:
        raise BadMessage("not JSON: {}".format(error)) from error
    if end != len(text):
        raise BadMessage("not JSON: there is more behind its end")
    if not isinstance(message, dict):
        raise BadMessage("not a JSON object but a {}".format(type(message).__name__))
    return message


class Decoder(object):
    """Bytes in, frames out, one at a time. It never raises, no matter what arrives.

    Attributes:
        discarded: How many bytes belonged to no sound frame.
    """

    def __init__(self):
        self._buffer = bytearray()
        self.discarded = 0

    def feed(self, data):
        """Take in bytes.

        Args:
            data: Bytes as they came, in pieces of any size.
        """
        self._buffer += data

    def skip(self):
        """Take what looks like the beginning of a frame for noise, and look behind it."""
        self._discard(min(1, len(self._buffer)))

    def next(self):
        """The next frame. Bytes that belong to no sound frame are skipped and counted.

        Returns:
            (type, payload), or None until more is fed.
        """
        buffer = self._buffer
        if not buffer:
            return None  # as after nearly each frame
        for _ in _TRIES:
            if not buffer.startswith(SYNC):
                self._discard_to_sync()
            if len(buffer) < _HEADER_BYTES:
                return None
            _, kind, length = _HEADER.unpack_from(buffer)
            if kind in TYPES and length <= MAX_PAYLOAD:
                end = length + _HEADER_BYTES
                if len(buffer) < length + OVERHEAD:
                    return None
                body = bytes(buffer[:end])
                if _CHECK.unpack_from(buffer, end)[0] == zlib.crc32(body):
                    del buffer[: length + OVERHEAD]
                    return kind, body[_HEADER_BYTES:]
            self._discard(1)
        self._discard(len(buffer))
        return None

    def find_stop(self):
        """Find a whole stop among all that is left, which stays as it is.

        No JSON holds the bytes with which a stop begins. So it is found without decoding all that
        comes before it, which could take the brick longer than its watchdog bears.

        Returns:
            What the stop carries, bytes; None if there is none.
        """
        data = bytes(self._buffer)
        at = data.find(_STOP_MARK)
        for _ in _STOP_TRIES:
            if at < 0:
                break
            begin = at + _HEADER_BYTES
            length = int.from_bytes(data[at + len(_STOP_MARK) : begin], "big")
            payload = data[begin : begin + min(length, MAX_PAYLOAD)]
            if data.startswith(encode(STOP, payload), at):
                return payload
            at = data.find(_STOP_MARK, at + 1)
        return None

    def _discard_to_sync(self):
        found = self._buffer.find(SYNC)
        if found < 0:
            # The last byte may be the first half of a sync mark.
            found = len(self._buffer) - int(self._buffer.endswith(SYNC[:1]))
        self._discard(found)

    def _discard(self, count):
        del self._buffer[:count]
        self.discarded += count


def digest(key, *parts):
    """HMAC-SHA256 of parts, each behind its length, so that no two lists of parts look alike.

    Args:
        key: Bytes, at most 64 of them.
        parts: Bytes, any number of them.

    Returns:
        32 bytes.
    """
    return _hmac(key, _parts(*parts))


def _parts(*parts):
    return b"".join([_LENGTH.pack(len(part)) + part for part in parts])


def _hmac(key, message):
    """HMAC-SHA256. Not by the module `hmac`, which takes in the key anew for each message."""
    inner, outer = _keyed(key)
    inner, outer = inner.copy(), outer.copy()
    inner.update(message)
    outer.update(inner.digest())
    return outer.digest()


@lru_cache(maxsize=KEYS_KEPT)
def _keyed(key):
    """Both hashes of an HMAC, inner and outer, that have taken in the key."""
    block = key.ljust(_BLOCK_BYTES, b"\0")
    return sha256(block.translate(_INNER)), sha256(block.translate(_OUTER))


# `digest` takes these in before the nonces.
_HOST, _ROBOT, _SESSION = _parts(b"host"), _parts(b"robot"), _parts(b"session")


class Handshake(object):
    """What both ends compute from the token and the two nonces.

    Args:
        token: 32 bytes.
        host_nonce: 16 random bytes of the host.
        robot_nonce: 16 random bytes of the robot.

    Attributes:
        host_proof: Shows that the host has the token.
        robot_proof: Shows that the robot has it.
        key: Seals the commands of this session.
    """

    def __init__(self, token, host_nonce, robot_nonce):
        nonces = _parts(host_nonce, robot_nonce)
        self.host_proof = _hmac(token, _HOST + nonces)
        self.robot_proof = _hmac(token, _ROBOT + nonces)
        self.key = _hmac(token, _SESSION + nonces)


def same(one, other):
    """Whether two secrets are equal, in a time that does not depend on where they differ.

    Args:
        one: Bytes.
        other: Bytes.

    Returns:
        True if they are equal.
    """
    return compare_digest(one, other)


def seal(key, counter, payload):
    """Seal a command, or a beat.

    Args:
        key: The session's key.
        counter: A number above that of what was sealed before.
        payload: The command's JSON, bytes; empty for a beat.

    Returns:
        The payload behind its counter and its MAC, bytes.
    """
    return _SEAL.pack(counter, _mac(key, counter, payload)) + payload


def unseal(key, counter, payload):
    """Open a sealed command, or a beat.

    Args:
        key: The session's key.
        counter: The counter of what was opened before.
        payload: What `seal` has made, bytes.

    Returns:
        (counter, the command's JSON).

    Raises:
        BadMessage: The MAC is wrong, or the counter has not risen.
    """
    if len(payload) < _SEAL.size:
        raise BadMessage("too short to be sealed")
    number, mac = _SEAL.unpack_from(payload)
    body = payload[_SEAL.size :]
    if not compare_digest(mac, _mac(key, number, body)):
        raise BadMessage("the MAC is wrong")
    if number <= counter:
        raise BadMessage("the counter {} was used before".format(number))
    return number, body


def _mac(key, counter, payload):
    """The first half of `digest` of the counter and the payload."""
    return _hmac(key, _SEALED.pack(_COUNTER_BYTES, counter, len(payload)) + payload)[:16]
