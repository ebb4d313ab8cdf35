"""The analysis over temperature and thermometers that are wrong: refused, mended, or named."""

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.notes import ids
from imuwb_plugins import temperature
from imuwb_plugins.temperature.log_checks import with_sound_thermometers
from imuwb_plugins.temperature.sensor_temperature import lag_of

RATE = 20
PLAIN = temperature.Parameters()


def log_of(celsius, readings):
    """Return a log with a row of the thermometer each second; the gyros follow the temperature."""
    rng = np.random.default_rng(7)
    time = np.arange(celsius.size * RATE) * (SECOND // RATE)
    noise = rng.standard_normal((time.size, 6))
    gyro = 1e-3 * noise[:, :3] + np.radians(0.02) * (np.repeat(celsius, RATE)[:, None] - 25)
    thermometer = Scalars("imu", time[::RATE], readings)
    imu = ImuStream("imu", Triad(time, gyro), Triad(time, 0.02 * noise[:, 3:] - [0, 0, 9.8]), thermometer)
    return Log(Provenance("made.csv", "csv", "sha256:1", 0), (imu,))


RAMP = np.round(np.linspace(0, 40, 3600), 2)


@pytest.mark.parametrize(
    ("readings", "piece"),
    [
        (RAMP + 273.15, "temperature=K"),
        (np.where(np.abs(np.arange(3600) - 1800) > 1300, RAMP, 20.0), "--start and --end"),
    ],
    ids=["kelvin", "stuck"],
)
def test_wrong_temperatures_are_refused_with_the_remedy(readings, piece):
    with pytest.raises(MissingDataError, match=piece):
        temperature.run([log_of(RAMP, readings)], PLAIN)
    assert with_sound_thermometers([log_of(RAMP, readings)], temperature.Parameters(celsius=(20.0,)))[1] == []


def test_the_part_with_a_stuck_thermometer_is_left_out_and_named():
    stuck = np.where(np.arange(3600) < 1800, RAMP, 20.0)
    (log,), notes = with_sound_thermometers([log_of(RAMP, stuck)], PLAIN)
    assert ids(notes) == ("thermometer-stuck",)
    assert "after 1800 s is left out" in notes[0]
    assert log.imu().temperature.value[-1] == pytest.approx(RAMP[1799], abs=0.1)
    (late,), notes = with_sound_thermometers([log_of(RAMP, np.where(np.arange(3600) < 1800, 20.0, RAMP))], PLAIN)
    assert "before" in notes[0]
    assert len(late.imu().temperature) == pytest.approx(1800, abs=2)


def test_spikes_are_left_out_and_counted():
    readings = RAMP.copy()
    readings[100::200] = 85.0
    (log,), notes = with_sound_thermometers([log_of(RAMP, readings)], PLAIN)
    assert ids(notes) == ("thermometer-spikes",)
    assert "18 of its readings" in notes[0]
    assert log.imu().temperature.value.max() == 40
    assert len(log.imu().temperature) == 3600 - 18


def test_a_sound_thermometer_is_left_as_it_is():
    log = log_of(RAMP, RAMP)
    (same,), notes = with_sound_thermometers([log], PLAIN)
    assert notes == []
    assert np.array_equal(same.imu().temperature.value, log.imu().temperature.value)


def test_a_temperature_that_may_be_in_fahrenheit_is_named():
    assert ids(with_sound_thermometers([log_of(RAMP, RAMP * 1.8 + 32)], PLAIN)[1]) == ("thermometer",)


def test_a_block_lies_at_the_mean_time_of_its_samples():
    time = np.arange(3600 * 5 + 1) * (SECOND // 5)
    celsius = np.linspace(0, 80, time.size)
    values = celsius[:, None] * [1, -1, 0.5]
    imu = ImuStream("imu", Triad(time, values), Triad(time, values), Scalars("imu", time, celsius))
    log = Log(Provenance("made.csv", "csv", "sha256:1", 0), (imu,))
    found = lag_of(log, temperature.Parameters(lag=0.0))
    assert found.time[:2] == pytest.approx([1.1, 3.5])  # 12 samples a block; the edges are 0, 2.4 and 4.8 s
    np.testing.assert_allclose(found.axes["gyro_x"], np.interp(found.time, time / SECOND, celsius), atol=1e-9)
