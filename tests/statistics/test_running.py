"""Running medians and closed gaps, against scipy.ndimage."""

import numpy as np
import pytest
from scipy import ndimage

from imuwb.statistics import running
from imuwb.statistics.running import closed, running_median


@pytest.mark.parametrize("mode", ["mirror", "nearest"])
@pytest.mark.parametrize(("count", "size"), [(1, 1), (2, 3), (7, 7), (8, 9), (200, 1), (200, 31)])
@pytest.mark.parametrize("few", [0, 10**6])
def test_a_running_median_is_that_of_scipy(mode, count, size, few, monkeypatch):
    monkeypatch.setattr(running, "FEW", few)
    values = np.random.default_rng(count).normal(size=count)
    assert np.array_equal(running_median(values, size, mode), ndimage.median_filter(values, size, mode=mode))


@pytest.mark.parametrize("reach", [1, 5])
def test_closed_gaps_are_a_binary_closing(reach):
    for seed in range(20):
        rows = np.random.default_rng(seed).random(60) < 0.15
        assert np.array_equal(closed(rows, reach), ndimage.binary_closing(rows, iterations=reach))
