"""A train that several tests look at."""

import pytest

from host.bodies.build import BodyRequest, build_body


@pytest.fixture(scope="session")
def train():
    """A train that ran between walls for 15 s; only to be read."""
    body = build_body(BodyRequest(cars=5, scene="walls", seed=3))
    body.run(15.0)
    return body
