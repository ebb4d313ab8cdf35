"""GPS time, which knows no leap seconds, and UTC."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND

if TYPE_CHECKING:
    from numpy.typing import NDArray

WEEK = 604_800
GPS_EPOCH = datetime(1980, 1, 6, tzinfo=UTC)
#: GPS time is ahead of UTC by this many seconds from these dates on (IERS Bulletin C).
LEAP_SECONDS = (
    (2017, 1, 18), (2015, 7, 17), (2012, 7, 16), (2009, 1, 15), (2006, 1, 14), (1999, 1, 13), (1997, 7, 12), (1996, 1, 11),
    (1994, 7, 10), (1993, 7, 9), (1992, 7, 8), (1991, 1, 7), (1990, 1, 6), (1988, 1, 5), (1985, 7, 4), (1983, 7, 3),
    (1982, 7, 2), (1981, 7, 1),
)  # fmt: skip


def ahead_of_utc(when: datetime) -> int:
    """Return by how many seconds GPS time is ahead at a GPS time."""
    # The dates are UTC's, so it is the time less the leap seconds that counts.
    ahead = (s for y, m, s in LEAP_SECONDS if when - timedelta(seconds=s) >= datetime(y, m, 1, tzinfo=UTC))
    return next(ahead, 0)


def leap_seconds(week: int, milliseconds: int) -> int:
    """Return by how many seconds GPS time is ahead of UTC at a week and ms of it."""
    return ahead_of_utc(GPS_EPOCH + timedelta(seconds=week * WEEK, milliseconds=milliseconds))


def unix_of_gps(
    week: NDArray[np.int64], milliseconds: NDArray[np.int64], ahead: int | None = None
) -> NDArray[np.int64]:
    """Return ns since 1970 UTC of GPS weeks and ms of the week; leap seconds are ``ahead``, or those of the first row."""
    if not week.size:
        return np.empty(0, np.int64)
    leap = leap_seconds(int(week[0]), int(milliseconds[0])) if ahead is None else ahead
    zero = int((GPS_EPOCH - datetime(1970, 1, 1, tzinfo=UTC)).total_seconds()) - leap
    return (zero + week * WEEK) * SECOND + milliseconds * (SECOND // 1000)
