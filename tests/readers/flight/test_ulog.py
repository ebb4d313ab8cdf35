"""PX4's logs: IMUs, raw samples of buffers, increments, and files that are cut or damaged."""

import gzip
import math
import time

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.readers import read, reader_of
from tests.readers.flight import ulog_writer as px4

MICRO, SECOND = 1000, 10**9
FILES = ("pyulog_sample.ulg", "pyulog_sample_appended_multiple.ulg", "pyulog_sample_log_small.ulg", "roboto_test.ulg")


def test_combined_gyro_and_accelerometer_have_their_own_clocks(ulog_of):
    imu = ulog_of(px4.combined(50)).imu()
    assert imu.angular_rate.time.tolist() == [(px4.START + 5000 * i) * MICRO for i in range(50)]
    assert imu.specific_force.time.tolist() == [(px4.START + 5000 * i + 2000) * MICRO for i in range(50)]
    np.testing.assert_allclose(imu.specific_force.value[:, 1], np.arange(50) / 100, rtol=1e-6)


def test_accelerometer_rows_without_a_time_of_their_own_are_none(ulog_of):
    rows = [
        {"timestamp": px4.START + 5000 * i, "accelerometer_timestamp_relative": -1000 if i % 3 else 2**31 - 1,
         "accelerometer_m_s2": (i, 0, 0)} for i in range(12)
    ]  # fmt: skip
    imu = ulog_of(px4.topic("sensor_combined", 1, px4.COMBINED, rows)).imu()
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


def test_single_sensors_of_one_number_are_one_imu_with_two_clocks(ulog_of):
    parts = [sensor("sensor_accel", 10 + i, i, 20, 5000) for i in range(2)]
    parts += [sensor("sensor_gyro", 20 + i, i, 40, 2500, first=300) for i in range(2)]
    found = ulog_of(*parts)
    assert [imu.name for imu in found.imus] == ["sensor_accel.0+sensor_gyro.0", "sensor_accel.1+sensor_gyro.1"]
    imu = found.imus[1]
    assert imu.angular_rate.time.tolist() == [(px4.START + 2500 * i + 300) * MICRO for i in range(40)]
    assert imu.specific_force.time.tolist() == [(px4.START + 5000 * i) * MICRO for i in range(20)]
    assert imu.angular_rate.value[:, :2].tolist() == [[i, 1] for i in range(40)]
    assert imu.temperature.value.tolist() == [41] * 20


def test_a_lone_gyro_is_an_imu_without_an_accelerometer(ulog_of):
    (imu,) = ulog_of(sensor("sensor_gyro", 1, 0, 10, 5000)).imus
    assert imu.name == "sensor_gyro"
    assert imu.specific_force is None


def test_the_imu_that_was_sampled_most_comes_first(ulog_of):
    few = [sensor(f"sensor_{kind}", number, 0, 5, 10_000) for kind, number in (("gyro", 5), ("accel", 6))]
    found = ulog_of(*few, px4.combined(50))
    assert [imu.name for imu in found.imus] == ["sensor_combined", "sensor_accel+sensor_gyro"]


@pytest.mark.parametrize(("kind", "quantity"), [("gyro", "angular_rate"), ("accel", "specific_force")])
def test_buffers_are_unrolled_the_last_sample_has_the_stamp(ulog_of, kind, quantity):
    rows = [
        {"timestamp": px4.START + 5000 * i + 900, "timestamp_sample": px4.START + 5000 * i, "dt": 625.0, "scale": 0.25,
         "samples": 8, "x": [8 * i + j for j in range(8)], "y": [-32768] * 8, "z": [32767] * 8} for i in range(10)
    ]  # fmt: skip
    (imu,) = ulog_of(px4.topic(f"sensor_{kind}_fifo", 1, px4.FIFO, rows)).imus
    triad = getattr(imu, quantity)
    assert triad.value[:, 0].tolist() == [k / 4 for k in range(80)]
    assert triad.value[0].tolist() == [0, -8192, 32767 / 4]
    last = px4.START + 45_000
    assert triad.time.tolist() == [(last - 625 * (79 - k)) * MICRO for k in range(80)]


def test_a_buffer_that_is_not_full_gives_what_it_holds(ulog_of):
    rows = [
        {"timestamp_sample": px4.START + 5000 * i, "dt": 1000.0, "scale": 1.0, "samples": n, "x": [i] * 32}
        for i, n in enumerate((3, 0, 5, 255))
    ]
    triad = ulog_of(px4.topic("sensor_gyro_fifo", 1, px4.FIFO, rows)).imu().angular_rate
    times = [px4.START + 5000 * i - 1000 * j for i, n in ((0, 3), (2, 5)) for j in range(n)]
    crowded = [
        (px4.START + 15_000) * MICRO - 156_250 * j for j in range(32)
    ]  # no sample is before those of the last buffer
    assert triad.time.tolist() == sorted([*(t * MICRO for t in times), *crowded])


