"""The axis of a chart over time has two labels at least."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.review.figures.value_axis import value_range


@settings(deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_a_chart_shows_two_multiples_of_a_power_of_ten_and_all_values(low, span):
    values = np.array([low, np.nan, low + span])
    begin, end = value_range(values) or (low, low + span)
    assert begin <= low
    assert end >= values[2]
    step = 10.0 ** math.ceil(math.log10((values[2] - low) / 8))
    assert math.floor(end / step) - math.ceil(begin / step) >= 1


@pytest.mark.parametrize(
    ("low", "high", "ends"),
    [(-0.4, 0.4, None), (-10.48, -9.31, (-10.48, -9.0)), (0.05, 0.97, (0.0, 1.0)), (-0.03, 0.04, None), (2.0, 2.0, None)],
)  # fmt: skip
def test_examples(low, high, ends):
    shown = value_range(np.array([low, high]))
    assert (shown is None) == (ends is None)
    if shown is not None:
        assert shown == pytest.approx(ends, abs=0.05)
