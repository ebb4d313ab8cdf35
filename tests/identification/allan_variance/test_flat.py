"""The flat part of an Allan curve, by hand."""

import numpy as np
import pytest

from imuwb.identification.allan_variance.flat import FlatPart, flat_part, measured_flat_part

TAU = np.geomspace(0.1, 1000, 4001)


def test_the_middle_is_arithmetic():
    assert FlatPart(321.92, 654.01, ends=True).centre == pytest.approx(490.89, rel=0.01)  # Quinchia, 5.5 and table 5


def test_a_part_that_ends():
    """With x = tau/10 the variance is 1 + e (x + 1/x - 2): within 1.05² where x + 1/x is below a number."""
    curve = np.sqrt(1 + 0.1 * (TAU / 10 + 10 / TAU - 2))
    edge = (1.05**2 - 1) / 0.1 + 2
    ends = np.roots([1, -edge, 1]) * 10
    part = flat_part(TAU, curve)
    assert (part.end, part.begin) == pytest.approx(ends, rel=0.01)
    assert part.ends


def test_a_part_that_lasts_is_a_bound():
    part = flat_part(TAU, np.sqrt(1 + 1 / TAU))
    assert part.begin == pytest.approx(1 / (1.05**2 * (1 + 1e-3) - 1), rel=0.02)
    assert not part.ends
    assert part.correlation_time.upper == np.inf


@pytest.mark.parametrize(("leaves", "ends"), [(100.0, True), (900.0, False)])
def test_the_measured_curve_ends_it(leaves, ends):
    """Averages of more than a ninth of the record are not read."""
    smooth = np.sqrt(1 + 1 / TAU)
    measured = np.where(leaves < TAU, 1.3, 1.0) * smooth
    part = measured_flat_part(TAU, measured, smooth, 4500.0)
    assert part.ends == ends
    assert part.end == pytest.approx(100.0 if ends else 500.0, rel=0.05)
