"""The record of a tick: the table of channels, and the packed form on the wire.

The black box keeps records in the same form.
"""

import struct
from collections import OrderedDict, namedtuple
from types import SimpleNamespace

from robot.kicks import MODES, WHEELS

STATES = ("idle", "running", "held", "stopped", "fault")
# The values of the `kick` channel: 0 for no kick, or 1 + the index of the mode that acts.
KICK_NAMES = ("",) + MODES


def channel(name, code, unit, doc):
    """A value of each record.

    Args:
        name: Its name.
        code: Its type, as in Python's struct.
        unit: Its unit.
        doc: What it is.

    Returns:
        All that as attributes.
    """
    # Not a namedtuple, see robot/params.py.
    return SimpleNamespace(name=name, code=code, unit=unit, doc=doc)


def of_each_wheel(rows, mark="_"):
    """Values that each wheel has.

    Args:
        rows: Channels of one wheel.
        mark: What stands between the wheel's name and that of the channel.

    Returns:
        A tuple of the left wheel's channels and the right one's.
    """
    return tuple(
        channel(side + mark + row.name, row.code, row.unit, row.doc)
        for side in WHEELS
        for row in rows
    )


_TICK = (
    channel("tick", "I", "1", "number of the tick, without gaps since the robot's program started"),
    channel("t_s", "d", "s", "the robot's clock when the tick began, since its program started"),
    channel(
        "dt_s", "d", "s", "delta t of the Euler step: measured since the tick before, within bounds"
    ),
    channel("late_s", "f", "s", "how long after its deadline the tick began"),
    channel("missed", "H", "1", "control periods without a tick since the tick before"),
    channel(
        "state",
        "B",
        "1",
        "state of the robot: "
        + ", ".join("{} {}".format(i, name) for i, name in enumerate(STATES)),
    ),
    channel(
        "kick",
        "B",
        "1",
        "the kick that acts: "
        + ", ".join("{} {}".format(i, name or "none") for i, name in enumerate(KICK_NAMES)),
    ),
)
_WHEEL = (
    channel("phi_rad", "d", "rad", "wheel angle read in this tick, forward positive"),
    channel("x1", "d", "1", "membrane potential of the first neuron after the step"),
    channel("x2", "d", "1", "membrane potential of the second neuron after the step"),
    channel("force", "d", "1", "tangential force F_tan from the new potentials"),
    channel("torque", "d", "1", "relative torque M = tanh(F_tan)"),
    channel("duty_pct", "b", "%", "duty cycle written to the motor, forward positive"),
)

CHANNELS = _TICK + of_each_wheel(_WHEEL)
NAMES = tuple(row.name for row in CHANNELS)
STRUCT = struct.Struct("<" + "".join(row.code for row in CHANNELS))
Record = namedtuple("Record", NAMES)


def describe(channels=CHANNELS):
    """Channels as plain data, as the robot sends them.

    Args:
        channels: Those of a record, or others.

    Returns:
        A list of OrderedDicts with the keys name, code (as in Python's struct), unit and doc.
    """
    keys = ("name", "code", "unit", "doc")
    return [OrderedDict((key, getattr(row, key)) for key in keys) for row in channels]


def unpack(data):
    """Unpack records.

    Args:
        data: Packed records, bytes.

    Returns:
        A list of Records, oldest first.

    Raises:
        struct.error: The data is not a whole number of records.
    """
    return [Record(*fields) for fields in STRUCT.iter_unpack(data)]
