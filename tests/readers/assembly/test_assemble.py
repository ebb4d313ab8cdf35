import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from imuwb.log import SECOND, Origin, Provenance
from imuwb.notes import Note, ids
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch, Remark
from tests.readers.repairs import repairs

FILE = Provenance("file", "test", "", 0)
SORTED, ALONE, REPEATED, SET_BACK, NOT_FINITE = "out_of_order", "lone_time", "repeated_time", "set_back", "not_finite"
TWICE, SPREAD = "repeated_row", "repeated_stamps"


def batch(time, marks=None, name="imu"):
    """Return rows whose every value is their mark, so that rows and times can be told to belong together."""
    time = np.asarray(time, np.int64)
    marks = np.arange(time.size) if marks is None else marks
    value = np.repeat(np.asarray(marks, float)[:, None], 3, axis=1)
    return Batch(name, "imu", time, {"angular_rate": value, "specific_force": -value})


def imu_of(*parts):
    (imu,) = assemble(parts, FILE).imus
    return imu


def marks(imu):
    np.testing.assert_array_equal(imu.specific_force.value, -imu.angular_rate.value)
    return imu.angular_rate.value[:, 0].tolist()


def test_pieces_are_joined_in_order():
    imu = imu_of(batch([0, 1], [5, 6]), batch([2, 3], [7, 8]))
    assert imu.angular_rate.time.tolist() == [0, 1, 2, 3]
    assert marks(imu) == [5, 6, 7, 8]
    assert repairs(imu) == {}


def test_rows_out_of_order_are_sorted_with_their_values():
    imu = imu_of(batch([0, 10, 30, 20, 40]))
    assert imu.angular_rate.time.tolist() == [0, 10, 20, 30, 40]
    assert marks(imu) == [0, 1, 3, 2, 4]
    assert repairs(imu) == {SORTED: 1}


def test_order_is_mended_across_pieces():
    imu = imu_of(batch([0, 20], [0, 2]), batch([10, 30], [1, 3]))
    assert marks(imu) == [0, 1, 2, 3]


def test_rows_with_one_stamp_are_samples_and_rows_that_repeat_are_not():
    imu = imu_of(batch([0, 12, 12, 12, 12, 24], marks=[0, 1, 1, 2, 3, 4]))
    assert imu.angular_rate.time.tolist() == [0, 12, 16, 20, 24]
    assert marks(imu) == [0, 1, 2, 3, 4]
    assert repairs(imu) == {TWICE: 1, SPREAD: 2}


def test_of_references_and_thermometers_one_row_of_a_stamp_is_enough():
    time = np.array([0, 10, 10, 20])
    warm = Batch("imu", "imu", time, {"temperature": np.array([1.0, 2, 3, 4])})
    position = Batch("truth", "reference", time, {"position": np.arange(12.0).reshape(4, 3)})
    log = assemble([batch([0, 10, 20]), warm, position], FILE)
    assert log.imus[0].temperature.value.tolist() == [1, 2, 4]
    assert repairs(log.imus[0]) == {}
    assert repairs(log.references[0]) == {REPEATED: 1}


