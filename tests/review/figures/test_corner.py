"""A legend stands where it hides no line, if there is such a corner."""

import numpy as np
import pytest

from imuwb.review.figures.corner import free_corner

N = 200


def corner(*lines, limits=None, shown=(0, N - 1)):
    found, hidden = free_corner(np.arange(N), np.stack(lines, axis=1), shown, limits, (0.3, 0.4))
    assert hidden == 0
    return found


@pytest.mark.parametrize(
    ("lines", "found"),
    [
        ([np.linspace(0, 1, N)], "LeftTop"),
        ([np.linspace(1, 0, N)], "RightTop"),
        ([np.linspace(1, 0, N), np.ones(N)], "LeftBottom"),
        ([np.minimum(np.linspace(0, 2, N), 1), np.ones(N)], "RightBottom"),
        ([np.full(N, np.nan)], "LeftTop"),
        ([np.zeros(N)], "LeftTop"),
        ([np.where(np.arange(N) < 100, np.nan, 0.9), np.zeros(N)], "LeftTop"),
    ],
)
def test_the_legend_stands_where_no_line_is(lines, found):
    assert corner(*lines) == found


def test_only_what_the_chart_shows_counts():
    line = np.where(np.arange(N) < 100, 1.0, 0.0)
    assert corner(line) == "RightTop"
    assert corner(line, shown=(100, N - 1), limits=(0, 1)) == "LeftTop"


def test_where_no_corner_is_free_the_first_is_taken():
    lines = np.stack([np.zeros(N), np.ones(N)], axis=1)
    assert free_corner(np.arange(N), lines, (0, N - 1), None, (0.3, 0.4)) == ("LeftTop", 30)
