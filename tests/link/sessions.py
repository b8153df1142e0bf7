"""How tests look at a robot's answers."""

import pytest

from host.errors import KickctlError, NotDone, RefusedByRobot
from robot import wire
from tests.rig import whole


def reply(frames):
    """The one message in the frames of an answer."""
    ((kind, payload),) = whole(frames)
    assert kind == wire.REPLY
    return wire.load(payload)


def refused(code, call, *args, **kwargs):
    """Assert that the robot refuses for a reason of this kind. Returns the error."""
    kinds = {"token": RefusedByRobot, "lease": RefusedByRobot, "busy": NotDone, "any": KickctlError}
    with pytest.raises(kinds[code], match=r"the robot refuses: .{5}") as error:
        call(*args, **kwargs)
    return error.value
