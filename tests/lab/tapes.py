"""Tapes of logs, read as the page reads them."""

import base64
import gzip
import struct


def rows_of(tape):
    """The records of a tape as dictionaries."""
    return _rows([*tape["robot"]["channels"], *tape["robot"]["derived"]], tape["records"])


def twins_rows_of(tape):
    """The records of the twin in a tape as dictionaries."""
    twin = tape["twin"]
    return _rows([*tape["robot"]["channels"], *twin["derived"]], twin["records"])


def _rows(channels, records):
    names = [channel["name"] for channel in channels]
    record = struct.Struct("<" + "".join(channel["code"] for channel in channels))
    packed = gzip.decompress(base64.b64decode(records))
    return [dict(zip(names, values, strict=True)) for values in record.iter_unpack(packed)]
