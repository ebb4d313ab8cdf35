"""What is drawn with few points shows what was drawn with many."""

import numpy as np

from imuwb.analysis import Curve, Figure, Series
from imuwb.colors import BLUE
from imuwb.review.drawn.calls import Drawn, Track
from imuwb.review.drawn.thin import COLUMNS, PLACES, SPANS, thin

MANY = 100_000


def curve_of(x, y, *, style="curve", scale="log", **more):
    figure = Figure("f", "x", "y", (Curve("a", x, y, BLUE, style=style, **more),), x_scale=scale, y_scale="linear")
    return thin(Drawn("tab", figure)).item.curves[0]


def test_a_long_curve_keeps_its_peaks_and_its_ends():
    x, y = np.arange(1.0, MANY + 1), np.ones(MANY)
    y[70_000], y[3] = 50.0, -7.0
    kept = curve_of(x, y, lower=y - 1, upper=y + 1)
    assert kept.x.size <= 2 * COLUMNS + 2
    assert (kept.y.max(), kept.y.min(), kept.x[0], kept.x[-1]) == (50.0, -7.0, 1.0, MANY)
    assert np.array_equal(kept.lower, kept.y - 1)
    assert np.array_equal(kept.upper, kept.y + 1)


def test_each_decade_of_a_logarithmic_axis_keeps_points():
    x = np.arange(1.0, MANY + 1)  # evenly spaced, as a spectrum is
    kept = curve_of(x, np.sin(x))
    assert all(((kept.x >= 10**k) & (kept.x < 10 ** (k + 1))).sum() >= 9 for k in range(5))


def test_a_short_curve_stays_and_a_gap_stays_a_gap():
    short = np.arange(1.0, 20.0)
    assert curve_of(short, short).x is short
    y = np.ones(MANY)
    y[40_000:60_000] = np.nan
    assert np.isnan(curve_of(np.arange(1.0, MANY + 1), y, scale="linear").y).any()


def test_a_cloud_keeps_its_shape():
    rng = np.random.default_rng(0)
    x, y = rng.normal(size=(2, MANY))
    kept = curve_of(x, y, style="points", scale="linear")
    assert kept.x.size < MANY / 5
    assert (np.ptp(kept.x), np.ptp(kept.y)) == (np.ptp(x), np.ptp(y))


def test_series_and_tracks_get_few_rows():
    series = thin(Drawn("tab", Series("s", "m", np.arange(MANY), np.arange(MANY)[:, None] * 1.0, ("a",)))).item
    assert series.time.size <= 2 * SPANS
    track = thin(Drawn("tab", Track("t", np.arange(3.0 * MANY).reshape(-1, 3), BLUE))).item
    assert len(track.position) == PLACES
    assert (track.position[0, 0], track.position[-1, 2]) == (0.0, 3.0 * MANY - 1)
    assert len(thin(Drawn("tab", Track("t", np.empty((0, 3)), BLUE))).item.position) == 0
