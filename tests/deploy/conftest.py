"""A brick that was never deployed to, one that was, and a checkout to deploy from."""

import shutil

import pytest

from tests.deploy.brick import Checkout, charged, deployed_once


@pytest.fixture
def brick(tmp_path):
    """A brick without motors, whose battery is full.

    The robot's program starts, says which cable is out, and can be talked to.
    """
    brick = charged(tmp_path)
    brick.boot()
    yield brick
    brick.shut_down()


@pytest.fixture
def checkout(tmp_path, brick):
    return Checkout(tmp_path, brick)


@pytest.fixture(scope="session")
def card(tmp_path_factory):
    """A brick that was deployed to once, and is off; and the checkout of its release."""
    brick = charged(tmp_path_factory.mktemp("card"))
    with deployed_once(brick) as checkout:
        return brick, checkout


@pytest.fixture
def stocked(brick, card):
    """A brick that has the checkout's release, which a deploy need not send, but never ran it."""
    brick.take_releases(card[0])
    return brick


@pytest.fixture
def running(brick, checkout, card):
    """A brick on which the checkout's release runs, as after a first deploy of it."""
    brick.take_card(card[0])
    shutil.copy2(card[1].token, checkout.token)
    brick.start_program()
    return brick


@pytest.fixture
def deployed(running, checkout):
    """A brick with a release that runs, and a checkout with another."""
    checkout.change()
    return running
