"""The simulated kernel's files, new for each test."""

import pytest


@pytest.fixture
def files():
    """Imported here, for test_panels.py runs on the brick's Python too, which has no simulation."""
    from tests.sysfs.files import Files

    return Files()
