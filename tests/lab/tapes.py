"""Tapes of logs, read as the page reads them."""

import base64
import gzip
import struct


def rows_of(tape):
    """The records of a tape as dictionaries."""
    channels = [*tape["robot"]["channels"], *tape["robot"]["derived"]]
    names = [channel["name"] for channel in channels]
    record = struct.Struct("<" + "".join(channel["code"] for channel in channels))
    packed = gzip.decompress(base64.b64decode(tape["records"]))
    return [dict(zip(names, values, strict=True)) for values in record.iter_unpack(packed)]
