"""What stays the same about this machine, so that a robot is found again under a new address."""

import os

from robot.bare import sha256

# Where machines say their own number, the best first: a copied card brings the system's identity to
# another machine, and a serial number stays where it is.
_BRICK = "/sys/class/board-info"  # ev3dev: of an EV3, or of a BrickPi
_BOARD = "/sys/firmware/devicetree/base/serial-number"  # of a Raspberry Pi and others
_SYSTEM = "/etc/machine-id"
_PURPOSE = b"kickctl hardware id\0"


def hardware_id():
    """The machine's lasting id.

    It is a hash, since anybody in the network may ask a robot for it: nobody learns the machine's
    own number, which other programs may keep to themselves.

    Returns:
        32 hexadecimal digits; empty if the machine has no number.
    """
    for number in (_of_brick(), _read(_BOARD), _read(_SYSTEM)):
        # Zeros are a number that nobody has given, and systemd first writes this word.
        if number.strip("0") and number != "uninitialized":
            return sha256(_PURPOSE + number.encode("utf-8")).hexdigest()[:32]
    return ""


def _of_brick():
    """The first serial number among what the kernel says of its boards."""
    try:
        boards = sorted(os.listdir(_BRICK))
    except OSError:
        return ""
    for board in boards:
        for line in _read(os.path.join(_BRICK, board, "uevent")).splitlines():
            name, _, number = line.partition("=")
            if name == "BOARD_INFO_SERIAL_NUM":
                return number
    return ""


def _read(path):
    """The text of a short file; empty if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read(4096).decode("utf-8", "replace").strip("\0 \n")
    except OSError:
        return ""
