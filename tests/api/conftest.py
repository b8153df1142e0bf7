"""What a run draws is no subject in here: what it returns is."""

import pytest

from tests.small_figures import small_figures


@pytest.fixture(scope="module", autouse=True)
def figures():
    with small_figures():
        yield
