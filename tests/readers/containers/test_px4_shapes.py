"""Messages of PX4 in a ROS recording give the streams that its own logs have."""

import numpy as np
import pytest

from imuwb.notes import ids
from tests.readers.repairs import repairs

from .shape_truth import (
    BOOT,
    COUNT,
    FORCE,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    RATE,
    VELOCITY,
    T,
    assert_gnss,
    assert_imu,
)


@pytest.mark.parametrize("form", [0, 1])
def test_px4_sensor_combined(log_of, form):
    def values(i, time):
        return {
            "timestamp": (BOOT + i * 4 * 10**6) // 1000, "gyro_rad": RATE, "accelerometer_m_s2": FORCE,
            "accelerometer_timestamp_relative": -1500,
        }  # fmt: skip

    log = log_of({"/fmu/out/sensor_combined": ("px4_msgs/msg/SensorCombined", values)}, form=form)
    (imu,) = log.imus
    assert_imu(imu)
    assert imu.angular_rate.time.tolist() == [BOOT + i * 4 * 10**6 for i in range(COUNT)]
    assert (imu.angular_rate.time - imu.specific_force.time).tolist() == [1_500_000] * COUNT
    assert (imu.origin.frame, imu.origin.epoch) == ("FRD", "log")
    assert ids(log.notes) == ("other_clock",)


def test_px4_stamps_may_count_from_1970(log_of):
    def values(i, time):
        return {"timestamp": time // 1000, "gyro_rad": RATE, "accelerometer_m_s2": FORCE}

    (imu,) = log_of({"/imu": ("px4_msgs/msg/SensorCombined", values)}).imus
    assert imu.origin.epoch == "unix"
    assert imu.angular_rate.time.tolist() == imu.specific_force.time.tolist() == [T + i * 10**7 for i in range(COUNT)]


def test_a_sample_of_px4_without_a_time_has_none(log_of):
    def values(i, time):
        relative = 2**31 - 1 if i == 7 else 0
        return {
            "timestamp": (BOOT + i * 10**7) // 1000, "gyro_rad": RATE, "accelerometer_m_s2": FORCE,
            "accelerometer_timestamp_relative": relative,
        }  # fmt: skip

    (imu,) = log_of({"/imu": ("px4_msgs/msg/SensorCombined", values)}).imus
    assert len(imu.angular_rate) == COUNT
    assert np.ptp(imu.specific_force.time) == np.ptp(imu.angular_rate.time)


def test_px4_single_sensors(log_of):
    def values(vector):
        return lambda i, _: {
            "timestamp": (BOOT + i * 10**6) // 1000 + 300, "timestamp_sample": (BOOT + i * 10**6) // 1000,
            **dict(zip("xyz", vector, strict=True)), "temperature": 41.5,
        }  # fmt: skip

    log = log_of({
        "/fmu/out/sensor_gyro": ("px4_msgs/msg/SensorGyro", values(RATE)),
        "/fmu/out/sensor_accel": ("px4_msgs/msg/SensorAccel", values(FORCE)),
    })  # fmt: skip
    triads = [triad for imu in log.imus for triad in imu.sensors().values()]
    assert sorted(len(triad) for triad in triads) in ([COUNT, COUNT], [COUNT])
    assert all(triad.time[0] == BOOT for triad in triads)
    assert [imu.temperature.value[0] for imu in log.imus if imu.temperature is not None] == [41.5]


def px4_fix(i, time):
    return {
        "timestamp": (BOOT + i * 10**7) // 1000, "latitude_deg": LATITUDE, "longitude_deg": LONGITUDE,
        "altitude_msl_m": HEIGHT - 48, "altitude_ellipsoid_m": HEIGHT, "eph": 0.5, "epv": 0.8, "s_variance_m_s": 0.25,
        "fix_type": 6, "vel_n_m_s": VELOCITY[0], "vel_e_m_s": VELOCITY[1], "vel_d_m_s": VELOCITY[2], "vel_ned_valid": 1,
    }  # fmt: skip


@pytest.mark.parametrize("form", range(5))
def test_px4_receivers_of_every_version(log_of, form):
    def values(i, time):
        found = px4_fix(i, time)
        if form >= 3:
            old = {
                "lat": round(LATITUDE * 1e7),
                "lon": round(LONGITUDE * 1e7),
                "alt": 402_000,
                "alt_ellipsoid": 450_000,
            }
            found = {
                name: value for name, value in found.items() if "_deg" not in name and "altitude" not in name
            } | old
        return found

    (gnss,) = log_of({"/fmu/out/vehicle_gps_position": ("px4_msgs/msg/SensorGps", values)}, form=form).gnss
    assert_gnss(gnss, sigma=(0.5, 0.5, 0.8), velocity_sigma=(0.25,) * 3, fix=6)
    assert gnss.time[0] == BOOT


def test_px4_fixes_without_a_position_are_left_out(log_of):
    def values(i, time):
        none = {"latitude_deg": 0, "longitude_deg": 0, "fix_type": 0} if i < 10 else {}
        return px4_fix(i, time) | none

    (gnss,) = log_of({"/gps": ("px4_msgs/msg/SensorGps", values)}).gnss
    assert len(gnss) == COUNT - 10
    assert repairs(gnss) == {"no_position": 10}


def test_px4_solution_is_that_of_its_filter(log_of):
    def values(i, time):
        return {
            "timestamp": (BOOT + i * 10**7) // 1000, "lat": LATITUDE, "lon": LONGITUDE, "alt": 402.0, "alt_ellipsoid": HEIGHT,
            "eph": 0.5, "epv": 0.75, "lat_lon_valid": 1, "alt_valid": 1,
        }  # fmt: skip

    log = log_of({"/fmu/out/vehicle_global_position": ("px4_msgs/msg/VehicleGlobalPosition", values)})
    (reference,) = log.references
    np.testing.assert_allclose(reference.position[0], [np.radians(LATITUDE), np.radians(LONGITUDE), HEIGHT], rtol=1e-7)
    np.testing.assert_allclose(reference.position_sigma[0], [0.5, 0.5, 0.75])
    assert reference.origin.by_filter


def test_px4_odometry_is_a_track_of_its_own(log_of):
    half = np.sqrt(0.5)  # heading east in NED

    def values(i, time):
        return {
            "timestamp": (BOOT + i * 10**7) // 1000, "pose_frame": 1, "position": (float(i), 2.0, -3.0),
            "q": (half, 0.0, 0.0, half), "position_variance": (0.25, 0.25, 1.0),
        }  # fmt: skip

    (track,) = log_of({"/fmu/out/vehicle_odometry": ("px4_msgs/msg/VehicleOdometry", values)}).poses
    np.testing.assert_allclose(track.position[7], [7, 2, -3])
    np.testing.assert_allclose(track.position_sigma[7], [0.5, 0.5, 1])
    # forward points east; left, the second axis of ROS, points north; up is up
    np.testing.assert_allclose(track.rotation[0], [[0, 1, 0], [1, 0, 0], [0, 0, -1]], atol=1e-6)
