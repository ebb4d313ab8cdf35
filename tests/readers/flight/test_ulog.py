"""PX4's logs: every IMU and receiver as pyulog reads them, raw samples unrolled, the solution, in UTC."""

import gzip
import math
import re
import time

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import read, reader_of
from tests.readers.flight import ulog_writer as px4

MICRO, SECOND = 1000, 10**9
FILES = ("pyulog_sample.ulg", "pyulog_sample_appended_multiple.ulg", "pyulog_sample_log_small.ulg", "roboto_test.ulg")


@pytest.fixture(scope="module")
def written(fresh):
    """Return a function that reads a log of these messages."""

    def read_back(*messages, whole=None):
        path = fresh("log.ulg")
        path.write_bytes(whole or px4.HEADER + px4.flags() + b"".join(messages))
        return read(path)

    return read_back


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


# Real logs


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


# Logs of our own: IMUs


def test_combined_gyro_and_accelerometer_have_their_own_clocks(written):
    imu = written(px4.combined(50)).imu()
    assert imu.angular_rate.time.tolist() == [(px4.START + 5000 * i) * MICRO for i in range(50)]
    assert imu.specific_force.time.tolist() == [(px4.START + 5000 * i + 2000) * MICRO for i in range(50)]
    np.testing.assert_allclose(imu.specific_force.value[:, 1], np.arange(50) / 100, rtol=1e-6)


def test_accelerometer_rows_without_a_time_of_their_own_are_none(written):
    rows = [
        {"timestamp": px4.START + 5000 * i, "accelerometer_timestamp_relative": -1000 if i % 3 else 2**31 - 1,
         "accelerometer_m_s2": (i, 0, 0)} for i in range(12)
    ]  # fmt: skip
    imu = written(px4.topic("sensor_combined", 1, px4.COMBINED, rows)).imu()
    kept = [i for i in range(12) if i % 3]
    assert len(imu.angular_rate) == 12
    assert imu.specific_force.value[:, 0].tolist() == kept
    assert imu.specific_force.time.tolist() == [(px4.START + 5000 * i - 1000) * MICRO for i in kept]


def sensor(kind, number, instance, count, step, first=0):
    rows = [
        {"timestamp": px4.START + step * i + 77, "timestamp_sample": px4.START + step * i + first,
         "x": i, "y": instance, "temperature": 40 + instance} for i in range(count)
    ]  # fmt: skip
    return px4.topic(kind, number, px4.GYRO, rows, instance)


def test_single_sensors_of_one_number_are_one_imu_with_two_clocks(written):
    parts = [sensor("sensor_accel", 10 + i, i, 20, 5000) for i in range(2)]
    parts += [sensor("sensor_gyro", 20 + i, i, 40, 2500, first=300) for i in range(2)]
    found = written(*parts)
    assert [imu.name for imu in found.imus] == ["sensor_accel.0+sensor_gyro.0", "sensor_accel.1+sensor_gyro.1"]
    imu = found.imus[1]
    assert imu.angular_rate.time.tolist() == [(px4.START + 2500 * i + 300) * MICRO for i in range(40)]
    assert imu.specific_force.time.tolist() == [(px4.START + 5000 * i) * MICRO for i in range(20)]
    assert imu.angular_rate.value[:, :2].tolist() == [[i, 1] for i in range(40)]
    assert imu.temperature.value.tolist() == [41] * 20


def test_a_lone_gyro_is_an_imu_without_an_accelerometer(written):
    (imu,) = written(sensor("sensor_gyro", 1, 0, 10, 5000)).imus
    assert imu.name == "sensor_gyro"
    assert imu.specific_force is None


def test_the_imu_that_was_sampled_most_comes_first(written):
    few = [sensor(f"sensor_{kind}", number, 0, 5, 10_000) for kind, number in (("gyro", 5), ("accel", 6))]
    found = written(*few, px4.combined(50))
    assert [imu.name for imu in found.imus] == ["sensor_combined", "sensor_accel+sensor_gyro"]


