"""Tests of the vibration."""

from dataclasses import replace

import numpy as np
import pytest
from imuwb.errors import MissingDataError
from imuwb.log import Log, Triad
from imuwb.simulation import preset, static
from imuwb.testing import check

import imuwb_vibration

RATE = 200.0  #: Hz


def shaken(amplitude: float, frequency: float, seconds: float = 40.0) -> Log:
    """Return a still log whose z accelerometer shakes by a sine."""
    log = static(preset("adis16465"), seconds, RATE, 1)
    imu = log.imus[0]
    force = imu.specific_force
    assert force is not None
    value = force.value.copy()
    value[:, 2] += amplitude * np.sin(2 * np.pi * frequency * (force.time - force.time[0]) / 1e9)
    return replace(log, imus=(replace(imu, specific_force=Triad(force.time, value)),))


def test_it_keeps_the_contract() -> None:
    """All rules of ``imuwb plugins check`` pass."""
    check(imuwb_vibration, "vibration").require()


@pytest.mark.parametrize(("frequency", "band"), [(3.0, 0), (11.3, 1), (47.0, 2), (90.0, 3)])
def test_a_sine_is_found_in_its_band_with_its_rms(frequency: float, band: int) -> None:
    """A sine of 2 m/s² has a root mean square of 2/√2, all of it in one line."""
    axis = imuwb_vibration.run([shaken(2.0, frequency)], imuwb_vibration.Parameters()).axes["accel_z"]
    found = axis.bands[band]
    assert abs(found.rms.value - 2**0.5) < 0.01
    assert found.line is not None
    assert abs(found.line - frequency) < 0.25
    assert found.share > 0.95
    assert all(other.rms.value < 0.1 for other in axis.bands if other is not found)


def test_white_noise_has_its_density_and_its_interval_holds() -> None:
    """The rms of white noise in a band is its density times the root of the width, in most records inside of the interval."""
    rng, inside = np.random.default_rng(1), 0
    log = static(preset("adis16465"), 60.0, RATE, 1)
    imu = log.imus[0]
    rate = imu.angular_rate
    assert rate is not None
    for _ in range(60):
        noisy = Triad(rate.time, 0.01 * rng.standard_normal(rate.value.shape))
        one = replace(log, imus=(replace(imu, angular_rate=noisy, specific_force=None),))
        band = imuwb_vibration.run([one], imuwb_vibration.Parameters()).axes["gyro_x"].bands[2]
        inside += 0.01 * (60 / (RATE / 2)) ** 0.5 in band.rms
    assert 51 <= inside <= 60  # 57 are expected; 50 or fewer have a probability of 0.1 %


def test_all_bands_together_have_the_power_of_the_bands() -> None:
    """Each frequency is in one band, and in the whole."""
    for axis in imuwb_vibration.run([shaken(0.1, 90.0)], imuwb_vibration.Parameters()).axes.values():
        np.testing.assert_allclose(axis.rms.value**2, sum(band.rms.value**2 for band in axis.bands))


def test_sensors_of_two_rates_share_a_table() -> None:
    """A band that ends earlier for the slower sensor is named by its begin; one that it lacks is a dash."""
    log = shaken(1.0, 10.0)
    imu = log.imus[0]
    force = imu.specific_force
    assert force is not None
    slow = replace(imu, specific_force=Triad(force.time[::2], force.value[::2]))
    result = imuwb_vibration.run([replace(log, imus=(slow,))], imuwb_vibration.Parameters())
    answer = imuwb_vibration.answer(result)
    assert answer.headings == ("rms", "all bands", "1 to 5 Hz", "5 to 20 Hz", "from 20 Hz", "80 to 100 Hz")
    assert {row[-1] == "—" for row in answer.rows if row[0].startswith("accel")} == {True}
    assert {len(row) for row in answer.rows} == {6}


def test_segments_have_no_gap_inside() -> None:
    """A log that has only short parts gives no segment."""
    log = shaken(1.0, 10.0)
    imu = log.imus[0]
    rate = imu.angular_rate
    assert rate is not None
    keep = np.arange(len(rate)) % 400 > 100
    short = replace(imu, angular_rate=Triad(rate.time[keep], rate.value[keep]), specific_force=None)
    with pytest.raises(MissingDataError, match="0 segments"):
        imuwb_vibration.run([replace(log, imus=(short,))], imuwb_vibration.Parameters())


@pytest.mark.parametrize(("text", "named"), [("5,1", "edges"), ("0.1,5", "segment"), ("-1,5", "edges")])
def test_edges_that_no_band_has_are_refused(text: str, named: str) -> None:
    """The message names the option."""
    with pytest.raises(ValueError, match=named):
        imuwb_vibration.Parameters(edges=text)  # pyright: ignore[reportArgumentType] - as a user writes it
