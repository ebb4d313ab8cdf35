"""Tests of the analysis."""

from dataclasses import replace

import numpy as np
from imuwb.log import Triad
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


def test_an_axis_that_does_not_change_has_an_answer() -> None:
    """A stuck axis scatters by 0, which no other scatter can be divided by."""
    log = static(preset("adis16465"), 30, 100, 1)
    imu = log.imu()
    rate = imu.angular_rate
    assert rate is not None
    stuck = replace(imu, angular_rate=Triad(rate.time, np.zeros_like(rate.value)), specific_force=None)
    result = plugin_name.run([replace(log, imus=(stuck,))], plugin_name.Parameters())
    assert len(plugin_name.answer(result).rows) == 3