@pytest.mark.parametrize(("kind", "quantity"), [("gyro", "angular_rate"), ("accel", "specific_force")])
def test_buffers_are_unrolled_the_last_sample_has_the_stamp(written, kind, quantity):
    rows = [
        {"timestamp": px4.START + 5000 * i + 900, "timestamp_sample": px4.START + 5000 * i, "dt": 625.0, "scale": 0.25,
         "samples": 8, "x": [8 * i + j for j in range(8)], "y": [-32768] * 8, "z": [32767] * 8} for i in range(10)
    ]  # fmt: skip
    (imu,) = written(px4.topic(f"sensor_{kind}_fifo", 1, px4.FIFO, rows)).imus
    triad = getattr(imu, quantity)
    assert triad.value[:, 0].tolist() == [k / 4 for k in range(80)]
    assert triad.value[0].tolist() == [0, -8192, 32767 / 4]
    last = px4.START + 45_000
    assert triad.time.tolist() == [(last - 625 * (79 - k)) * MICRO for k in range(80)]


def test_a_buffer_that_is_not_full_gives_what_it_holds(written):
    rows = [
        {"timestamp_sample": px4.START + 5000 * i, "dt": 1000.0, "scale": 1.0, "samples": n, "x": [i] * 32}
        for i, n in enumerate((3, 0, 5, 255))
    ]
    triad = written(px4.topic("sensor_gyro_fifo", 1, px4.FIFO, rows)).imu().angular_rate
    times = [px4.START + 5000 * i - 1000 * j for i, n in ((0, 3), (2, 5), (3, 32)) for j in range(n)]
    assert triad.time.tolist() == sorted({t * MICRO for t in times})


def test_increments_become_rates_whatever_their_spans_unit(written):
    text = "uint64_t timestamp;float[3] delta_angle;float[3] delta_velocity;{0} delta_angle_dt;{0} delta_velocity_dt;"
    for kind, span in (("uint32_t", 5000), ("uint16_t", 5000), ("float", 0.005)):
        rows = [
            {"timestamp": px4.START + 5000 * i, "delta_angle": (0.005, 0, 0), "delta_velocity": (0, 0, -0.049),
             "delta_angle_dt": span, "delta_velocity_dt": span if i else 0} for i in range(10)
        ]  # fmt: skip
        imu = written(px4.topic("vehicle_imu", 1, text.format(kind), rows)).imu()
        np.testing.assert_allclose(imu.angular_rate.value, [[1, 0, 0]] * 10, rtol=1e-6)
        np.testing.assert_allclose(imu.specific_force.value, [[0, 0, -9.8]] * 9, rtol=1e-6)


# Receivers and the clock


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize("topic", ["sensor_gps", "vehicle_gps_position"])
def test_fixes_in_degrees_and_in_integers_are_read(written, topic, degrees):
    rows = px4.fixes(5)
    if degrees:
        rows = [
            {**row, "latitude_deg": row["lat"] * 1e-7, "longitude_deg": row["lon"] * 1e-7, "altitude_msl_m": 400.0,
             "altitude_ellipsoid_m": 447.5} for row in rows
        ]  # fmt: skip
    found = written(px4.topic(topic, 1, px4.GPS_DEG if degrees else px4.GPS, rows))
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


def test_times_since_power_up_become_utc_by_the_median_fix(written):
    rows = px4.fixes(9)
    rows[0]["time_utc_usec"] = 0
    rows[3]["time_utc_usec"] += 10**9
    found = written(px4.combined(10), px4.topic("sensor_gps", 2, px4.GPS, rows))
    assert found.imu().angular_rate.time[0] == (px4.UTC + px4.START) * MICRO
    assert found.gnss[0].time[0] == found.imu().angular_rate.time[0]
    assert "utc_by_receiver" in ids(found.notes)


def test_without_a_date_times_count_from_power_up(written):
    found = written(px4.combined(10), px4.topic("sensor_gps", 2, px4.GPS, px4.fixes(5, time_utc_usec=0)))
    assert found.imu().angular_rate.time[0] == px4.START * MICRO
    assert found.imu().origin.epoch == found.gnss[0].origin.epoch == "boot"
    assert "no_date" in ids(found.notes)


