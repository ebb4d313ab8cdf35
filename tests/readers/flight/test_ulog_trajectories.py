"""Receivers, clock and navigation solution of PX4's logs."""

import math

import numpy as np
import pytest

from imuwb.notes import ids
from tests.readers.flight import ulog_writer as px4

MICRO, SECOND = 1000, 10**9
FILES = ("pyulog_sample.ulg", "pyulog_sample_appended_multiple.ulg", "pyulog_sample_log_small.ulg", "roboto_test.ulg")


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize("topic", ["sensor_gps", "vehicle_gps_position"])
def test_fixes_in_degrees_and_in_integers_are_read(ulog_of, topic, degrees):
    rows = px4.fixes(5)
    if degrees:
        rows = [
            {**row, "latitude_deg": row["lat"] * 1e-7, "longitude_deg": row["lon"] * 1e-7, "altitude_msl_m": 400.0,
             "altitude_ellipsoid_m": 447.5} for row in rows
        ]  # fmt: skip
    found = ulog_of(px4.topic(topic, 1, px4.GPS_DEG if degrees else px4.GPS, rows))
    (gnss,) = found.gnss
    assert gnss.name == topic
    np.testing.assert_allclose(np.degrees(gnss.position[:, 0]), 47.3 + 1e-5 * np.arange(5), rtol=1e-12)
    np.testing.assert_allclose(gnss.position[:, 1:], [[math.radians(8.5), 447.5]] * 5, rtol=1e-12)
    np.testing.assert_array_equal(gnss.velocity, [[1.5, -2.5, 0.25]] * 5)
    np.testing.assert_array_equal(gnss.position_sigma, [[0.5, 0.5, 0.75]] * 5)
    np.testing.assert_array_equal(gnss.velocity_sigma, [[0.25] * 3] * 5)
    assert gnss.fix_type.tolist() == [3] * 5
    assert gnss.time[0] == (px4.UTC + px4.START) * MICRO
    assert gnss.origin.epoch == "unix"


def test_times_since_power_up_become_utc_by_the_median_fix(ulog_of):
    rows = px4.fixes(9)
    rows[0]["time_utc_usec"] = 0
    rows[3]["time_utc_usec"] += 10**9
    found = ulog_of(px4.combined(10), px4.topic("sensor_gps", 2, px4.GPS, rows))
    assert found.imu().angular_rate.time[0] == (px4.UTC + px4.START) * MICRO
    assert found.gnss[0].time[0] == found.imu().angular_rate.time[0]
    assert "utc_by_receiver" in ids(found.notes)


def test_without_a_date_times_count_from_power_up(ulog_of):
    found = ulog_of(px4.combined(10), px4.topic("sensor_gps", 2, px4.GPS, px4.fixes(5, time_utc_usec=0)))
    assert found.imu().angular_rate.time[0] == px4.START * MICRO
    assert found.imu().origin.epoch == found.gnss[0].origin.epoch == "boot"
    assert "no_date" in ids(found.notes)


def test_velocities_and_accuracies_that_are_not_valid_are_unknown(ulog_of):
    rows = px4.fixes(4)
    rows[1].update(vel_ned_valid=False, eph=0.0)
    rows[2].update(epv=0.0, s_variance_m_s=0.0)
    (gnss,) = ulog_of(px4.topic("sensor_gps", 1, px4.GPS, rows)).gnss
    assert np.isnan(gnss.velocity).tolist() == [[False] * 3, [True] * 3, [False] * 3, [False] * 3]
    nan = [[False] * 3, [True, True, False], [False, False, True], [False] * 3]
    assert np.isnan(gnss.position_sigma).tolist() == nan
    assert np.isnan(gnss.velocity_sigma[:, 0]).tolist() == [False, False, True, False]


def test_rows_without_a_fix_are_counted(ulog_of):
    rows = px4.fixes(7)
    for row in rows[:3]:
        row.update(lat=0, lon=0, fix_type=0)
    (gnss,) = ulog_of(px4.topic("sensor_gps", 1, px4.GPS, rows)).gnss
    assert len(gnss) == 4
    assert [(r.what.id, r.count) for r in gnss.origin.repairs] == [("no_position", 3)]


def test_a_receiver_that_never_had_a_fix_is_noted(ulog_of):
    found = ulog_of(px4.combined(5), px4.topic("sensor_gps", 2, px4.GPS, px4.fixes(3, lat=0, lon=0)))
    assert found.gnss == ()
    assert "no_position" in ids(found.notes)


def turned(heading, roll=0.0, pitch=0.0):
    """Return the quaternion, body to NED, of a turn about z, then y, then x."""
    a, b, c = roll / 2, pitch / 2, heading / 2
    product = np.array([math.cos(c), 0, 0, math.sin(c)])
    for turn in ([math.cos(b), 0, math.sin(b), 0], [math.cos(a), math.sin(a), 0, 0]):
        (w, *v), (s, *u) = product, turn
        v, u = np.array(v), np.array(u)
        product = np.array([w * s - v @ u, *(w * u + s * v + np.cross(v, u))])
    return product.tolist()


