"""Recordings of PX4 are read as pyulog reads them."""

import re

import numpy as np
import pytest

from imuwb.readers import read
from tests.readers.flight import ulog_writer as px4

MICRO, SECOND = 1000, 10**9
FILES = ("pyulog_sample.ulg", "pyulog_sample_appended_multiple.ulg", "pyulog_sample_log_small.ulg", "roboto_test.ulg")


@pytest.fixture(scope="module", params=FILES)
def real(request, shared):
    path = shared / "ulog" / request.param
    columns, told = px4.heard(path)
    return read(path), columns, told


def named(found, name):
    return next(imu for imu in found.imus if imu.name == name)


def rising(times):
    """Return which rows are kept of those whose time rises, and are not repeated."""
    _, first = np.unique(times, return_index=True)
    return first


def samples(topic):
    taken = topic.get("timestamp_sample")
    return (topic["timestamp"] if taken is None or not taken.any() else taken).astype(np.int64)


def offset_of(columns):
    """Return how far UTC is ahead of the boot clock, µs."""
    told = [
        (topic["time_utc_usec"].astype(np.int64) - samples(topic))[topic["time_utc_usec"] > 0]
        for (name, _), topic in columns.items() if name in ("sensor_gps", "vehicle_gps_position")
    ]  # fmt: skip
    told = np.concatenate(told) if told else np.empty(0)
    return int(np.median(told)) if told.size else 0


def test_sensor_combined_equals_pyulogs(real):
    found, columns, _ = real
    imu, topic = named(found, "sensor_combined"), columns["sensor_combined", 0]
    stamps, kept = topic["timestamp"].astype(np.int64), rising(topic["timestamp"])
    np.testing.assert_array_equal(imu.angular_rate.value, topic["gyro_rad"][kept])
    assert np.abs(imu.angular_rate.time // MICRO - offset_of(columns) - stamps[kept]).max() <= 1
    late = stamps + topic["accelerometer_timestamp_relative"]
    there = topic["accelerometer_timestamp_relative"] != 2**31 - 1
    assert np.abs(imu.specific_force.time // MICRO - offset_of(columns) - np.unique(late[there])).max() <= 1
    np.testing.assert_array_equal(
        imu.specific_force.value, topic["accelerometer_m_s2"][there][np.unique(late[there], return_index=True)[1]]
    )


def test_every_single_sensor_equals_pyulogs(real):
    found, columns, _ = real
    for kind, quantity in (("sensor_gyro", "angular_rate"), ("sensor_accel", "specific_force")):
        for (name, instance), topic in columns.items():
            if name != kind or "x" not in topic:
                continue
            imu = named(found, f"sensor_accel.{instance}+sensor_gyro.{instance}")
            triad = getattr(imu, quantity)
            np.testing.assert_array_equal(triad.value, np.stack([topic[axis] for axis in "xyz"], axis=1))
            assert np.abs(triad.time // MICRO - offset_of(columns) - samples(topic)).max() <= 1
            if kind == "sensor_accel":
                np.testing.assert_array_equal(imu.temperature.value, topic["temperature"])


def test_increments_over_their_span_equal_pyulogs(real):
    found, columns, _ = real
    for (name, instance), topic in columns.items():
        if name == "vehicle_imu":
            imu = named(found, f"vehicle_imu.{instance}")
            for triad, delta in ((imu.angular_rate, "delta_angle"), (imu.specific_force, "delta_velocity")):
                told = topic[delta] / (topic[f"{delta}_dt"][:, None] * 1e-6)
                np.testing.assert_allclose(triad.value, told, rtol=1e-6)
            assert np.median(np.linalg.norm(imu.specific_force.value, axis=1)) == pytest.approx(9.8, abs=2)


def test_receivers_equal_pyulogs(real):
    found, columns, _ = real
    seen = 0
    for (name, _), topic in columns.items():
        if name not in ("sensor_gps", "vehicle_gps_position"):
            continue
        place = [topic["lat"] * 1e-7, topic["lon"] * 1e-7] if "lat" in topic else [
            topic["latitude_deg"], topic["longitude_deg"]
        ]  # fmt: skip
        height = topic["alt_ellipsoid"] * 1e-3 if "lat" in topic else topic["altitude_ellipsoid_m"]
        there = (place[0] != 0) | (place[1] != 0)
        if not there.any():
            assert name not in [gnss.name for gnss in found.gnss]
            continue
        gnss = next(gnss for gnss in found.gnss if gnss.name == name)
        kept = np.flatnonzero(there)[rising(samples(topic)[there])]
        np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), place[0][kept], rtol=1e-12)
        np.testing.assert_allclose(np.degrees(gnss.position[:, 1]), place[1][kept], rtol=1e-12)
        np.testing.assert_allclose(gnss.position[:, 2], height[kept], rtol=1e-12)
        np.testing.assert_array_equal(gnss.velocity[:, 1], topic["vel_e_m_s"][kept])
        np.testing.assert_array_equal(gnss.position_sigma[:, 2], topic["epv"][kept])
        np.testing.assert_array_equal(gnss.fix_type, topic["fix_type"][kept])
        utc = topic["time_utc_usec"][kept].astype(np.int64)
        assert np.median(np.abs(gnss.time // MICRO - utc)[utc > 0]) < 50_000
        seen += 1
    assert seen == len(found.gnss)


def test_dropouts_are_noted(real):
    found, _, told = real
    notes = [note for note in found.notes if note.id == "dropouts"]
    if not told.dropouts:
        assert notes == []
        return
    spans = [one.duration for one in told.dropouts]
    assert [re.findall(r"\d+", note) for note in notes] == [[str(len(spans)), str(sum(spans)), str(max(spans))]]
