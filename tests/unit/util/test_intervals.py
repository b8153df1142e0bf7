"""Intervals of rates, against scipy's, bit for bit."""

import pytest
from scipy.stats import binomtest

from host.util.intervals import CONFIDENCE, wilson


@pytest.mark.parametrize("trials", [1, 2, 7, 50, 150, 1000, 12345])
def test_wilsons_interval_is_scipys(trials):
    for successes in sorted({0, 1, trials // 3, trials // 2, trials - 1, trials}):
        own = binomtest(successes, trials).proportion_ci(CONFIDENCE, method="wilson")
        assert wilson(successes, trials) == (own.low, own.high)


def test_nothing_tried_may_be_any_rate():
    assert wilson(0, 0) == (0.0, 1.0)
