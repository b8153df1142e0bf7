"""Robots and hosts for tests of links.

Python 3.5 reads this file too, so imports stand where they are needed.
"""

import pytest


@pytest.fixture
def desk():
    """A robot that listens on loopback, in virtual time."""
    from tests.link.desk import Desk

    desk = Desk(capacity=200)
    desk.loop.start()
    yield desk
    desk.close()


@pytest.fixture
def rig():
    """A robot that runs, in its third tick."""
    from tests.rig import Rig

    rig = Rig(capacity=100)
    rig.loop.start()
    rig.run(3)
    return rig


@pytest.fixture
def client(rig):
    """A host that controls the rig's robot."""
    from tests.talk import Client

    client = Client(rig.loop).greet()
    client.tell("lease")
    return client


@pytest.fixture
def link():
    """A link to a robot in virtual time that can be cut anywhere."""
    from tests.link.machines import RigLink

    return RigLink()


@pytest.fixture
def robot(link):
    """A host that is connected over that link."""
    from host.client.robot import Robot

    with Robot(link, link.token) as robot:
        yield robot
