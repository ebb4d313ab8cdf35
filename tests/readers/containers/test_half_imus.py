"""Messages of an IMU with one sensor only give one sensor; the other half is named as none."""

import numpy as np
import pytest

from imuwb.notes import ids
from imuwb.readers import read
from tests.readers.repairs import repairs

T = 1_714_564_800 * 10**9
COUNT = 60


@pytest.fixture(scope="module")
def half(ros):
    """Return a function that gives a message with a rate or a force, the other 0, and covariances that begin with some numbers."""

    def message(stamp, rate=(0, 0, 0), force=(0, 0, 0), rate_covariance=0.0, force_covariance=0.0):
        head = [
            ("i", stamp // 10**9),
            ("I", stamp % 10**9),
            ("str", "imu"),
            ("d", (0, 0, 0, 1)),
            ("d", (-1.0,) + (0.0,) * 8),
        ]
        rest = (0.0,) * 8
        return ros.encode([
            *head, ("d", rate), ("d", (rate_covariance, *rest)), ("d", force), ("d", (force_covariance, *rest)),
        ])  # fmt: skip

    return message


def stamps(step, shift=0):
    return [T + shift + i * step for i in range(COUNT)]


@pytest.mark.parametrize("covariance", [0.0, 0.01, -1.0])
@pytest.mark.parametrize("chunk_size", [500, 1 << 20])
def test_a_gyroscope_and_an_accelerometer_of_two_topics_are_halves(mcap, half, covariance, chunk_size):
    gyro = [
        (t, half(t, rate=(0.1, 0.2, i / 100), force_covariance=covariance)) for i, t in enumerate(stamps(5 * 10**6))
    ]
    accel = [(t, half(t, force=(0.5, -0.25, 9.75), rate_covariance=covariance)) for t in stamps(16 * 10**6)]
    log = read(mcap.write(mcap.Topic(gyro, "/gyro/imu"), mcap.Topic(accel, "/accel/imu"), chunk_size=chunk_size))
    triads = {name: triad for imu in log.imus for name, triad in imu.sensors().items()}
    assert len(triads) == 2
    rate, force = sorted(triads.values(), key=lambda triad: float(np.abs(triad.value).max()))
    assert rate.time.tolist() == stamps(5 * 10**6)
    assert rate.value[:, 2].tolist() == [-i / 100 for i in range(COUNT)]
    assert force.time.tolist() == stamps(16 * 10**6)
    assert force.value.tolist() == [[0.5, 0.25, -9.75]] * COUNT
    told = [note for note in log.notes if note.id == "no_sensor"]
    assert ["gyroscope" in note for note in told] == [False, True]
    assert all(str(COUNT) in note for note in told)


def test_halves_that_take_turns_on_one_topic_keep_their_own_times(mcap, half):
    gyro = [(t, half(t, rate=(0.1, 0.2, 0.3), force_covariance=-1.0)) for t in stamps(5 * 10**6)]
    accel = [(t, half(t, force=(0.5, 0, 9.75), rate_covariance=-1.0)) for t in stamps(16 * 10**6, 10**6)]
    (imu,) = read(mcap.write(mcap.Topic(sorted(gyro + accel)))).imus
    assert imu.angular_rate.time.tolist() == stamps(5 * 10**6)
    assert imu.specific_force.time.tolist() == stamps(16 * 10**6, 10**6)
    assert imu.origin.repairs == ()


@pytest.mark.parametrize("first", [1, 30, 59])
def test_a_sensor_that_is_zero_at_first_is_a_sensor(mcap, half, first):
    def rate(i):
        return (0, 0, 0) if i < first else (0.1, 0.2, 0.3)

    rows = [(t, half(t, rate=rate(i), force=(0, 0, 9.8))) for i, t in enumerate(stamps(10**7))]
    log = read(mcap.write(mcap.Topic(rows), chunk_size=2000))
    (imu,) = log.imus
    assert imu.angular_rate.time.tolist() == imu.specific_force.time.tolist() == stamps(10**7)
    assert imu.angular_rate.value[:, 0].tolist() == [0.0] * first + [0.1] * (COUNT - first)
    assert log.notes == ()


@pytest.mark.parametrize(("count", "sensor"), [(19, True), (20, False)])
def test_few_zeros_are_taken_as_measured(mcap, half, count, sensor):
    log = read(mcap.write(mcap.Topic([(t, half(t, force=(0, 0, 9.8))) for t in stamps(10**7)[:count]])))
    assert (log.imu().angular_rate is not None) == sensor
    assert ids(log.notes) == (() if sensor else ("no_sensor",))


def test_a_value_that_is_no_number_is_still_counted(mcap, half):
    rows = [
        (t, half(t, rate=(float("nan") if i == 5 else 0.1, 0, 0), force_covariance=-1.0))
        for i, t in enumerate(stamps(10**7))
    ]
    (imu,) = read(mcap.write(mcap.Topic(rows))).imus
    assert len(imu.angular_rate) == COUNT - 1
    assert repairs(imu) == {"not_finite": 1}


def test_a_message_that_lacks_a_sensor_among_whole_ones_is_left_out(mcap, half):
    rows = [(t, half(t, (0.1, 0, 0), (0, 0, 9.8), -1.0 if i == 30 else 0.0)) for i, t in enumerate(stamps(10**7))]
    (imu,) = read(mcap.write(mcap.Topic(rows), chunk_size=2000)).imus
    assert len(imu.angular_rate) == len(imu.specific_force) == COUNT - 1
    assert repairs(imu) == {"not_finite": 1}


def test_a_message_of_ones_own_may_have_one_sensor_only(mcap, ros):
    header = "std_msgs/Header header\ngeometry_msgs/Vector3 {}\n" + ros.imu_2[ros.imu_2.index("=====") :]
    rows = [
        (t, ros.encode([("i", t // 10**9), ("I", t % 10**9), ("str", "fog"), ("d", (0.0, 0.0, 0.25))]))
        for t in stamps(10**7)
    ]
    gyro = mcap.Topic(rows, "/fog", "my_msgs/msg/Rate", header.format("angular_velocity"))
    other = mcap.Topic(rows, "/setpoint", "my_msgs/msg/Target", header.format("angular_velocity"))
    (imu,) = read(mcap.write(gyro, other)).imus
    assert (imu.name, imu.specific_force) == ("/fog", None)
    assert imu.angular_rate.value.tolist() == [[0, 0, -0.25]] * COUNT
