import numpy as np
import pytest

from imuwb.log import SECOND, ImuStream, Log, Provenance, Triad
from imuwb_plugins.noise import denoising, show_denoising


def log(values, rate=100):
    time = np.arange(len(values)) * (SECOND // rate)
    return Log(Provenance("x.csv", "csv", "sha256:", 0), imus=(ImuStream("/imu", Triad(time, values), None),))


@pytest.fixture(scope="module")
def found():
    return denoising.denoising(log(np.random.default_rng(81).standard_normal((20_000, 3))), 5)


def test_the_z_axis_raw_and_at_two_depths(found):
    assert [(c.axis, c.levels) for c in found.curves] == [("gyro_z", 0), ("gyro_z", 3), ("gyro_z", 5)]
    assert [c.band for c in found.curves] == pytest.approx([50, 6.25, 1.5625])
    assert found.rate_hz == {"gyro": pytest.approx(100)}


def test_short_term_noise_goes_and_long_term_noise_stays(found):
    raw, _, deep = found.curves
    assert deep.allan_deviation[0] < 0.1 * raw.allan_deviation[0]
    slow = (raw.averaging_time > 5) & (raw.averaging_time < 40)
    np.testing.assert_allclose(deep.allan_deviation[slow], raw.allan_deviation[slow], rtol=0.1)
    assert deep.deviation == pytest.approx(2**-2.5, rel=0.15)
    above, below = deep.frequency > 10, deep.frequency < 0.5
    assert deep.density[above].mean() < 1e-2 * raw.density[above].mean()
    np.testing.assert_allclose(deep.density[below].mean(), raw.density[below].mean(), rtol=0.1)


def test_a_log_too_short_or_constant_has_none():
    assert denoising.denoising(log(np.random.default_rng(1).standard_normal((4000, 3))), 5) is None
    assert denoising.denoising(log(np.ones((20_000, 3))), 5) is None


def test_levels_that_the_log_has_not_are_left_out():
    found = denoising.denoising(log(np.random.default_rng(1).standard_normal((5000, 3))), 15)
    assert [c.levels for c in found.curves] == [0, 3]


def test_limits_of_motion_are_drawn(found):
    figures, tables = [], []

    class Review:
        figure = figures.append
        table = tables.append

    show_denoising.draw(found, Review())
    allan, spectrum = figures
    assert [v.x for v in allan.verticals] == pytest.approx([0.16, 0.64])
    assert [v.x for v in spectrum.verticals] == pytest.approx([6.25, 1.5625])
    (table,) = tables
    assert [row[1] for row in table.rows] == ["0 (raw)", "3", "5"]
    assert table.rows[0][-1] == "100 %"
