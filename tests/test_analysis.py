"""How figures become text."""

import math

import pytest

from imuwb.texts import decimals


@pytest.mark.parametrize(
    ("width", "digits"), [(0.0074, 4), (0.074, 3), (1.0, 1), (30.0, 0), (1e-30, 9), (0.0, 6), (math.inf, 6)]
)
def test_a_value_has_two_digits_of_its_intervals_width(width, digits):
    assert decimals(width) == digits
