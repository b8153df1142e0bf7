"""A brick that was never deployed to, and a checkout to deploy from."""

import pytest

from tests.deploy.brick import Brick, Checkout, write


@pytest.fixture
def brick(tmp_path):
    """A brick without motors, whose battery is full.

    The robot's program starts, says which cable is out, and can be talked to.
    """
    brick = Brick(tmp_path)
    battery = brick.sysfs / "power_supply" / "lego-ev3-battery"
    write(battery / "voltage_now", "7900000\n")
    write(battery / "technology", "Li-ion\n")
    brick.boot()
    yield brick
    brick.shut_down()


@pytest.fixture
def checkout(tmp_path, brick):
    return Checkout(tmp_path, brick)


@pytest.fixture
def deployed(brick, checkout):
    """A brick with a release that runs, and a checkout with another."""
    status, output = checkout.deploy()
    assert status == 0, output
    checkout.change()
    return brick
