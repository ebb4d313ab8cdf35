"""GPS time, which has no leap seconds, as UTC."""

from datetime import UTC, datetime, timedelta

import numpy as np

from imuwb.arrays import Integers
from imuwb.units import SECOND, UNIX_EPOCH

GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
WEEK = 604_800  # s
#: (year, month, seconds): from the month's first day on, GPS time is ahead of UTC by this many seconds (IERS Bulletin C).
LEAP_SECONDS = (
    (2017, 1, 18), (2015, 7, 17), (2012, 7, 16), (2009, 1, 15), (2006, 1, 14), (1999, 1, 13), (1997, 7, 12), (1996, 1, 11),
    (1994, 7, 10), (1993, 7, 9), (1992, 7, 8), (1991, 1, 7), (1990, 1, 6), (1988, 1, 5), (1985, 7, 4), (1983, 7, 3),
    (1982, 7, 2), (1981, 7, 1),
)  # fmt: skip


def ahead_of_utc(gps: datetime) -> int:
    """Return by how many seconds GPS time is ahead of UTC at a GPS time."""
    # The dates of the table are UTC, so each date is compared with the GPS time minus the leap seconds of that date.
    ahead = (s for y, m, s in LEAP_SECONDS if gps - timedelta(seconds=s) >= datetime(y, m, 1, tzinfo=UTC))
    return next(ahead, 0)


def leap_seconds(week: int, milliseconds: int) -> int:
    """Return by how many seconds GPS time is ahead of UTC at a GPS week and time of week (ms)."""
    return ahead_of_utc(GPS_EPOCH + timedelta(seconds=week * WEEK, milliseconds=milliseconds))


def unix_of_gps(week: Integers, milliseconds: Integers, ahead: int | None = None) -> Integers:
    """Return GPS weeks and times of week (ms) as ns since 1970 UTC.

    Args:
        week: (n,) since 1980, without rollover.
        milliseconds: (n,) time of week, ms.
        ahead: s by which GPS time is ahead of UTC in all rows; None: the value at the first row.
    """
    if not week.size:
        return np.empty(0, np.int64)
    leap = leap_seconds(int(week[0]), int(milliseconds[0])) if ahead is None else ahead
    zero = int((GPS_EPOCH - UNIX_EPOCH).total_seconds()) - leap
    return (zero + week * WEEK) * SECOND + milliseconds * (SECOND // 1000)
