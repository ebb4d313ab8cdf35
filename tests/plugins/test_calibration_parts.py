"""Thresholds and units of the calibration's parts, each by itself."""

import numpy as np
import pytest

from imuwb import simulation
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.calibration import AxisCalibration
from imuwb.notes import ids
from imuwb.statistics import Estimate
from imuwb_plugins.calibration import METHODS
from imuwb_plugins.calibration.error_model import check_gain, parameters_of
from imuwb_plugins.calibration.parameter_table import parameter_text
from imuwb_plugins.calibration.rate_table import _up
from imuwb_plugins.calibration.stretches import SteadyStretch, check_still, temperature_of


@pytest.fixture(scope="module")
def turned():
    """Return the logs of a rate table that turns at 10, 50 and 100 deg/s."""
    sensor = simulation.specimen(simulation.preset("mpu-6050"), 11, simulation.Tolerances())
    made = simulation.rate_table(sensor, 11, np.radians([10.0, 50.0, 100.0]), seconds=4, rate=50, misplacement=0.0)
    return list(made.logs.values())[:1]


def noted(logs, rates):
    method = METHODS["rate-table"]
    return set(ids(method.run(logs, method.Parameters(rates=rates)).notes))


@pytest.mark.parametrize(
    ("rates", "doubts"),
    [
        ((10.0, 50.0, 100.0), set()),
        ((10.6, 53.0, 106.0), set()),
        ((11.5, 57.5, 115.0), {"large-scale-factor"}),
        ((10.0, 51.0, 100.0), {"steps-miss"}),
    ],
)
def test_rates_that_are_wrong_by_a_tenth_or_miss_the_line_by_a_thousandth_are_doubted(turned, rates, doubts):
    assert noted(turned, rates) & {"large-scale-factor", "steps-miss"} == doubts


@pytest.mark.parametrize(("change", "noted"), [(1.5, ()), (2.5, ("warmed",))])
def test_a_temperature_that_changes_by_two_degrees_is_noted(change, noted):
    stretches = [SteadyStretch("a", 10.0, None, None, 20.0 + t) for t in (0.0, change)]
    celsius, notes = temperature_of(stretches)
    assert celsius == pytest.approx(20 + change / 2)
    assert ids(notes) == noted


@pytest.mark.parametrize(("sigma", "still"), [(0.004, True), (0.006, False)])
def test_a_mean_of_a_still_sensor_is_sure_to_half_a_per_cent_of_the_span(sigma, still):
    stretches = [SteadyStretch(name, 10.0, None, None, None) for name in "ab"]
    mean, variance = np.array([[0.0, 0.0, -5.0], [0.0, 0.0, 5.0]]), np.full((2, 3), (10 * sigma) ** 2)
    if still:
        check_still(stretches, mean, variance)
        return
    with pytest.raises(MissingDataError, match="a: it is not still"):
        check_still(stretches, mean, variance)


@pytest.mark.parametrize(("gain", "plausible"), [(1.9, True), (2.1, False), (0.55, True), (0.45, False)])
def test_a_gain_in_si_is_within_a_factor_of_two(gain, plausible):
    axes = {"accel_x": AxisCalibration(None, Estimate(gain - 1, gain - 1, gain - 1))}
    check_gain(axes, "count")
    if plausible:
        check_gain(axes, "")
        return
    with pytest.raises(UsageError, match=f"{gain:g} times"):
        check_gain(axes, "")


@pytest.mark.parametrize(("share", "up"), [(0.8, 1.0), (-0.8, -1.0), (0.6, None)])
def test_an_axis_with_seven_tenths_of_gravity_is_vertical(share, up):
    assert _up(9.8 * np.array([[(1 - share**2) ** 0.5, share, 0.0]]), 1) == up


def test_parameters_of_counts_are_a_sensitivity_and_its_inverse():
    c = AxisCalibration(
        Estimate(5.0, 4.0, 6.0, 0.5), Estimate(99.0, 97.0, 101.0, 1.0), Estimate(0.2, 0.1, 0.3, 0.05),
        (Estimate(1.0, 0.9, 1.1, 0.05), None),
    )  # fmt: skip
    terms = parameters_of("gyro_x", c, "count")
    assert terms["bias"] == Estimate(5.0, 4.0, 6.0, 0.5, "count")
    assert terms["sensitivity"] == Estimate(100.0, 98.0, 102.0, 1.0, "count/(rad/s)")
    one = terms["value_of_one"]
    assert (one.value, one.lower, one.upper, one.unit) == (0.01, 1 / 102, 1 / 98, "rad/s per count")
    assert one.sigma == pytest.approx(1e-4)
    assert terms["scale_factor_nonlinear"].value == pytest.approx(0.002)
    assert terms["cross_coupling_y"].value == pytest.approx(0.01)
    assert "scale_factor" not in terms
    assert "cross_coupling_z" not in terms


def test_parameters_are_shown_in_their_display_units():
    assert parameter_text(None) == "—"
    assert parameter_text(Estimate(0.0123, 0.0113, 0.0133, unit="1")) == "1.23 [1.13, 1.33] %"
    assert parameter_text(Estimate(np.radians(2), np.radians(1), np.radians(3), unit="rad/s")) == "2.0 [1.0, 3.0] deg/s"
    assert parameter_text(Estimate(100.0, 99.0, 101.0, unit="count/(m/s²)")).startswith("981 [971, 990] count/g")
