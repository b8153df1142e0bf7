"""The record of a tick: the table of channels, and the packed form on the wire.

The black box keeps records in the same form.
"""

import struct
from collections import OrderedDict, namedtuple

from robot.kicks import MODES, WHEELS

STATES = ("idle", "running", "held", "stopped", "fault")
# The values of the `kick` channel: 0 for no kick, or 1 + the index of the mode that acts.
KICK_NAMES = ("",) + MODES

Channel = namedtuple("Channel", "name code unit doc")

_TICK = (
    Channel("tick", "I", "1", "number of the tick, without gaps since the robot's program started"),
    Channel("t_s", "d", "s", "the robot's clock when the tick began, since its program started"),
    Channel(
        "dt_s", "d", "s", "delta t of the Euler step: measured since the tick before, within bounds"
    ),
    Channel("late_s", "f", "s", "how long after its deadline the tick began"),
    Channel("missed", "H", "1", "control periods without a tick since the tick before"),
    Channel(
        "state",
        "B",
        "1",
        "state of the robot: "
        + ", ".join("{} {}".format(i, name) for i, name in enumerate(STATES)),
    ),
    Channel(
        "kick",
        "B",
        "1",
        "the kick that acts: "
        + ", ".join("{} {}".format(i, name or "none") for i, name in enumerate(KICK_NAMES)),
    ),
)
_WHEEL = (
    Channel("phi_rad", "d", "rad", "wheel angle read in this tick, forward positive"),
    Channel("x1", "d", "1", "membrane potential of the first neuron after the step"),
    Channel("x2", "d", "1", "membrane potential of the second neuron after the step"),
    Channel("force", "d", "1", "tangential force F_tan from the new potentials"),
    Channel("torque", "d", "1", "relative torque M = tanh(F_tan)"),
    Channel("duty_pct", "b", "%", "duty cycle written to the motor, forward positive"),
)

CHANNELS = _TICK + tuple(
    channel._replace(name=side + "_" + channel.name) for side in WHEELS for channel in _WHEEL
)
NAMES = tuple(channel.name for channel in CHANNELS)
STRUCT = struct.Struct("<" + "".join(channel.code for channel in CHANNELS))
Record = namedtuple("Record", NAMES)


def describe():
    """The channels as plain data, as the robot sends them.

    Returns:
        A list of OrderedDicts with the keys name, code (as in Python's struct), unit and doc.
    """
    return [OrderedDict(zip(Channel._fields, channel)) for channel in CHANNELS]


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
