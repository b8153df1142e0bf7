"""A motor whose files are plain ones: they take everything and do nothing."""


def plain_motor(root, number=0, port="outB"):
    """Write the files of a large motor.

    Args:
        root: Where the classes of devices are.
        number: The motor's number for the kernel.
        port: The port that it is at.

    Returns:
        The motor's folder.
    """
    folder = root / "tacho-motor" / f"motor{number}"
    folder.mkdir(parents=True)
    values = {
        "address": "ev3-ports:" + port,
        "driver_name": "lego-ev3-l-motor",
        "count_per_rot": "360",
        "max_speed": "1050",
    }
    values |= dict.fromkeys(
        ("command", "stop_action", "polarity", "position", "duty_cycle", "duty_cycle_sp"), "0"
    )
    values |= dict.fromkeys(("ramp_up_sp", "ramp_down_sp"), "9")
    for name, value in values.items():
        (folder / name).write_text(value + "\n", encoding="ascii")
        (folder / name).chmod(0o664)
    return folder
