import re
from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Origin, Provenance, Reference, Scalars, Triad
from imuwb.notes import ids
from imuwb.selection import select

ZERO = 1_714_564_800 * SECOND  # 2024-05-01T12:00:00Z


def log_of(epoch="unix", names=("left", "right")):
    time = ZERO + np.arange(10) * SECOND
    triad = Triad(time, np.arange(30.0).reshape(10, 3))
    imus = [ImuStream(n, triad, triad, Scalars("warm", time, np.arange(10.0)), Origin(epoch=epoch)) for n in names]
    origin = Origin(epoch=epoch)
    fix = GnssStream("fix", time, triad.value, fix_type=np.arange(10), origin=origin)
    speed = Scalars("wheel", time, np.arange(10.0))
    truth = Reference("truth", time, triad.value, attitude=triad.value, origin=origin)
    return Log(Provenance("log.csv", "csv", "", 0), tuple(imus), (fix,), (speed,), (truth,))


def seconds(stream):
    return ((stream.time - ZERO) // SECOND).tolist()


def test_without_options_everything_is_kept():
    log = log_of()
    assert select(log) is log


def test_an_imu_is_chosen_by_name():
    assert [imu.name for imu in select(log_of(), imu="right").imus] == ["right"]


def test_an_unknown_imu_lists_those_there_are():
    with pytest.raises(MissingDataError, match=r"log\.csv: .*'middle'.*: left, right$"):
        select(log_of(), imu="middle")


@pytest.mark.parametrize(
    ("start", "end", "kept"),
    [
        ("2", "5", [2, 3, 4]),
        ("2.5", None, [3, 4, 5, 6, 7, 8, 9]),
        (None, "1.5", [0, 1]),
        ("0", "1", [0]),
        ("2024-05-01T12:00:02", "2024-05-01T12:00:05", [2, 3, 4]),
        ("2024-05-01T14:00:02+02:00", "2024-05-01T12:00:05Z", [2, 3, 4]),
        ("2024-05-01 12:00:01.500", "4", [2, 3]),
    ],
)
def test_a_span_is_half_open(start, end, kept):
    log = select(log_of(), start=start, end=end)
    for stream in (log.imus[1].angular_rate, log.imus[0].specific_force, log.gnss[0], log.speeds[0], log.references[0]):
        assert seconds(stream) == kept


def test_every_array_of_a_stream_is_cut_alike():
    log = select(log_of(), start="2", end="4")
    assert log.gnss[0].fix_type.tolist() == [2, 3]
    assert log.gnss[0].position[:, 0].tolist() == [6, 9]
    assert log.references[0].attitude[:, 0].tolist() == [6, 9]
    assert log.imus[0].temperature.value.tolist() == [2, 3]
    assert log.imus[0].origin.epoch == "unix"


def test_the_span_stands_in_the_provenance():
    assert select(log_of(), start="2").provenance.selection == "2 to end"
    assert select(log_of(), end="2").provenance.selection == "start to 2"


@pytest.mark.parametrize(("start", "end"), [("10", "20"), ("2.1", "2.9"), ("2025-01-01", None)])
def test_a_span_without_a_sample_is_missing_data(start, end):
    with pytest.raises(MissingDataError, match="IMU sample between"):
        select(log_of(), start=start, end=end)


def test_a_span_without_a_fix_is_missing_data():
    log = replace(log_of(), imus=(), speeds=(), references=())
    assert len(select(log, start="2", end="5").gnss[0]) == 3
    with pytest.raises(MissingDataError, match=r"log\.csv: .*row between 20 and 30"):
        select(log, start="20", end="30")


@pytest.mark.parametrize(("start", "end"), [("5", "2"), ("5", "5"), ("2024-05-01T12:00:05", "2024-05-01T12:00:01")])
def test_an_end_that_is_not_behind_the_start_is_refused(start, end):
    with pytest.raises(UsageError, match=rf"--end {end} .* --start {start}$"):
        select(log_of(), start=start, end=end)


@pytest.mark.parametrize("text", ["noon", "", "12:00"])
def test_what_is_neither_seconds_nor_iso_is_refused(text):
    with pytest.raises(UsageError, match="2024-05-01T12:00:00"):
        select(log_of(), start=text)


@pytest.mark.parametrize("text", ["inf", "-inf", "nan", "1e300", "-1e300", "1e9"])
@pytest.mark.parametrize("end", ["start", "end"])
def test_seconds_that_no_log_lasts_are_refused(end, text):
    with pytest.raises(UsageError, match=rf"'{text}'.*0 to 1e\+09"):
        select(log_of(), **{end: text})


@pytest.mark.parametrize("epoch", ["log", "boot"])
def test_a_date_needs_a_clock_that_knows_dates(epoch):
    with pytest.raises(UsageError, match="a date.*seconds"):
        select(log_of(epoch), start="2024-05-01T12:00:00")


def test_the_log_itself_is_not_changed():
    log = log_of()
    select(log, imu="left", start="2", end="3")
    assert len(log.imus) == 2
    assert len(log.imus[0].angular_rate) == 10


@pytest.mark.parametrize("span", [("-5", None), (None, "-1"), ("-0.1", "2")])
def test_seconds_before_the_log_are_refused(span):
    with pytest.raises(UsageError, match=r"0 to 1e\+09"):
        select(log_of(), None, *span)


def test_two_imus_make_one_and_a_note_says_which_half_is_whose():
    log = select(log_of(), "left+right")
    assert ids(log.notes) == ("composed",)
    assert re.search("gyro of left .* accelerometer of right", log.notes[0])


def test_the_same_imu_twice_is_refused():
    with pytest.raises(UsageError, match="twice"):
        select(log_of(), "left+left")


def test_a_half_that_is_not_there_names_the_rule():
    with pytest.raises(MissingDataError, match=r": left, right; A\+B"):
        select(log_of(), "left+middle")


def test_halves_that_make_no_imu_name_what_they_lack_and_the_rule():
    log = log_of()
    log = replace(log, imus=tuple(replace(imu, specific_force=None) for imu in log.imus))
    with pytest.raises(MissingDataError, match=r"left has no accelerometer, right has no accelerometer\); A\+B"):
        select(log, "left+right")
