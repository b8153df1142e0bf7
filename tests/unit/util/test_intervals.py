"""Intervals of rates and values, against scipy's."""

import numpy as np
import pytest
from scipy.stats import binomtest, bootstrap

from host.util.intervals import CONFIDENCE, RESAMPLES, bootstrap_interval, wilson


@pytest.mark.parametrize("trials", [1, 2, 7, 50, 150, 1000, 12345])
def test_wilsons_interval_is_scipys(trials):
    for successes in sorted({0, 1, trials // 3, trials // 2, trials - 1, trials}):
        own = binomtest(successes, trials).proportion_ci(CONFIDENCE, method="wilson")
        assert wilson(successes, trials) == (own.low, own.high)


def test_nothing_tried_may_be_any_rate():
    assert wilson(0, 0) == (0.0, 1.0)


@pytest.mark.parametrize("of", [np.mean, np.median])
@pytest.mark.parametrize("values", [2, 3, 10, 57])
def test_the_bootstrap_interval_is_scipys(values, of):
    sample = np.random.default_rng(values).normal(size=values)
    own = bootstrap(
        (sample,),
        of,
        confidence_level=CONFIDENCE,
        method="percentile",
        n_resamples=RESAMPLES,
        rng=np.random.default_rng(0),
    ).confidence_interval
    found = bootstrap_interval(sample.tolist(), of)
    assert found == pytest.approx((own.low, own.high), rel=1e-14)
