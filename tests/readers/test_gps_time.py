"""GPS weeks as UTC, also in the weeks of a leap second."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from imuwb.readers.gps_time import LEAP_SECONDS, ahead_of_utc, unix_of_gps

#: TAI - UTC from the first of a month on, as IERS lists it; GPS time is TAI - 19 s.
TAI = {
    (1980, 1): 19, (1981, 7): 20, (1982, 7): 21, (1983, 7): 22, (1985, 7): 23, (1988, 1): 24, (1990, 1): 25,
    (1991, 1): 26, (1992, 7): 27, (1993, 7): 28, (1994, 7): 29, (1996, 1): 30, (1997, 7): 31, (1999, 1): 32,
    (2006, 1): 33, (2009, 1): 34, (2012, 7): 35, (2015, 7): 36, (2017, 1): 37,
}  # fmt: skip
EPOCH = datetime(1980, 1, 6, tzinfo=UTC)


def gps_of(utc):
    """Return the GPS time of a UTC time, by the list above."""
    passed = [seconds for (year, month), seconds in TAI.items() if datetime(year, month, 1, tzinfo=UTC) <= utc]
    return utc + timedelta(seconds=passed[-1] - 19)


def instants(year):
    """Return times, whole ms, from the middle of a year's January to 2060."""
    first = datetime(year, 1, 15, tzinfo=UTC)
    most = (datetime(2060, 1, 1, tzinfo=UTC) - first) // timedelta(milliseconds=1)
    return st.integers(0, most).map(lambda ms: first + timedelta(milliseconds=ms))


def week_and_ms(gps):
    whole, rest = divmod(gps - EPOCH, timedelta(weeks=1))
    return np.array([whole]), np.array([rest // timedelta(milliseconds=1)])


def test_the_table_is_that_of_iers():
    assert {(y, m): s + 19 for y, m, s in LEAP_SECONDS} == {key: s for key, s in TAI.items() if key != (1980, 1)}
    assert sorted(LEAP_SECONDS, reverse=True) == list(LEAP_SECONDS)  # the latest first


@pytest.mark.parametrize("month", [key for key in TAI if key != (1980, 1)])
def test_a_leap_second_counts_from_its_midnight_on(month):
    midnight = datetime(*month, 1, tzinfo=UTC)
    for seconds in (-1, -0.001, 0, 0.001, 1, 100):
        utc = midnight + timedelta(seconds=seconds)
        assert gps_of(utc) - timedelta(seconds=ahead_of_utc(gps_of(utc))) == utc


@given(instants(1980))
def test_gps_time_less_what_it_is_ahead_is_utc(utc):
    assert gps_of(utc) - timedelta(seconds=ahead_of_utc(gps_of(utc))) == utc


@pytest.mark.parametrize(
    ("week", "milliseconds", "utc"),
    [
        (0, 0, "1980-01-06T00:00:00+00:00"),
        (1024, 0, "1999-08-21T23:59:47+00:00"),  # the first rollover
        (2048, 0, "2019-04-06T23:59:42+00:00"),  # the second
        (2340, 100_000_500, "2024-11-11T03:46:22.500000+00:00"),
    ],
)
def test_known_instants(week, milliseconds, utc):
    (found,) = unix_of_gps(np.array([week]), np.array([milliseconds]))
    assert datetime.fromtimestamp(found / 1e9, UTC).isoformat() == utc


@given(instants(2017))
def test_weeks_and_milliseconds_become_utc_to_the_millisecond(utc):
    (found,) = unix_of_gps(*week_and_ms(gps_of(utc)))
    assert found == (utc - datetime(1970, 1, 1, tzinfo=UTC)) // timedelta(milliseconds=1) * 10**6


@pytest.mark.parametrize("utc", [datetime(2017, 1, 2, tzinfo=UTC), datetime(2015, 7, 2, tzinfo=UTC)])
def test_in_the_week_of_a_leap_second_the_first_row_decides(utc):
    (found,) = unix_of_gps(*week_and_ms(gps_of(utc)))
    assert found == int(utc.timestamp()) * 10**9


def test_rows_count_on_from_the_first_without_a_step():
    week, milliseconds = np.array([2340, 2340, 2341]), np.array([0, 604_799_999, 0])
    assert np.diff(unix_of_gps(week, milliseconds)).tolist() == [604_799_999 * 10**6, 10**6]
    assert unix_of_gps(week[:0], milliseconds[:0]).size == 0