def test_increments_become_rates_whatever_their_spans_unit(ulog_of):
    text = "uint64_t timestamp;float[3] delta_angle;float[3] delta_velocity;{0} delta_angle_dt;{0} delta_velocity_dt;"
    for kind, span in (("uint32_t", 5000), ("uint16_t", 5000), ("float", 0.005)):
        rows = [
            {"timestamp": px4.START + 5000 * i, "delta_angle": (0.005, 0, 0), "delta_velocity": (0, 0, -0.049),
             "delta_angle_dt": span, "delta_velocity_dt": span if i else 0} for i in range(10)
        ]  # fmt: skip
        imu = ulog_of(px4.topic("vehicle_imu", 1, text.format(kind), rows)).imu()
        np.testing.assert_allclose(imu.angular_rate.value, [[1, 0, 0]] * 10, rtol=1e-6)
        np.testing.assert_allclose(imu.specific_force.value, [[0, 0, -9.8]] * 9, rtol=1e-6)


def test_a_packed_log_equals_the_plain_one(ulog_of, fresh):
    plain, path = ulog_of(whole=px4.flight()), fresh("log.ulg.gz")
    path.write_bytes(gzip.compress(px4.flight()))
    packed = read(path)
    np.testing.assert_array_equal(packed.imu().angular_rate.value, plain.imu().angular_rate.value)
    np.testing.assert_array_equal(packed.references[0].position, plain.references[0].position)
    assert packed.notes == plain.notes


def test_data_behind_an_end_that_is_cut_is_used(ulog_of):
    first, second = px4.combined(50), px4.combined(50, first=50)[len(px4.combined(0)) :]
    offset = len(px4.HEADER + px4.flags() + first) - 20
    found = ulog_of(whole=(px4.HEADER + px4.flags(offset) + first)[:offset] + second)
    assert len(found.imu().angular_rate) == 99
    assert any(
        note.id == "no_message" and note.startswith(f"{len(px4.data(1, px4.COMBINED)) - 20} ") for note in found.notes
    )


def test_messages_of_an_unknown_type_do_no_harm(ulog_of):
    text = "uint64_t timestamp;float[3] gyro_rad;mystery more;"
    body = px4.data(1, "uint64_t timestamp;float[3] gyro_rad;uint8_t[9] more;", timestamp=5, gyro_rad=(1, 2, 3))
    found = ulog_of(px4.defined("sensor_combined", text), px4.added("sensor_combined", 1), body, px4.combined(0, 9))
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
def test_a_field_of_another_shape_does_not_stop_the_reading(ulog_of, name, text, field, other):
    other = text.replace(field, other, 1)  # one bit makes 2 of 3
    rows = [{**{key: 1 for _, _, key in px4.fields(text)}, "timestamp": px4.START + 5000 * i} for i in range(4)]
    sound = sensor("sensor_accel" if name != "sensor_accel" else "sensor_gyro", 30, 3, 20, 5000)
    solution = (
        px4.topic("vehicle_local_position", 31, px4.LOCAL, px4.local_rows()) if name == "vehicle_attitude" else b""
    )
    found = ulog_of(sound, solution, px4.topic(name, 9, other, rows))
    assert 20 in [len(triad) for imu in found.imus for triad in (imu.angular_rate, imu.specific_force) if triad]


@pytest.mark.parametrize(
    ("name", "text", "field", "value"),
    [
        ("sensor_gyro_fifo", px4.FIFO, "dt", math.nan), ("sensor_gyro_fifo", px4.FIFO, "dt", math.inf),
        ("sensor_gyro_fifo", px4.FIFO, "dt", 1e38), ("vehicle_local_position", px4.LOCAL, "ref_lat", math.inf),
    ],
)  # fmt: skip
def test_a_number_that_cannot_be_costs_its_message(ulog_of, name, text, field, value):
    rows = [
        {**{key: 1 for _, _, key in px4.fields(text)}, "timestamp_sample": px4.START + 100_000 * i} for i in range(9)
    ]
    rows[4][field] = value
    found = ulog_of(px4.topic(name, 9, text, rows))
    assert max([len(imu.angular_rate) for imu in found.imus] + [len(one) for one in found.references]) == 8