def test_velocities_and_accuracies_that_are_not_valid_are_unknown(written):
    rows = px4.fixes(4)
    rows[1].update(vel_ned_valid=False, eph=0.0)
    rows[2].update(epv=0.0, s_variance_m_s=0.0)
    (gnss,) = written(px4.topic("sensor_gps", 1, px4.GPS, rows)).gnss
    assert np.isnan(gnss.velocity).tolist() == [[False] * 3, [True] * 3, [False] * 3, [False] * 3]
    nan = [[False] * 3, [True, True, False], [False, False, True], [False] * 3]
    assert np.isnan(gnss.position_sigma).tolist() == nan
    assert np.isnan(gnss.velocity_sigma[:, 0]).tolist() == [False, False, True, False]


def test_rows_without_a_fix_are_counted(written):
    rows = px4.fixes(7)
    for row in rows[:3]:
        row.update(lat=0, lon=0, fix_type=0)
    (gnss,) = written(px4.topic("sensor_gps", 1, px4.GPS, rows)).gnss
    assert len(gnss) == 4
    assert [(r.what.id, r.count) for r in gnss.origin.repairs] == [("no_position", 3)]


def test_a_receiver_that_never_had_a_fix_is_noted(written):
    found = written(px4.combined(5), px4.topic("sensor_gps", 2, px4.GPS, px4.fixes(3, lat=0, lon=0)))
    assert found.gnss == ()
    assert "no_position" in ids(found.notes)


# The solution


def turned(heading, roll=0.0, pitch=0.0):
    """Return the quaternion, body to NED, of a turn about z, then y, then x."""
    a, b, c = roll / 2, pitch / 2, heading / 2
    product = np.array([math.cos(c), 0, 0, math.sin(c)])
    for turn in ([math.cos(b), 0, math.sin(b), 0], [math.cos(a), math.sin(a), 0, 0]):
        (w, *v), (s, *u) = product, turn
        v, u = np.array(v), np.array(u)
        product = np.array([w * s - v @ u, *(w * u + s * v + np.cross(v, u))])
    return product.tolist()


def local(count=20, **changes):
    return [
        {"timestamp": px4.START + 100_000 * i, "timestamp_sample": px4.START + 100_000 * i, "ref_lat": 47.3,
         "ref_lon": 8.5, "ref_alt": 450.0, "x": 10.0 * i, "y": -20.0, "z": -3.0, "vx": 100.0, "vy": i, "vz": -1.0,
         "xy_global": True, **changes} for i in range(count)
    ]  # fmt: skip


def attitude(angles):
    rows = [{"timestamp": px4.START + 100_000 * i, "q": turned(*one)} for i, one in enumerate(angles)]
    return px4.topic("vehicle_attitude", 31, px4.ATTITUDE, rows)


def test_the_reference_is_the_global_position_with_velocity_and_attitude(written):
    rows = [{"timestamp": px4.START + 50_000 + 100_000 * i, "lat": 47.3 + i * 1e-6, "lon": 8.5, "alt": 450.0}
            for i in range(10)]  # fmt: skip
    found = written(
        px4.topic("vehicle_global_position", 1, px4.GLOBAL, rows),
        px4.topic("vehicle_local_position", 2, px4.LOCAL, local()),
        attitude([(0.1 * i, 0.3, -0.2) for i in range(20)]),
    )
    (reference,) = found.references
    assert reference.name == "vehicle_global_position"
    np.testing.assert_allclose(np.degrees(reference.position[:, 0]), 47.3 + np.arange(10) * 1e-6, rtol=1e-13)
    np.testing.assert_allclose(reference.velocity, [[100, i + 0.5, -1] for i in range(10)])
    np.testing.assert_allclose(reference.attitude, [[0.3, -0.2, 0.1 * (i + 0.5)] for i in range(10)], atol=1e-6)


def test_the_reference_is_the_local_position_where_there_is_no_global_one(written):
    (reference,) = written(px4.topic("vehicle_local_position", 2, px4.LOCAL, local())).references
    assert reference.name == "vehicle_local_position"
    assert reference.attitude is None
    # A degree of latitude at 47.3 deg is 111 174 m long, one of longitude 75 633 m (WGS 84).
    np.testing.assert_allclose(
        np.degrees(reference.position[:, 0]) - 47.3, np.arange(20) * 10 / 111_174, rtol=1e-3, atol=1e-8
    )
    np.testing.assert_allclose(np.degrees(reference.position[:, 1]) - 8.5, -20 / 75_633, rtol=1e-3)
    np.testing.assert_allclose(reference.position[:, 2], 453, atol=0.01)
    np.testing.assert_allclose(reference.velocity[:, 1], np.arange(20))


