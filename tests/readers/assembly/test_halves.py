"""A gyro and an accelerometer in two streams: joined where they are unambiguous, else proposed as ``--imu A+B``."""

import re

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import Provenance
from imuwb.navigation import Installation
from imuwb.navigation.measurement import measurement_of
from imuwb.notes import ids
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch
from imuwb.selection import select

T = 1_714_564_800 * 10**9


def half(name, quantity, count=200, start=0.0, rate=100.0):
    """Return a stream of one sensor, whose x counts."""
    time = T + np.rint((start + np.arange(count) / rate) * 1e9).astype(np.int64)
    return Batch(name, "imu", time, {quantity: np.stack([np.arange(count), np.zeros(count), np.ones(count)], axis=1)})


def log_of(*names, **starts):
    """Return the log of halves: gyros and accelerometers by their names, in turn if a name shows none."""
    batches = []
    for name in names:
        sensor, _, topic = name.partition(":")
        quantity = {"g": "angular_rate", "a": "specific_force"}[sensor]
        batches.append(half(topic, quantity, start=starts.get(sensor, 0.0), rate=200.0 if sensor == "g" else 62.5))
    return assemble(batches, Provenance("made", "test", "", 0))


def proposals(log):
    """Return the names that the log proposes for --imu."""
    return [name for note in log.notes if note.id == "parts_apart" for name in re.findall(r"--imu (\S+)", note)]


@pytest.mark.parametrize(
    ("gyro", "accel", "name"),
    [
        ("/camera/gyro/sample", "/camera/accel/sample", "/camera/imu/sample"),
        ("/d435i/gyro/imu", "/d435i/accel/imu", "/d435i/imu/imu"),
        ("/device_0/sensor_2/Gyro_0/imu/data", "/device_0/sensor_2/Accel_0/imu/data", "/device_0/sensor_2/imu_0/imu/data"),
        ("/imu/gyro", "/imu/accel", "/imu"),
        ("gyroscope", "accelerometer", "imu"),
        ("imu0_gyro", "imu0_acc", "imu0_imu"),
        ("/phone/angular_velocity", "/phone/linear_acceleration", "/phone"),
        ("/android/Gyroscope", "/android/Accelerometer", "/android"),
        ("sensor_gyro", "sensor_accel", "sensor_imu"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("turned", [False, True])
def test_halves_whose_names_differ_in_the_sensor_are_one_imu(gyro, accel, name, turned):
    halves = [f"g:{gyro}", f"a:{accel}"]
    log = log_of(*(reversed(halves) if turned else halves))
    (imu,) = log.imus
    assert imu.name == name
    assert (len(imu.angular_rate), len(imu.specific_force)) == (200, 200)
    assert ids(log.notes) == ("parts_joined",)
    assert gyro in log.notes[0]
    assert accel in log.notes[0]


@pytest.mark.parametrize(
    "names",
    [
        ("g:/bmi088", "a:/lis3dh"),
        ("g:/left/gyro", "a:/right/accel"),
        ("g:/gyrocompass", "a:/accelerated"),
        ("g:/a/gyro", "g:/a/gyroscope", "a:/a/accel"),
        ("g:/a/gyro", "a:/a/accel", "a:/a/acc"),
        ("g:odd+name", "a:other"),
    ],
)
def test_other_halves_are_proposed_with_names_that_work(names):
    log = log_of(*names)
    assert len(log.imus) == len(names)
    assert len(proposals(log)) == len(names) - 1
    for proposal in proposals(log):
        (imu,) = select(log, proposal).imus
        assert imu.angular_rate is not None
        assert imu.specific_force is not None


def test_joined_halves_can_still_be_named():
    """Scripts that were written before the halves were joined go on."""
    log = log_of("g:/camera/gyro/sample", "a:/camera/accel/sample", "a:/other")
    (both,) = select(log, "/camera/gyro/sample+/camera/accel/sample").imus
    assert (len(both.angular_rate), len(both.specific_force)) == (200, 200)
    (mixed,) = select(log, "/camera/gyro/sample+/other").imus
    assert mixed.specific_force is log.imus[1].specific_force
    (gyro,) = select(log, "/camera/gyro/sample").imus
    assert (gyro.name, gyro.specific_force) == ("/camera/gyro/sample", None)
    (accel,) = select(log, "/camera/accel/sample").imus
    assert accel.angular_rate is None
    with pytest.raises(MissingDataError, match="the log has: /camera/imu/sample, /other"):
        select(log, "/camera/gyro/data")


def test_two_cameras_are_two_imus():
    log = log_of("g:/a/gyro/sample", "a:/a/accel/sample", "g:/b/gyro/sample", "a:/b/accel/sample")
    assert [imu.name for imu in log.imus] == ["/a/imu/sample", "/b/imu/sample"]
    assert proposals(log) == []


def test_halves_of_other_times_are_neither_joined_nor_proposed():
    log = log_of("g:/gyro", "a:/accel", a=1000.0)
    assert [imu.name for imu in log.imus] == ["/gyro", "/accel"]
    assert ids(log.notes) == ()


def test_a_name_that_is_taken_is_not_given_twice():
    whole = [half("/imu", "angular_rate"), half("/imu", "specific_force")]
    log = assemble([*whole, half("/gyro", "angular_rate"), half("/accel", "specific_force")], Provenance("", "", "", 0))
    assert sorted(imu.name for imu in log.imus) == ["/accel", "/gyro", "/imu"] or len(log.imus) == 2


def test_many_proposals_are_counted():
    log = log_of(*(f"g:/g{i}" for i in range(4)), *(f"a:/a{i}" for i in range(4)))
    assert len(proposals(log)) == 4
    assert "16 pairs" in next(note for note in log.notes if note.id == "parts_apart")


def test_navigation_with_a_half_proposes_the_pair():
    log = log_of("g:/bmi088", "a:/lis3dh")
    with pytest.raises(MissingDataError, match=r"--imu /bmi088\+/lis3dh"):
        measurement_of(log, log.imu(), Installation())
