"""The study of the smoothed trajectory with few drives: its figures must lie within the limits of chance."""

import pytest

pytestmark = pytest.mark.slow


def test_the_separation_agrees_with_its_sigma_and_the_smoothed_track_is_nearer(load):
    separation, gaps = load("separation_consistency").study(records=2, seconds=600.0, workers=1)
    roots = [float(root) for root in separation.column("root mean square")[:8]]
    assert all(0.6 < root < 1.5 for root in roots)
    forward, smoothed, _ = (float(rms.split()[0]) for rms in gaps.column("rms"))
    assert smoothed < 0.5 * forward
