"""GPS weeks and seconds in text, against UTC made of the calendar and of IERS's table."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from imuwb.errors import UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read

EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
UNIX = datetime(1970, 1, 1, tzinfo=UTC)
#: UTC from which on GPS time is ahead by so many seconds (IERS Bulletin C)
AHEAD = (
    (datetime(2012, 7, 1, tzinfo=UTC), 16), (datetime(2015, 7, 1, tzinfo=UTC), 17), (datetime(2017, 1, 1, tzinfo=UTC), 18),
)  # fmt: skip
VALUES = "0.001,0.002,0.003"
AXES = "gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s"
MS = timedelta(milliseconds=1)


def gps_ms(utc):
    """Return whole ms of GPS time since its epoch."""
    ahead = next(s for date, s in reversed(AHEAD) if date <= utc)
    return (utc - EPOCH) // MS + 1000 * ahead


def unix_ns(utc):
    return (utc - UNIX) // MS * 10**6


def lines(first, n, step=10, unit="s"):
    """Return rows of GPS week, time of week and a gyro, every few ms from a GPS time in ms on."""
    for i in range(n):
        week, ms = divmod(first + step * i, 604_800_000)
        time = ms if unit == "ms" else f"{ms // 1000}.{ms % 1000:03d}"
        yield f"{week},{time},{VALUES}{i % 7}"


def times(text_log, header, rows, units=None):
    path = text_log("\n".join([f"{header},{AXES}", *rows, ""]))
    log = read(path, ReadOptions(units=units or {}))
    imu = log.imus[0]
    assert imu.origin.repairs == ()
    assert imu.origin.epoch == "unix"
    return imu.angular_rate.time, log.notes


@pytest.mark.parametrize(
    "utc",
    [
        datetime(2012, 7, 1, tzinfo=UTC), datetime(2015, 6, 30, 23, 59, 59, tzinfo=UTC), datetime(2015, 7, 1, tzinfo=UTC),
        datetime(2016, 12, 31, 23, 59, 59, 999_000, tzinfo=UTC), datetime(2017, 1, 1, tzinfo=UTC),
        datetime(2019, 4, 6, 23, 59, 42, tzinfo=UTC), datetime(2024, 2, 29, 12, 34, 56, 789_000, tzinfo=UTC),
    ],
    ids=str,
)  # fmt: skip
@pytest.mark.parametrize(("header", "unit"), [("gps_week,tow_s", "s"), ("gps_week,tow_ms", "ms")])
def test_week_and_time_of_week_become_utc(text_log, utc, header, unit):
    found, notes = times(text_log, header, lines(gps_ms(utc), 1, unit=unit))
    assert found.tolist() == [unix_ns(utc)]
    assert "gps_time" in ids(notes)


@pytest.mark.parametrize(("header", "unit"), [("week,tow_s", "s"), ("GPS Week,gps_seconds_of_week_ms", "ms")])
def test_over_a_rollover_of_the_week_time_goes_on(text_log, header, unit):
    header = header.replace("gps_seconds_of_week_ms", "tow [ms]")
    first = datetime(2019, 4, 6, 23, 59, 41, tzinfo=UTC)  # a second before week 2048 begins
    rows = list(lines(gps_ms(first), 201, unit=unit))
    assert rows[99].startswith("2047,") and rows[100].startswith("2048,0")  # noqa: PT018
    found, _ = times(text_log, header, rows)
    assert found.tolist() == [unix_ns(first) + 10**7 * i for i in range(201)]


@pytest.mark.parametrize("unit", ["s", "ms"])
def test_over_a_leap_second_time_goes_on_from_the_first_row(text_log, unit):
    first = datetime(2016, 12, 31, 23, 59, 59, tzinfo=UTC)
    found, _ = times(text_log, f"week,tow_{unit}", lines(gps_ms(first), 301, unit=unit))
    assert found.tolist() == [unix_ns(first) + 10**7 * i for i in range(301)]


def test_over_a_leap_second_a_long_log_goes_on_too(text_log):
    first = datetime(2016, 12, 31, 23, 59, 0, tzinfo=UTC)
    n = 220_000  # 7 MB in 220 s
    path = text_log("\n".join([f"week,tow_ms,{AXES}", *lines(gps_ms(first), n, 1, "ms"), ""]))
    found = read(path).imus[0].angular_rate.time
    assert found.size == n
    assert (np.diff(found) == 10**6).all()


def test_a_time_of_week_without_a_unit_follows_from_its_size(text_log):
    utc = datetime(2024, 11, 11, 3, 46, tzinfo=UTC)
    for unit in ("s", "ms"):
        found, _ = times(text_log, "week,tow", lines(gps_ms(utc), 3, unit=unit))
        assert found.tolist() == [unix_ns(utc) + 10**7 * i for i in range(3)]


@pytest.mark.parametrize("unit", [10**3, 10**6, 10**9])
def test_steps_of_an_imu_show_a_shorter_unit_early_in_the_week(text_log, unit):
    week, first = 2340, 250  # s after the week's beginning: in ms, less than a week of seconds
    rows = [f"{week},{(first * unit) + i * unit // 100},{VALUES}{i}" for i in range(20)]
    found, _ = times(text_log, "week,tow", rows)
    assert np.diff(found).tolist() == [10**7] * 19


def test_nanoseconds_behind_the_point_are_kept(text_log):
    utc = datetime(2024, 11, 11, 3, 46, tzinfo=UTC)
    week, ms = divmod(gps_ms(utc), 604_800_000)
    rows = [f"{week},{ms // 1000}.{ns:09d},{VALUES}" for ns in (0, 1, 123_456_789, 999_999_999)]
    found, _ = times(text_log, "week,tow_s", rows)
    assert (found - unix_ns(utc)).tolist() == [0, 1, 123_456_789, 999_999_999]


@pytest.mark.parametrize("week", ["-1", "10000", "nan", "99999999"])
def test_rows_of_an_impossible_week_are_left_out_and_counted(text_log, week):
    utc = datetime(2024, 11, 11, 3, 46, tzinfo=UTC)
    rows = list(lines(gps_ms(utc), 20))
    rows[7] = f"{week},{rows[7].partition(',')[2]}"
    imu = read(text_log("\n".join([f"week,tow_s,{AXES}", *rows, ""]))).imus[0]
    assert imu.angular_rate.time.tolist() == [unix_ns(utc) + 10**7 * i for i in range(20) if i != 7]
    assert [r.count for r in imu.origin.repairs] == [1]
    assert imu.origin.repairs[0].what.id == "no_time"


def test_a_time_of_week_alone_is_no_time_since_1970(text_log):
    path = text_log("\n".join([f"tow,{AXES}", *(row.partition(",")[2] for row in lines(10**12, 5)), ""]))
    with pytest.raises(UsageError, match="'tow'.*--units time=s"):
        read(path)


def test_a_time_of_another_kind_beside_the_week_is_not_its_seconds(text_log):
    utc = datetime(2024, 11, 11, 3, 46, tzinfo=UTC)
    rows = [f"{0.01 * i:.2f},{row}" for i, row in enumerate(lines(gps_ms(utc), 5))]
    found, _ = times(text_log, "time_s,gps_week,gps_tow_s", rows)
    assert found[0] in (0, unix_ns(utc))


def test_unix_time_beside_a_week_is_unix_time(text_log):
    utc = datetime(2024, 11, 11, 3, 46, tzinfo=UTC)
    rows = [f"{unix_ns(utc) // 10**9}.{i:02d},2340,{VALUES}" for i in range(5)]
    found, _ = times(text_log, "timestamp_s,week", rows)
    assert found[0] == unix_ns(utc)
