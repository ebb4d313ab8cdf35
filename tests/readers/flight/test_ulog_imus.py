"""PX4's IMUs: which gyro belongs to which accelerometer, buffers whose stamps jitter, means over part of the time."""

import numpy as np
import pytest

from imuwb.notes import ids
from tests.readers.flight import ulog_writer as px4
from tests.readers.repairs import repairs

MICRO = 1000
SELECTED = "uint64_t timestamp;uint32_t accel_device_id;uint32_t gyro_device_id;"
INCREMENTS = "uint64_t timestamp;float[3] delta_angle;float[3] delta_velocity;uint32_t delta_angle_dt;uint32_t delta_velocity_dt;"


def sensor(kind, number, instance, device, count=20, **values):
    """Return a single sensor at 200 Hz, whose value about x is its device's number."""
    rows = [
        {"timestamp": px4.START + 5000 * i + 700, "timestamp_sample": px4.START + 5000 * i, "device_id": device,
         "x": device, "temperature": 30.0 + device, **values} for i in range(count)
    ]  # fmt: skip
    return px4.topic(f"sensor_{kind}", number, px4.GYRO, rows, instance)


def buffers(stamps, samples=8, dt=125.0):
    """Return a gyro's buffers with these stamps (µs), whose samples count."""
    rows = [
        {"timestamp": stamp + 900, "timestamp_sample": stamp, "dt": dt, "scale": 1.0, "samples": samples,
         "x": [samples * i + j for j in range(samples)]} for i, stamp in enumerate(stamps)
    ]  # fmt: skip
    return px4.topic("sensor_gyro_fifo", 1, px4.FIFO, rows)


@pytest.mark.parametrize(
    ("gyros", "accels", "pairs"),
    [
        ((7, 9), (7, 9), [("accel.0", "gyro.0"), ("accel.1", "gyro.1")]),
        ((7, 9), (9, 7), [("accel.1", "gyro.0"), ("accel.0", "gyro.1")]),
        ((7, 9), (1, 7), [("accel.1", "gyro.0"), ("accel.0",), ("gyro.1",)]),
        ((1, 2), (3, 4), [("accel.0", "gyro.0"), ("accel.1", "gyro.1")]),  # two chips in one part: other numbers
        ((0, 0), (0, 0), [("accel.0", "gyro.0"), ("accel.1", "gyro.1")]),
    ],
)
def test_a_gyro_belongs_to_the_accelerometer_of_its_device(ulog_of, gyros, accels, pairs):
    found = ulog_of(
        *(sensor("gyro", 1 + i, i, device) for i, device in enumerate(gyros)),
        *(sensor("accel", 11 + i, i, device) for i, device in enumerate(accels)),
    )
    names = {"+".join(f"sensor_{part}" for part in pair) for pair in pairs}
    assert {imu.name for imu in found.imus} == names
    for imu in found.imus:
        if imu.angular_rate is not None and imu.specific_force is not None and (set(gyros) & set(accels) - {0}):
            assert imu.angular_rate.value[0, 0] == imu.specific_force.value[0, 0]


@pytest.mark.parametrize("seed", range(5))
def test_samples_of_buffers_with_jitter_keep_their_order_and_their_number(ulog_of, seed):
    stamps = (px4.START + 1000 * np.arange(200) + np.random.default_rng(seed).integers(-300, 300, 200)).tolist()
    (imu,) = ulog_of(buffers(stamps)).imus
    assert imu.angular_rate.value[:, 0].tolist() == list(range(1600))
    assert imu.angular_rate.time[7::8].tolist() == [stamp * MICRO for stamp in stamps]
    assert set(repairs(imu)) == {"fifo_crowded"}
    assert 0 < repairs(imu)["fifo_crowded"] < 1600


def test_a_lost_buffer_is_a_gap(ulog_of):
    stamps = [px4.START + 1000 * i for i in range(50) if i != 20]
    (imu,) = ulog_of(buffers(stamps)).imus
    assert np.unique(np.diff(imu.angular_rate.time)).tolist() == [125_000, 125_000 + 1_000_000]
    assert repairs(imu) == {}


@pytest.mark.parametrize(("step", "span", "noted"), [(4000, 4000, False), (5000, 4000, False), (100_000, 4000, True)])
def test_means_over_part_of_the_time_between_rows_are_noted(ulog_of, step, span, noted):
    text = px4.COMBINED
    rows = [
        {"timestamp": px4.START + step * i, "gyro_rad": (i, 0, 0), "gyro_integral_dt": span,
         "accelerometer_m_s2": (0, 0, -9.8)} for i in range(30)
    ]  # fmt: skip
    found = ulog_of(px4.topic("sensor_combined", 1, text, rows))
    assert ids(found.notes).count("partial_samples") == int(noted)
    if noted:
        assert "25 samples" in next(note for note in found.notes if note.id == "partial_samples")


def test_increments_over_part_of_the_time_are_noted(ulog_of):
    rows = [
        {"timestamp": px4.START + 500_000 * i, "delta_angle": (0.005, 0, 0), "delta_velocity": (0, 0, -0.049),
         "delta_angle_dt": 5000, "delta_velocity_dt": 5000} for i in range(10)
    ]  # fmt: skip
    found = ulog_of(px4.topic("vehicle_imu", 1, INCREMENTS, rows))
    assert found.imu().angular_rate.value[0, 0] == pytest.approx(1.0)
    assert ids(found.notes).count("partial_samples") == 1


def test_combined_sensors_have_the_temperature_of_the_sensor_they_are_taken_from(ulog_of):
    selection = px4.topic("sensor_selection", 9, SELECTED, [{"timestamp": px4.START, "accel_device_id": 5}])
    sensors = [sensor("accel", 2 + i, i, device) for i, device in enumerate((4, 5))]
    found = ulog_of(px4.combined(50), selection, *sensors)
    assert (found.imu().name, set(found.imu().temperature.value)) == ("sensor_combined", {35.0})
    assert "temperature_of_selected" in ids(found.notes)


@pytest.mark.parametrize("chosen", [(), (7,), (4, 5)])
def test_without_one_known_choice_they_have_none(ulog_of, chosen):
    rows = [{"timestamp": px4.START + i, "accel_device_id": device} for i, device in enumerate(chosen)]
    selection = [px4.topic("sensor_selection", 9, SELECTED, rows)] if rows else []
    sensors = [sensor("accel", 2 + i, i, device) for i, device in enumerate((4, 5))]
    found = ulog_of(px4.combined(50), *selection, *sensors)
    assert (found.imu().name, found.imu().temperature) == ("sensor_combined", None)
