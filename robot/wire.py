"""Frames and messages as bytes, without any I/O: what PROTOCOL.md says, for both ends of a link."""

import hashlib
import hmac
import json
import struct
import zlib

PROTOCOL = (1, 1)

SYNC = b"\xa5K"
_HEADER = struct.Struct(">2sBH")
_CHECK = struct.Struct(">I")
_SAMPLES = struct.Struct(">I")
_SEAL = struct.Struct(">Q16s")
MAX_PAYLOAD = 4096
MAX_SAMPLES = MAX_PAYLOAD - _SAMPLES.size
OVERHEAD = _HEADER.size + _CHECK.size
# Noise can look like the beginning of a frame. A peer that makes it do so on purpose costs a
# checksum each time, hence the bound.
MAX_FALSE_STARTS = 16

# Frame types. Numbers are never used anew for something else.
HELLO, AUTH, ASK, COMMAND, REPLY, EVENT, SAMPLES, STOP = range(1, 9)
TYPES = (HELLO, AUTH, ASK, COMMAND, REPLY, EVENT, SAMPLES, STOP)

NONCE_BYTES = 16
TOKEN_BYTES = 32


class BadMessage(Exception):
    """A frame arrived whole, but what it carries is not what its type says."""


def encode(kind, payload):
    """The frame of type `kind` around `payload` bytes.

    Raises ValueError if the payload is too long for a frame.
    """
    if len(payload) > MAX_PAYLOAD:
        raise ValueError(
            "a payload of {} bytes does not fit into a frame of {}".format(
                len(payload), MAX_PAYLOAD
            )
        )
    frame = _HEADER.pack(SYNC, kind, len(payload)) + payload
    return frame + _CHECK.pack(zlib.crc32(frame) & 0xFFFFFFFF)


def encode_json(kind, message):
    """The frame of type `kind` around a dictionary."""
    return encode(kind, dump(message))


def dump(message):
    """A dictionary as compact JSON bytes.

    Raises ValueError for NaN and infinities, which JSON has no words for.
    """
    return json.dumps(message, allow_nan=False, separators=(",", ":")).encode("utf-8")


def encode_samples(number, records):
    """The frame of whole records (bytes, up to MAX_SAMPLES) that stand before the event of this number."""
    return encode(SAMPLES, _SAMPLES.pack(number) + records)


def open_samples(payload):
    """(number, records) of a frame of samples. Raises BadMessage."""
    if len(payload) < _SAMPLES.size:
        raise BadMessage("too short for samples")
    return _SAMPLES.unpack_from(payload)[0], payload[_SAMPLES.size :]


def _no_constant(name):
    raise ValueError("{} is not a number in JSON".format(name))


def load(payload):
    """The dictionary in JSON bytes. Raises BadMessage for anything else."""
    try:
        message = json.loads(payload.decode("utf-8"), parse_constant=_no_constant)
    except (ValueError, RecursionError) as error:
        raise BadMessage("not JSON: {}".format(error)) from error
    if not isinstance(message, dict):
        raise BadMessage("not a JSON object but a {}".format(type(message).__name__))
    return message


class Decoder(object):
    """Bytes in, frames out, one at a time. Whatever arrives, it never raises.

    It holds what was fed and not yet taken.
    """

    def __init__(self):
        self._buffer = bytearray()
        self.discarded = 0

    def feed(self, data):
        """Take in bytes as they came, in pieces of any size."""
        self._buffer += data

    def skip(self):
        """What seems to be the beginning of a frame is none: look for the next behind it."""
        self._discard(min(1, len(self._buffer)))

    def next(self):
        """The next whole frame as (type, payload), or None until more is fed.

        Bytes of no sound frame are skipped and counted.
        """
        for _ in range(MAX_FALSE_STARTS):
            self._discard_to_sync()
            if len(self._buffer) < _HEADER.size:
                return None
            _, kind, length = _HEADER.unpack_from(self._buffer)
            if kind in TYPES and length <= MAX_PAYLOAD:
                end = _HEADER.size + length
                if len(self._buffer) < end + _CHECK.size:
                    return None
                (check,) = _CHECK.unpack_from(self._buffer, end)
                body = bytes(self._buffer[:end])
                if check == zlib.crc32(body) & 0xFFFFFFFF:
                    del self._buffer[: end + _CHECK.size]
                    return kind, body[_HEADER.size :]
            self._discard(1)
        self._discard(len(self._buffer))
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
    """HMAC-SHA256 of the parts under a key.

    Each part is preceded by its length, so that no two lists of parts look alike.
    """
    code = hmac.new(key, digestmod=hashlib.sha256)
    for part in parts:
        code.update(struct.pack(">I", len(part)))
        code.update(part)
    return code.digest()


class Handshake(object):
    """What both ends derive from the token and the two nonces.

    The two proofs, and the key that seals a session's commands.
    """

    def __init__(self, token, host_nonce, robot_nonce):
        self.host_proof = digest(token, b"host", host_nonce, robot_nonce)
        self.robot_proof = digest(token, b"robot", host_nonce, robot_nonce)
        self.key = digest(token, b"session", host_nonce, robot_nonce)


def same(one, other):
    """Whether two secrets are equal, in a time that does not tell where they differ."""
    return hmac.compare_digest(one, other)


def seal(key, counter, payload):
    """A command's payload behind its counter and its MAC."""
    return _SEAL.pack(counter, _mac(key, counter, payload)) + payload


def unseal(key, counter, payload):
    """(counter, payload) of a sealed command.

    Raises BadMessage if the MAC is wrong or the counter is not above `counter`.
    """
    if len(payload) < _SEAL.size:
        raise BadMessage("too short to be sealed")
    number, mac = _SEAL.unpack_from(payload)
    body = payload[_SEAL.size :]
    if not same(mac, _mac(key, number, body)):
        raise BadMessage("the MAC is wrong")
    if number <= counter:
        raise BadMessage("the counter {} was used before".format(number))
    return number, body


def _mac(key, counter, payload):
    return digest(key, struct.pack(">Q", counter), payload)[:16]
