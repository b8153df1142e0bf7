"""A brick whose files are plain ones: they take everything and do nothing."""

import os


def plain_motor(root, number=0, port="outB"):
    """Write the files of a large motor.

    Args:
        root: Where the classes of devices are.
        number: The motor's number for the kernel.
        port: The port that it is at.

    Returns:
        The motor's folder.
    """
    values = {
        "address": "ev3-ports:" + port,
        "driver_name": "lego-ev3-l-motor",
        "count_per_rot": "360",
        "max_speed": "1050",
        "ramp_up_sp": "9",
        "ramp_down_sp": "9",
    }
    for name in ("command", "stop_action", "polarity", "position", "duty_cycle", "duty_cycle_sp"):
        values[name] = "0"
    return _write(root / "tacho-motor" / "motor{}".format(number), values)  # noqa: UP032


def plain_battery(root, volts=7.5):
    """Write the files of a lithium pack.

    Args:
        root: Where the classes of devices are.
        volts: Its voltage.
    """
    values = {"technology": "Li-ion", "voltage_now": str(int(volts * 1e6))}
    _write(root / "power_supply" / "lego-ev3-battery", values)


def plain_lights(root):
    """Write the files of the brick's four half lights.

    Args:
        root: Where the classes of devices are.
    """
    for side in (0, 1):
        for colour in ("red", "green"):
            name = "led{}:{}:brick-status".format(side, colour)  # noqa: UP032
            _write(root / "leds" / name, {"brightness": "0"})


def _write(folder, values):
    os.makedirs(str(folder), exist_ok=True)  # noqa: PTH103
    for name in sorted(values):
        (folder / name).write_text(values[name] + "\n", encoding="ascii")
        (folder / name).chmod(0o664)  # python-ev3dev2 opens as the group's permissions say
    return folder