def attitude(angles):
    rows = [{"timestamp": px4.START + 100_000 * i, "q": turned(*one)} for i, one in enumerate(angles)]
    return px4.topic("vehicle_attitude", 31, px4.ATTITUDE, rows)


def test_the_reference_is_the_global_position_with_velocity_and_attitude(ulog_of):
    rows = [{"timestamp": px4.START + 50_000 + 100_000 * i, "lat": 47.3 + i * 1e-6, "lon": 8.5, "alt": 450.0}
            for i in range(10)]  # fmt: skip
    found = ulog_of(
        px4.topic("vehicle_global_position", 1, px4.GLOBAL, rows),
        px4.topic("vehicle_local_position", 2, px4.LOCAL, px4.local_rows()),
        attitude([(0.1 * i, 0.3, -0.2) for i in range(20)]),
    )
    (reference,) = found.references
    assert reference.name == "vehicle_global_position"
    np.testing.assert_allclose(np.degrees(reference.position[:, 0]), 47.3 + np.arange(10) * 1e-6, rtol=1e-13)
    np.testing.assert_allclose(reference.velocity, [[100, i + 0.5, -1] for i in range(10)])
    np.testing.assert_allclose(reference.attitude, [[0.3, -0.2, 0.1 * (i + 0.5)] for i in range(10)], atol=1e-6)


def test_the_reference_is_the_local_position_where_there_is_no_global_one(ulog_of):
    (reference,) = ulog_of(px4.topic("vehicle_local_position", 2, px4.LOCAL, px4.local_rows())).references
    assert reference.name == "vehicle_local_position"
    assert reference.attitude is None
    # A degree of latitude at 47.3 deg is 111 174 m long, one of longitude 75 633 m (WGS 84).
    np.testing.assert_allclose(
        np.degrees(reference.position[:, 0]) - 47.3, np.arange(20) * 10 / 111_174, rtol=1e-3, atol=1e-8
    )
    np.testing.assert_allclose(np.degrees(reference.position[:, 1]) - 8.5, -20 / 75_633, rtol=1e-3)
    np.testing.assert_allclose(reference.position[:, 2], 453, atol=0.01)
    np.testing.assert_allclose(reference.velocity[:, 1], np.arange(20))


def test_local_positions_of_no_known_origin_are_none(ulog_of):
    rows = px4.local_rows()
    for row in rows[:5]:
        row.update(xy_global=False, ref_lat=math.nan, ref_lon=math.nan)
    found = ulog_of(px4.combined(5), px4.topic("vehicle_local_position", 2, px4.LOCAL, rows))
    assert len(found.references[0]) == 15
    nowhere = ulog_of(
        px4.combined(5), px4.topic("vehicle_local_position", 2, px4.LOCAL, px4.local_rows(xy_global=False))
    )
    assert nowhere.references == ()


@pytest.mark.parametrize("pitch", [-1.2, 0.0, 0.7])
def test_heading_goes_through_north_without_a_turn(ulog_of, pitch):
    angles = [(math.radians(300 + 13 * i), 0.5, pitch) for i in range(20)]
    rows = [{"timestamp": px4.START + 50_000 + 100_000 * i, "lat": 47.3, "lon": 8.5, "alt": 450.0} for i in range(19)]
    found = ulog_of(px4.topic("vehicle_global_position", 1, px4.GLOBAL, rows), attitude(angles))
    told = found.references[0].attitude
    np.testing.assert_allclose(told[:, :2], [[0.5, pitch]] * 19, atol=1e-5)
    apart = told[:, 2] - np.radians(300 + 13 * (np.arange(19) + 0.5))
    assert np.abs((apart + np.pi) % (2 * np.pi) - np.pi).max() < 1e-5


def test_an_attitude_that_is_no_number_costs_its_own_rows_only(ulog_of):
    angles = [(0.1, 0, 0)] * 20
    angles[4] = (math.nan, 0, 0)
    found = ulog_of(px4.topic("vehicle_local_position", 2, px4.LOCAL, px4.local_rows()), attitude(angles))
    assert len(found.references[0]) >= 17


def test_a_local_position_states_the_sigmas_of_its_velocity(ulog_of):
    text = px4.LOCAL + "float evh;float evv;"
    rows = px4.local_rows(20, evh=0.25, evv=0.5)
    (reference,) = ulog_of(px4.topic("vehicle_local_position", 1, text, rows)).references
    assert reference.velocity_sigma.tolist() == [[0.25, 0.25, 0.5]] * 20
