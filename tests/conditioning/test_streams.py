import math
from dataclasses import replace

import numpy as np
import pytest

from imuwb.conditioning import Change, condition_streams
from imuwb.errors import MissingDataError
from imuwb.log import SECOND, Conditioning, ImuStream, Log, Provenance, Scalars, Triad

MADE = Conditioning("mine", "a=1", causal=True, delay=0.5)


def triad(samples, rate=100, start=0):
    """Return a ramp whose values say which sample they were."""
    index = np.asarray(samples)
    return Triad(start + index * (SECOND // rate), index[:, None] + np.array([0.0, 0.1, 0.2]))


def log(gyro, accel=None, **more):
    return Log(Provenance("x.mcap", "mcap", "sha256:", 0), imus=(ImuStream("/imu", gyro, accel, **more),))


def same(sensor, rate):
    return Change(lambda values: values)


def test_parts_between_gaps_stay_apart():
    given = log(triad(np.r_[0:100, 150:250]))

    def design(sensor, rate):
        assert (sensor, rate) == ("gyro", pytest.approx(100))
        return Change(lambda v: (v[:-2] + v[1:-1] + v[2:]) / 3, 3, 1, 1)

    found = condition_streams(given, design).imus[0].angular_rate
    kept = np.r_[1:99, 151:249]
    np.testing.assert_array_equal(found.time, kept * (SECOND // 100))
    np.testing.assert_allclose(found.value[:, 0], kept, rtol=0, atol=1e-12)


def test_the_first_and_last_samples_of_a_part_and_every_nth_are_kept_as_said():
    given = log(triad(np.r_[0:100, 150:250]))
    found = condition_streams(given, lambda *_: Change(lambda v: v[4:-2][::5], 7, 4, 2, 5)).imus[0].angular_rate
    kept = np.r_[4:98:5, 154:248:5]
    np.testing.assert_array_equal(found.time, kept * (SECOND // 100))
    np.testing.assert_array_equal(found.value[:, 0], kept)


def test_short_parts_are_dropped():
    given = log(triad(np.r_[0:100, 120:129, 150:250]))
    found = condition_streams(given, lambda *_: Change(lambda v: v, shortest=10)).imus[0].angular_rate
    np.testing.assert_array_equal(found.value[:, 0], np.r_[0:100, 150:250])
    kept = condition_streams(given, lambda *_: Change(lambda v: v, shortest=9)).imus[0].angular_rate
    assert len(kept) == 209


def test_a_part_that_its_ends_use_up_is_dropped():
    given = log(triad(np.r_[0:100, 150:160]))
    found = condition_streams(given, lambda *_: Change(lambda v: v[6:-4], 1, 6, 4)).imus[0].angular_rate
    np.testing.assert_array_equal(found.value[:, 0], np.r_[6:96])


def test_nothing_left_is_missing_data_that_names_the_stream():
    with pytest.raises(MissingDataError, match=r"x\.mcap: /imu gyro: no part between gaps has the 101 samples"):
        condition_streams(log(triad(np.r_[0:100, 150:250])), lambda *_: Change(lambda v: v, 101))


@pytest.mark.parametrize("n", [0, 1])
def test_a_stream_without_a_rate_is_missing_data(n):
    with pytest.raises(MissingDataError, match=f"/imu accel has {n} samples"):
        condition_streams(log(triad(range(50)), triad(range(n))), same)


def test_each_triad_is_changed_at_its_own_rate():
    seen = {}

    def design(sensor, rate):
        seen[sensor] = rate
        return Change(lambda v: v[:: 2 if sensor == "gyro" else 1], step=2 if sensor == "gyro" else 1)

    given = log(triad(range(200), 100), triad(range(90), 40))
    found = condition_streams(given, design).imus[0]
    assert seen == {"gyro": pytest.approx(100), "accel": pytest.approx(40)}
    np.testing.assert_array_equal(found.angular_rate.time, given.imus[0].angular_rate.time[::2])
    np.testing.assert_array_equal(found.specific_force.time, given.imus[0].specific_force.time)


def test_a_missing_triad_stays_missing_and_all_else_stays_as_it_is():
    temperature = Scalars("t", np.arange(3) * SECOND, np.ones(3))
    given = log(triad(range(50), start=7 * SECOND), temperature=temperature)
    found = condition_streams(given, lambda *_: Change(lambda v: v[5:], 1, 5))
    assert found.imus[0].specific_force is None
    assert found.imus[0].temperature is temperature
    assert found.provenance is given.provenance
    assert found.zero == given.zero == 7 * SECOND  # seconds from the log's start stay what they were


def test_what_was_done_is_said_in_order():
    given = log(triad(range(50)))
    assert condition_streams(given, same).conditioning == ()  # it is for the conditioner to say
    first = replace(condition_streams(given, same), conditioning=(MADE,))
    assert condition_streams(first, same).conditioning == (MADE,)
    other = Conditioning("other", "", causal=False, delay=0.0)
    second = replace(condition_streams(first, same), conditioning=(*first.conditioning, other))
    assert second.conditioning == (MADE, other)
    assert (given.causal, first.causal, second.causal) == (True, True, False)


def test_a_log_is_as_it_was_up_to_the_least_band_of_what_was_done():
    given = log(triad(range(3)))
    assert given.band == math.inf
    assert replace(given, conditioning=(MADE,)).band == math.inf  # None: everywhere
    steps = (replace(MADE, band=8.0), MADE, replace(MADE, band=3.0), replace(MADE, band=5.0))
    assert replace(given, conditioning=steps).band == 3.0


def test_all_imus_are_changed():
    one = ImuStream("/a", triad(range(50)), None)
    two = ImuStream("/b", triad(range(60)), None)
    given = Log(Provenance("x.mcap", "mcap", "sha256:", 0), imus=(one, two))
    found = condition_streams(given, lambda *_: Change(lambda v: v[1:], 1, 1))
    assert [len(imu.angular_rate) for imu in found.imus] == [49, 59]
