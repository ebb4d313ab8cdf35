"""Tests of the analysis."""

import numpy as np
from imuwb.simulation import preset, static
from imuwb.testing import check

import plugin_name


def test_it_keeps_the_contract() -> None:
    """All rules of ``imuwb plugins check`` pass."""
    check(plugin_name, "plugin_name").require()


def test_the_usual_scatter_is_the_median_of_all_pieces() -> None:
    """With pieces of one second, at 100 Hz, it is the median of the standard deviations of each hundred samples."""
    log = static(preset("adis16465"), 30, 100, 1)
    result = plugin_name.run([log], plugin_name.Parameters(length=1.0))
    rate = log.imu().angular_rate
    assert rate is not None
    scatter = rate.value[:3000, 0].reshape(30, 100).std(axis=1, ddof=1)
    usual = result.axes["gyro_x"].usual
    np.testing.assert_allclose(
        (usual.value, usual.lower, usual.upper), (np.median(scatter), scatter.min(), scatter.max())
    )