def test_local_positions_of_no_known_origin_are_none(written):
    rows = local()
    for row in rows[:5]:
        row.update(xy_global=False, ref_lat=math.nan, ref_lon=math.nan)
    found = written(px4.combined(5), px4.topic("vehicle_local_position", 2, px4.LOCAL, rows))
    assert len(found.references[0]) == 15
    nowhere = written(px4.combined(5), px4.topic("vehicle_local_position", 2, px4.LOCAL, local(xy_global=False)))
    assert nowhere.references == ()


@pytest.mark.parametrize("pitch", [-1.2, 0.0, 0.7])
def test_heading_goes_through_north_without_a_turn(written, pitch):
    angles = [(math.radians(300 + 13 * i), 0.5, pitch) for i in range(20)]
    rows = [{"timestamp": px4.START + 50_000 + 100_000 * i, "lat": 47.3, "lon": 8.5, "alt": 450.0} for i in range(19)]
    found = written(px4.topic("vehicle_global_position", 1, px4.GLOBAL, rows), attitude(angles))
    told = found.references[0].attitude
    np.testing.assert_allclose(told[:, :2], [[0.5, pitch]] * 19, atol=1e-5)
    apart = told[:, 2] - np.radians(300 + 13 * (np.arange(19) + 0.5))
    assert np.abs((apart + np.pi) % (2 * np.pi) - np.pi).max() < 1e-5


def test_an_attitude_that_is_no_number_costs_its_own_rows_only(written):
    angles = [(0.1, 0, 0)] * 20
    angles[4] = (math.nan, 0, 0)
    found = written(px4.topic("vehicle_local_position", 2, px4.LOCAL, local()), attitude(angles))
    assert len(found.references[0]) >= 17


# Files


def test_a_packed_log_equals_the_plain_one(written, fresh):
    plain, path = written(whole=px4.flight()), fresh("log.ulg.gz")
    path.write_bytes(gzip.compress(px4.flight()))
    packed = read(path)
    np.testing.assert_array_equal(packed.imu().angular_rate.value, plain.imu().angular_rate.value)
    np.testing.assert_array_equal(packed.references[0].position, plain.references[0].position)
    assert packed.notes == plain.notes


def test_data_behind_an_end_that_is_cut_is_used(written):
    first, second = px4.combined(50), px4.combined(50, first=50)[len(px4.combined(0)) :]
    offset = len(px4.HEADER + px4.flags() + first) - 20
    found = written(whole=(px4.HEADER + px4.flags(offset) + first)[:offset] + second)
    assert len(found.imu().angular_rate) == 99
    assert any(
        note.id == "no_message" and note.startswith(f"{len(px4.data(1, px4.COMBINED)) - 20} ") for note in found.notes
    )


def test_messages_of_an_unknown_type_do_no_harm(written):
    text = "uint64_t timestamp;float[3] gyro_rad;mystery more;"
    body = px4.data(1, "uint64_t timestamp;float[3] gyro_rad;uint8_t[9] more;", timestamp=5, gyro_rad=(1, 2, 3))
    found = written(px4.defined("sensor_combined", text), px4.added("sensor_combined", 1), body, px4.combined(0, 9))
    assert found.imu().angular_rate.value.tolist() == [[1, 2, 3]]


@pytest.mark.parametrize(
    "data",
    [
        px4.MAGIC,
        px4.HEADER,
        px4.HEADER + b"\xff" * 100,
        px4.HEADER + px4.defined("sensor_combined", "uint64_t timestamp;"),
    ],
)
def test_a_log_without_a_message_is_refused(fresh, data):
    path = fresh("log.ulg")
    path.write_bytes(data)
    assert reader_of(path).format == "ulog"
    with pytest.raises(UnreadableLogError, match="no whole message"):
        read(path)


