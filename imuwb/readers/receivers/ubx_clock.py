"""UTC of a u-blox log's messages, which state the time of the GPS week in ms.

Some messages state the date, too. Each other message takes the week of the nearest of these in the file. The receiver's
navigation epoch is not a whole ms: NAV-PVT states the rest in ns, and so do the messages of the same epoch with it.
"""

from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Integers
from imuwb.log import Nanoseconds
from imuwb.readers.gps_time import GPS_EPOCH, WEEK, leap_seconds
from imuwb.readers.receivers.ubx_log import UbxLog, Values
from imuwb.readers.receivers.ubx_messages import PVT, RAW_SIGNALS, SOLUTION, TIME_GPS, TIME_UTC
from imuwb.units import SECOND, UNIX_EPOCH

MILLI = SECOND // 1000
WEEK_MS = WEEK * 1000
ZERO = int((GPS_EPOCH - UNIX_EPOCH).total_seconds())  #: s from 1970 to 1980
RESOLVED, DATED = 7, 3  #: flags of UTC: date, time, and leap seconds are known; date and time alone
WEEKS_KNOWN = 3  #: flags of NAV-TIMEGPS: time of week and week
WEEKS_SET = 12  #: the same flags of NAV-SOL
YEARS = (2000, 2100)  #: a date outside is damage, or the receiver does not know it
FURTHEST = SECOND  #: ns; UTC and time of week of one message differ by less, leap seconds apart


@dataclass(frozen=True, eq=False, slots=True)
class UbxClock:
    """The messages that state date and time of week."""

    place: Integers  #: (k,) offset in the file, rising
    gps: Integers  #: (k,) ms since 1980
    rest: Nanoseconds  #: (k,) ns by which the epoch is later than ``gps``
    resolved: bool  #: whether the receiver knew the leap seconds

    @property
    def ahead(self) -> int:
        """Seconds by which GPS time is ahead of UTC."""
        return leap_seconds(0, int(self.gps[0]))

    def epochs(self, place: Integers, tow: Integers) -> Integers:
        """Return times of week (ms) of messages at some places of the file as ms since 1980."""
        near = self.gps[self.nearest(place)]
        week = np.rint((near - tow) / WEEK_MS).astype(np.int64)
        return week * WEEK_MS + tow

    def unix(self, place: Integers, gps: Integers) -> Nanoseconds:
        """Return ms since 1980 as ns since 1970 UTC."""
        return ((ZERO - self.ahead) * 1000 + gps) * MILLI + self.rest[self.nearest(place)]

    def nearest(self, place: Integers) -> Integers:
        """Return the messages that are nearest in the file to some places."""
        after = np.searchsorted(self.place, place).clip(0, self.place.size - 1)
        before = (after - 1).clip(0)
        return np.where(np.abs(self.place[before] - place) <= np.abs(self.place[after] - place), before, after)


def ubx_clock(log: UbxLog) -> UbxClock | None:
    """Return the clock of a log; None if no message states a date."""
    for kind in (PVT, TIME_UTC):
        rows = log.rows(kind)
        for flags in (RESOLVED, DATED):
            if rows is not None and (clock := _of_dates(rows, flags)) is not None:
                return clock
    for kind, name, flags in ((TIME_GPS, "valid", WEEKS_KNOWN), (SOLUTION, "flags", WEEKS_SET)):
        rows = log.rows(kind)
        if rows is not None and (known := (rows[name] & flags == flags) & (rows["tow"] < WEEK_MS)).any():
            gps = rows["week"][known].astype(np.int64) * WEEK_MS + rows["tow"][known]
            return UbxClock(rows["place"][known], gps, rows["rest"][known].astype(np.int64), resolved=True)
    rows = log.rows(RAW_SIGNALS)
    if rows is None:
        return None
    with np.errstate(invalid="ignore"):
        known = (rows["week"] > 0) & (rows["seconds"] >= 0) & (rows["seconds"] < WEEK)
    if not known.any():
        return None
    tow = np.rint(rows["seconds"][known] * 1000).astype(np.int64)
    gps = rows["week"][known].astype(np.int64) * WEEK_MS + tow
    return UbxClock(rows["place"][known], gps, np.zeros_like(gps), resolved=True)


def _of_dates(rows: Values, flags: int) -> UbxClock | None:
    """Return the clock of messages that state UTC with these flags."""
    known = (rows["valid"] & flags == flags) & _possible(rows)
    if not known.any():
        return None
    rows = {name: values[known] for name, values in rows.items()}
    utc, tow = _utc(rows), rows["tow"].astype(np.int64)
    ahead = leap_seconds(0, int(utc[0] // MILLI - ZERO * 1000))
    since = utc + (ahead - ZERO) * SECOND  # GPS time, ns since 1980
    week = np.rint((since / MILLI - tow) / WEEK_MS).astype(np.int64)
    gps = week * WEEK_MS + tow
    rest = since - gps * MILLI
    near = np.abs(rest) < FURTHEST
    if not near.any():
        return None
    return UbxClock(rows["place"][near], gps[near], rest[near], resolved=flags == RESOLVED)


def _possible(rows: Values) -> Booleans:
    year, month, day = (rows[name].astype(np.int64) for name in ("year", "month", "day"))
    date = (year >= YEARS[0]) & (year < YEARS[1]) & (month >= 1) & (month <= 12) & (day >= 1) & (day <= 31)  # noqa: PLR2004
    clock = (rows["hour"] < 24) & (rows["minute"] < 60) & (rows["second"] <= 60) & (rows["tow"] < WEEK_MS)  # noqa: PLR2004
    return date & clock & (np.abs(rows["nano"].astype(np.int64)) <= SECOND)


def _utc(rows: Values) -> Nanoseconds:
    """Return the date and time of messages, ns since 1970 UTC."""
    months = (rows["year"].astype(np.int64) - 1970) * 12 + rows["month"] - 1
    days = months.astype("M8[M]").astype("M8[D]").astype(np.int64) + rows["day"] - 1
    seconds = (
        days * 86_400 + rows["hour"].astype(np.int64) * 3600 + rows["minute"].astype(np.int64) * 60 + rows["second"]
    )
    return seconds * SECOND + rows["nano"]
