"""When an IMU is still and when it moves."""

from dataclasses import replace

import numpy as np
import pytest

from imuwb.health import check, record_doubts, stillness_of
from imuwb.identification import stillness
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Provenance, Scalars, Triad
from imuwb.notes import ids

from .records import log_of, motion, still


@pytest.mark.parametrize(("rows", "rate"), [(900, 100.0), (600, 2.0)], ids=["short", "slow"])
def test_what_is_too_short_or_too_slow_is_neither_still_nor_moving(rows, rate):
    gyro, accel = still()
    time = np.rint(np.arange(rows) * 1e9 / rate).astype(np.int64)
    imu = ImuStream("/imu", Triad(time, gyro[:rows] + 0.4), Triad(time, accel[:rows] + 5))
    found = check(Log(Provenance("made.csv", "csv", "", 0), (imu,)))
    assert (found.segments, found.segments_of) == ((), "/imu")
    assert not [f for f in found.faults if f.kind in ("gravity", "rate")]


def test_a_still_record_is_one_segment():
    (segment,) = check(log_of(*still())).segments
    assert (segment.start, segment.end, segment.moving) == (0, pytest.approx(59.99), False)


def test_segments_tell_when_the_imu_moves():
    gyro, accel = still()
    moving = motion(5)
    moving[:2000] = moving[4000:] = 0
    parts = check(log_of(gyro + moving[:, :3], accel + 3 * moving[:, 3:])).segments
    assert [p.moving for p in parts] == [False, True, False]
    assert [p.start for p in parts[1:]] == [p.end for p in parts[:-1]]
    assert (parts[1].start, parts[1].end) == (pytest.approx(20, abs=1.1), pytest.approx(40, abs=1.1))


def driven(speed, gyro_bias=0.0, gravity=0.0):
    """Return a log of an IMU that shows nothing but noise, and a receiver that moves by a speed (m/s) at each second."""
    gyro, accel = still()
    time = np.arange(61) * SECOND
    velocity = np.stack([speed, 0 * speed, 0 * speed], axis=1)
    position = np.stack([0.8 + np.cumsum(speed) / 6.36e6, np.full(61, 0.2), np.zeros(61)], axis=1)
    made = log_of(gyro + np.array([0, gyro_bias, 0]), accel + np.array([0, 0, gravity]))
    return replace(made, gnss=(GnssStream("/fix", time, position, velocity),))


def test_a_still_claim_that_the_receiver_contradicts_is_withdrawn():
    found = check(driven(np.full(61, 20.0)))
    assert (found.still, found.even) == (0, pytest.approx(59.99))
    assert [(s.moving, s.even) for s in found.segments] == [(True, True)]


def test_gravity_and_bias_are_not_judged_from_even_motion():
    parked, fast = (check(driven(np.full(61, v), 0.2, 0.5)) for v in (0.0, 20.0))
    assert {f.kind for f in parked.faults} >= {"rate", "gravity"}
    assert not {f.kind for f in fast.faults} & {"rate", "gravity"}


def test_gravity_is_judged_where_the_vehicle_stops():
    (fault,) = (f for f in check(driven(np.where(np.arange(61) < 30, 20.0, 0.0), 0, 0.5)).faults if f.kind == "gravity")
    assert (fault.start, fault.length) == (pytest.approx(30, abs=1.1), pytest.approx(30, abs=1.1))


def test_an_odometer_shows_even_motion_too():
    log = log_of(*still())
    time = np.arange(0, 60 * SECOND, SECOND // 10)
    assert check(replace(log, speeds=(Scalars("/wheel", time, np.full(time.size, 2.0)),))).still == 0
    assert check(replace(log, speeds=(Scalars("/wheel", time, np.zeros(time.size)),))).even == 0


def test_a_receiver_on_another_clock_withdraws_nothing():
    log = driven(np.full(61, 20.0))
    far = GnssStream("/fix", log.gnss[0].time + 10**6 * SECOND, log.gnss[0].position, log.gnss[0].velocity)
    assert check(replace(log, gnss=(far,))).even == 0


def test_lone_samples_of_even_motion_are_told():
    log = driven(np.full(61, 20.0))
    (imu,) = log.imus
    gyro = imu.angular_rate.value.copy()
    gyro[3000, 0] += 2
    struck = replace(imu, angular_rate=Triad(imu.angular_rate.time, gyro))
    assert [f.count for f in check(replace(log, imus=(struck,))).faults if f.kind == "lone samples"] == [1]


@pytest.mark.parametrize(
    ("until", "grave", "slight"), [(61, "moving", None), (20, None, "even-motion"), (0, None, None)]
)
def test_noise_of_even_motion_is_in_doubt(until, grave, slight):
    log = driven(np.where(np.arange(61) < until, 20.0, 0.0))
    still_record = stillness_of(log)
    doubts = record_doubts(log, still_record)
    assert (ids(doubts.grave), ids(doubts.slight)) == (((grave,) if grave else ()), ((slight,) if slight else ()))
    assert still_record.quiet_start == pytest.approx(until if until < 61 else 0, abs=1.1)


def test_travel_ends_the_quiet_part():
    time = np.arange(6000) / 100
    record = stillness({"gyro_x": (time, np.random.default_rng(0).standard_normal(6000))}, np.array([[10.0, 20.0]]))
    assert record.even == ((10.0, 20.0),)
    assert (record.quiet_start, record.quiet_end, record.moving) == (20, pytest.approx(59.99), False)