def test_flipped_bits_never_raise_anything_else(fresh):
    data, rng, read_well = px4.flight(), np.random.default_rng(13), 0
    path = fresh("log.ulg")
    for i in range(60):
        damaged = np.frombuffer(data, np.uint8).copy()
        end = 1200 if i % 2 else damaged.size  # the definitions stand in front
        damaged[rng.integers(8, end, 20)] ^= (1 << rng.integers(0, 8, 20)).astype(np.uint8)
        path.write_bytes(damaged.tobytes())
        began = time.perf_counter()
        try:
            found = read(path)
        except (UnreadableLogError, UsageError):
            continue
        finally:
            assert time.perf_counter() - began < 5
        read_well += bool(found.imus or found.gnss)
    assert read_well > 30


INCREMENTS = "uint64_t timestamp;float[3] delta_angle;float[3] delta_velocity;uint32_t delta_angle_dt;uint32_t delta_velocity_dt;"
MISSHAPEN = [
    ("sensor_combined", px4.COMBINED, "float[3] gyro_rad", "float[2] gyro_rad"),
    ("sensor_combined", px4.COMBINED, "float[3] accelerometer_m_s2", "float accelerometer_m_s2"),
    ("sensor_combined", px4.COMBINED, "uint64_t timestamp", "uint64_t[2] timestamp"),
    ("sensor_combined", px4.COMBINED, "int32_t accelerometer_timestamp_relative",
     "int32_t[2] accelerometer_timestamp_relative"),
    ("sensor_gyro", px4.GYRO, "float x", "float[2] x"),
    ("sensor_gyro", px4.GYRO, "uint64_t timestamp_sample", "uint64_t[2] timestamp_sample"),
    ("sensor_accel", px4.ACCEL, "float temperature", "float[2] temperature"),
    ("sensor_gyro_fifo", px4.FIFO, "int16_t[32] x", "int16_t[16] x"),
    ("sensor_gyro_fifo", px4.FIFO, "uint8_t samples", "uint8_t[2] samples"),
    ("vehicle_imu", INCREMENTS, "float[3] delta_angle", "float[4] delta_angle"),
    ("vehicle_imu", INCREMENTS, "uint32_t delta_angle_dt", "uint32_t[2] delta_angle_dt"),
    ("sensor_gps", px4.GPS, "int32_t lat", "int32_t[2] lat"),
    ("sensor_gps", px4.GPS, "float eph", "float[2] eph"),
    ("sensor_gps", px4.GPS, "uint8_t fix_type", "uint8_t[2] fix_type"),
    ("vehicle_local_position", px4.LOCAL, "float vx", "float[2] vx"),
    ("vehicle_global_position", px4.GLOBAL, "float alt", "float[2] alt"),
    ("vehicle_attitude", px4.ATTITUDE, "float[4] q", "float[3] q"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "text", "field", "other"), MISSHAPEN, ids=[f"{x[0]}-{x[3]}" for x in MISSHAPEN])
def test_a_field_of_another_shape_does_not_stop_the_reading(written, name, text, field, other):
    other = text.replace(field, other, 1)  # one bit makes 2 of 3
    rows = [{**{key: 1 for _, _, key in px4.fields(text)}, "timestamp": px4.START + 5000 * i} for i in range(4)]
    sound = sensor("sensor_accel" if name != "sensor_accel" else "sensor_gyro", 30, 3, 20, 5000)
    solution = px4.topic("vehicle_local_position", 31, px4.LOCAL, local()) if name == "vehicle_attitude" else b""
    found = written(sound, solution, px4.topic(name, 9, other, rows))
    assert 20 in [len(triad) for imu in found.imus for triad in (imu.angular_rate, imu.specific_force) if triad]


@pytest.mark.parametrize(
    ("name", "text", "field", "value"),
    [
        ("sensor_gyro_fifo", px4.FIFO, "dt", math.nan), ("sensor_gyro_fifo", px4.FIFO, "dt", math.inf),
        ("sensor_gyro_fifo", px4.FIFO, "dt", 1e38), ("vehicle_local_position", px4.LOCAL, "ref_lat", math.inf),
    ],
)  # fmt: skip
def test_a_number_that_cannot_be_costs_its_message(written, name, text, field, value):
    rows = [
        {**{key: 1 for _, _, key in px4.fields(text)}, "timestamp_sample": px4.START + 100_000 * i} for i in range(9)
    ]
    rows[4][field] = value
    found = written(px4.topic(name, 9, text, rows))
    assert max([len(imu.angular_rate) for imu in found.imus] + [len(one) for one in found.references]) == 8