def test_times_of_the_sensor_itself_are_kept_however_uneven_they_are():
    time = np.sort(np.random.default_rng(0).integers(0, 60 * SECOND, 600))
    even = np.arange(600) * (SECOND // 10) + np.tile([0, SECOND // 30], 300)
    for stamps in (time, even):
        imu = assemble([replace(batch(stamps), exact=True)], FILE).imus[0]
        assert imu.angular_rate.time.tolist() == stamps.tolist()
    assert repairs(imu_of(batch(even))) == {"uneven_stamps": 600}


def test_sensors_that_take_turns_at_equal_stamps_are_several_imus():
    rng = np.random.default_rng(0)
    time = np.repeat(np.arange(400) * (SECOND // 100), 3)
    value = rng.normal(0, 0.03, (1200, 3)) + np.tile([[0.1, 0, -9.8], [0, 0.05, -9.8], [0, 0, -9.7]], (400, 1))
    turns = Batch("imu", "imu", time, {"specific_force": value, "temperature": np.tile([30.0, 31, 32], 400)})
    log = assemble([turns], FILE)
    assert [imu.name for imu in log.imus] == ["imu.0", "imu.1", "imu.2"]
    for turn, imu in enumerate(log.imus):
        np.testing.assert_array_equal(imu.specific_force.value, value[turn::3])
        np.testing.assert_array_equal(imu.specific_force.time, time[::3])
        assert imu.temperature.value[0] == 30 + turn
    assert "in_turn" in ids(log.notes)
    one = Batch("imu", "imu", time, {"specific_force": rng.normal(0, 0.03, (1200, 3)) - [0, 0, 9.8]})
    (imu,) = assemble([one], FILE).imus
    assert len(imu.specific_force) == 1200


def test_a_stated_rate_beats_the_stamps_and_is_recorded():
    time = np.concatenate([np.arange(50), np.arange(50) + 900]) * (SECOND // 10)
    (imu,) = assemble([batch(time)], FILE, rate=20.0).imus
    np.testing.assert_array_equal(np.diff(imu.angular_rate.time), SECOND // 20)
    assert repairs(imu) == {"stated_rate": 100}


def test_samples_that_the_user_calls_even_have_no_gaps_between_batches():
    time = (np.arange(1000) // 100) * SECOND + (np.arange(1000) % 100) * (SECOND // 1000)
    assert np.diff(imu_of(batch(time)).angular_rate.time).max() > SECOND // 2
    (imu,) = assemble([batch(time)], FILE, even=True).imus
    assert np.diff(imu.angular_rate.time).max() == SECOND // 100


def test_behind_a_clock_that_is_set_back_time_goes_on():
    step = SECOND // 10
    time = np.concatenate([np.arange(50) * step + 100 * SECOND, np.arange(50) * step])
    imu = imu_of(batch(time))
    assert imu.angular_rate.time.tolist() == (np.arange(100) * step + 100 * SECOND).tolist()
    assert marks(imu) == list(range(100))
    assert repairs(imu) == {SET_BACK: 1}


def test_two_settings_back_are_two():
    step = SECOND // 10
    time = np.concatenate([np.arange(20) * step + start * SECOND for start in (50, 10, 0)])
    imu = imu_of(batch(time))
    np.testing.assert_array_equal(np.diff(imu.angular_rate.time), step)
    assert repairs(imu) == {SET_BACK: 2}


def test_one_row_that_is_very_late_is_not_a_clock_set_back():
    time = np.arange(100) * (SECOND // 10)
    time[60] = time[10] + 1
    imu = imu_of(batch(time))
    assert imu.angular_rate.time.tolist() == sorted(time.tolist())
    assert marks(imu)[11] == 60
    assert repairs(imu) == {SORTED: 1}


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_row_that_is_not_finite_in_one_value_is_left_out_whole(bad):
    part = batch([0, 1, 2])
    part.columns["specific_force"][1, 2] = bad
    imu = imu_of(part)
    assert marks(imu) == [0, 2]
    assert repairs(imu) == {NOT_FINITE: 1}


def test_a_stream_without_a_usable_row_is_noted_and_left_out():
    log = assemble([batch([0, 1], [np.nan, np.nan])], FILE)
    assert log.imus == ()
    assert ids(log.notes) == ("no_usable_row",)
    assert "2 rows" in log.notes[0]


def test_remarks_become_notes_and_repairs():
    log = assemble([Remark("odd file"), batch([0]), Remark(Note("odd", "odd rows"), "imu", 3)], FILE)
    assert log.notes == ("odd file",)
    assert repairs(log.imus[0]) == {"odd": 3}


def test_the_origin_is_that_of_the_pieces():
    part = Batch("imu", "imu", np.array([0]), {"angular_rate": np.zeros((1, 3))}, Origin("deg/s", "FLU", "boot"))
    imu = imu_of(part)
    assert (imu.origin.units, imu.origin.frame, imu.origin.epoch) == ("deg/s", "FLU", "boot")


def test_triads_on_two_clocks_are_one_imu():
    gyro = Batch("imu", "imu", np.array([0, 1]), {"angular_rate": np.ones((2, 3))})
    accel = Batch("imu", "imu", np.array([0, 5, 9]), {"specific_force": np.ones((3, 3))})
    imu = imu_of(gyro, accel)
    assert (len(imu.angular_rate), len(imu.specific_force)) == (2, 3)


def warmth(name, time=(0, 5)):
    return Batch(name, "temperature", np.array(time), {"temperature": np.full(len(time), 20.0)})


def test_a_temperature_is_joined_to_the_only_imu():
    log = assemble([batch([0], name="/a/imu"), warmth("/b/temp")], FILE)
    assert log.imus[0].temperature.time.tolist() == [0, 5]
    assert ids(log.notes) == ("temperature_joined",)
    assert re.fullmatch(r"/b/temp: .* /a/imu", log.notes[0])


def test_a_temperature_is_joined_to_the_imu_it_is_beside():
    log = assemble([batch([0], name="/a/imu"), batch([0], name="/b/imu"), warmth("/b/temp"), warmth("/a/temp")], FILE)
    assert {imu.name: imu.temperature.name for imu in log.imus} == {"/a/imu": "/a/temp", "/b/imu": "/b/temp"}


def test_a_temperature_of_no_imu_is_noted():
    log = assemble([batch([0], name="/a/imu"), batch([0], name="/b/imu"), warmth("/c/temp")], FILE)
    assert all(imu.temperature is None for imu in log.imus)
    assert ids(log.notes) == ("temperature_left_out",)
    assert log.notes[0].startswith("/c/temp: ")


def test_fixes_and_speeds_have_their_streams():
    position = np.arange(6.0).reshape(2, 3)
    fix = Batch("gps", "gnss", np.array([0, 1]), {"position": position, "fix_type": np.array([3.0, 6.0])})
    speed = Batch("wheel", "speed", np.array([0, 1]), {"speed": np.array([1.0, 2.0])})
    log = assemble([fix, speed], FILE)
    assert log.gnss[0].position.tolist() == position.tolist()
    assert log.gnss[0].fix_type.tolist() == [3, 6]
    assert log.gnss[0].velocity is None
    assert log.speeds[0].value.tolist() == [1.0, 2.0]


@settings(deadline=None)
@given(st.lists(st.integers(0, 3 * SECOND), min_size=1, max_size=40))
def test_any_times_become_increasing_and_every_row_is_accounted_for(time):
    imu = imu_of(batch(time))
    assert (np.diff(imu.angular_rate.time) > 0).all()
    left_out = sum(repairs(imu).get(name, 0) for name in (TWICE, ALONE, "frozen_clock"))
    assert len(imu.angular_rate) + left_out == len(time)
    assert sorted(set(marks(imu))) == sorted(marks(imu))


@settings(deadline=None)
@given(st.permutations(range(12)))
def test_any_order_within_a_second_is_put_right(order):
    time = np.array(order) * (SECOND // 20)
    imu = imu_of(batch(time, order))
    assert marks(imu) == list(range(12))
