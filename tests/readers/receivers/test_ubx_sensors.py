"""ESF-RAW and ESF-MEAS in SI, on the UTC of the fixes around them."""

from datetime import timedelta

import numpy as np
import pytest

from imuwb.notes import ids
from tests.readers.receivers import ubx_writer as ubx
from tests.readers.repairs import repairs

RATE, FORCE = {14: 4096, 13: -8192, 5: 2048}, {16: 1024, 17: -512, 18: -10_035}
SI_RATE, SI_FORCE = np.radians([1, -2, 0.5]), [1, -0.5, -10_035 / 1024]
PERIOD = timedelta(milliseconds=10)


def drive(sensor, *, count=3000, fix=100):
    """Return a log: a sensor's message every 10 ms, and a fix after each ``fix`` of them."""
    parts = []
    for i in range(count):
        parts.append(sensor(i))
        if i % fix == fix - 1:
            parts.append(ubx.pvt(ubx.START + (i + 1) * PERIOD))
    return parts


def measured(i, start=5000):
    return ubx.measured(start + 10 * i, {**RATE, 12: 2534}) + ubx.measured(start + 10 * i, FORCE)


def test_measurements_in_si(log_of):
    log = log_of(*drive(measured))
    (imu,) = log.imus
    np.testing.assert_allclose(imu.angular_rate.value, [SI_RATE] * 3000, rtol=1e-14)
    np.testing.assert_allclose(imu.specific_force.value, [SI_FORCE] * 3000, rtol=1e-14)
    assert imu.temperature.value == pytest.approx(25.34)
    assert (imu.name, imu.origin.epoch, imu.origin.frame) == ("ESF-MEAS", "unix", "FRD (assumed)")
    late = imu.angular_rate.time[0] - ubx.ns(ubx.START)
    assert 0 <= late <= 11_000_000
    assert np.diff(imu.angular_rate.time).tolist() == [10_000_000] * 2999
    assert "sensor_tags" in ids(log.notes)
    assert len(log.gnss[0]) == 30


def test_the_users_frame(log_of):
    (imu,) = log_of(*drive(measured, count=600), frame="FLU").imus
    np.testing.assert_allclose(imu.angular_rate.value[0], SI_RATE * [1, -1, -1], rtol=1e-14)
    assert imu.origin.frame == "FLU (stated)"


def test_a_second_tag_is_no_measurement(log_of):
    parts = drive(lambda i: ubx.measured(10 * i, RATE, calibrated=0x0C000123), count=600)
    log = log_of(*parts)
    assert len(log.imus[0].angular_rate) == 600
    assert log.imus[0].temperature is None


@pytest.mark.parametrize("tick", [1 / 25_600, 1e-3, 64e-6, 1.003 / 25_600])
def test_raw_samples_of_any_tick(log_of, tick):
    def raw(i):
        tags = [round((0.01 * i + 0.001 * k) / tick) + 77 for k in range(10)]
        return ubx.raw(*((tag, {**RATE, **FORCE, 12: 2534}) for tag in tags))

    log = log_of(*drive(raw, count=400, fix=10)[:-1])
    time = log.imus[0].angular_rate.time
    assert len(time) == 4000
    rate = 1e9 * 3999 / (time[-1] - time[0])
    assert rate == pytest.approx(1000, rel=3e-4)
    np.testing.assert_allclose(log.imus[0].specific_force.value, [SI_FORCE] * 4000, rtol=1e-14)


@pytest.mark.parametrize("bits", [24, 32])
def test_tags_overflow(log_of, bits):
    log = log_of(*drive(lambda i: ubx.raw(((2**bits - 30_000 + 256 * i) % 2**bits, {**RATE, **FORCE})), count=1000))
    (imu,) = log.imus
    assert np.diff(imu.angular_rate.time) == pytest.approx(10_000_000, abs=1)
    assert not imu.origin.repairs


def test_a_restart_of_the_sensors_clock(log_of):
    def sensor(i):
        return ubx.measured(10 * i + 90_000 if i < 1500 else 10 * (i - 1500), {**RATE, **FORCE})

    (imu,) = log_of(*drive(sensor)).imus
    assert len(imu.angular_rate) == 3000
    assert np.diff(imu.angular_rate.time) == pytest.approx(10_000_000, abs=11_000_000)
    assert repairs(imu)["sensor_restarts"] == 1


def test_without_fixes_ms_are_the_default_of_measurements_only(log_of):
    log = log_of(*(measured(i, start=2**32 - 200) for i in range(100)))
    assert np.diff(log.imus[0].angular_rate.time).tolist() == [10_000_000] * 99
    assert log.imus[0].origin.epoch == "boot"
    log = log_of(*(ubx.raw((256 * i, {**RATE, **FORCE})) for i in range(100)))
    assert not log.imus
    assert "sensor_tags_unknown" in ids(log.notes)


def test_an_axis_that_is_missing_is_counted(log_of):
    def sensor(i):
        values = {**RATE, **FORCE}
        if i % 100 == 7:
            del values[13]
        return ubx.measured(10 * i, values)

    (imu,) = log_of(*drive(sensor, count=600)).imus
    assert (len(imu.angular_rate), len(imu.specific_force)) == (594, 600)
    assert repairs(imu)["incomplete"] == 6


def test_speed_is_read_and_ticks_are_named(log_of):
    parts = drive(
        lambda i: ubx.measured(10 * i, {**RATE, **FORCE}) + ubx.measured(10 * i, {11: -1500, 10: i}, source=7),
        count=600,
    )
    log = log_of(*parts)
    assert log.speeds[0].value.tolist() == [-1.5] * 600
    assert any(note.id == "unused" and "single tick" in note for note in log.notes)


@pytest.mark.parametrize("size", [0, 3, 7, 8, 11, 13])
def test_messages_that_are_too_short(log_of, size):
    parts = [ubx.frame(kind, bytes(size)) for kind in (0x1002, 0x1003, 0x0107, 0x0136)]
    log = log_of(*drive(measured, count=600), *parts)
    assert len(log.imus[0].angular_rate) == 600
    assert "short_message" in ids(log.notes)
