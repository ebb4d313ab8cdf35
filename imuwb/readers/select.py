"""Cuts a log to a span of time and to one IMU."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from imuwb.errors import MissingDataError, UsageError
from imuwb.log import SECOND, GnssStream, ImuStream, Log, Reference, Scalars, Triad

if TYPE_CHECKING:
    from collections.abc import Callable

Timed = TypeVar("Timed", Triad, Scalars, GnssStream, Reference)
FAR = np.iinfo(np.int64).max
LONGEST = 1e9  #: s, thirty years


def select(log: Log, imu: str | None = None, start: str | None = None, end: str | None = None) -> Log:
    """Return the part of a log between two times, with one IMU if named.

    Args:
        log: what was read.
        imu: an IMU's name; None keeps all.
        start: seconds from the log's start (``"12.5"``) or an ISO time (``"2024-05-01T12:00:00"``,
            UTC unless it says otherwise).
        end: likewise.

    Raises:
        MissingDataError: no such IMU (the message lists those there are), or nothing in the span.
        UsageError: ``start`` or ``end`` is neither seconds nor ISO, or ``end`` is not behind ``start``.
    """
    if imu is not None:
        log = replace(log, imus=(_named(log, imu),))
    if start is None and end is None:
        return log
    zero, epoch = log.zero or 0, _epoch(log)
    first = -FAR if start is None else _instant(start, zero, epoch)
    last = FAR if end is None else _instant(end, zero, epoch)
    if last <= first:
        message = f"--end {end} is not behind --start {start}"
        raise UsageError(message)
    cut = replace(
        log,
        imus=tuple(x for x in (_cut_imu(x, first, last) for x in log.imus) if x.axes()),
        gnss=_kept(log.gnss, first, last),
        speeds=_kept(log.speeds, first, last),
        references=_kept(log.references, first, last),
        provenance=replace(log.provenance, selection=f"{start or 'start'} to {end or 'end'}"),
    )
    samples = sum(len(t) for x in cut.imus for t in (x.angular_rate, x.specific_force) if t is not None)
    others = sum(len(x) for x in (*cut.gnss, *cut.speeds, *cut.references))
    if not samples and (log.imus or not others):
        message = f"{log.provenance.path}: no IMU sample between {start or 'start'} and {end or 'end'}"
        raise MissingDataError(message if log.imus else message.replace("IMU sample", "row"))
    return cut


def _named(log: Log, name: str) -> ImuStream:
    for imu in log.imus:
        if imu.name == name:
            return imu
    composed = _composed(log, name)
    if composed is not None:
        return composed
    there = ", ".join(imu.name for imu in log.imus) or "none"
    message = f"{log.provenance.path}: no IMU called {name!r}; there are: {there}"
    raise MissingDataError(message)


def _composed(log: Log, name: str) -> ImuStream | None:
    """Return the IMU that two names with a + between make: the gyro of one and the accelerometer of the other."""
    parts = {part: imu for imu in log.imus for part in (imu.name, *imu.name.split("+"))}
    one, mark, other = name.partition("+")
    first, second = parts.get(one), parts.get(other)
    if not mark or first is None or second is None:
        return None
    for gyro, accel in ((first, second), (second, first)):
        named = one if gyro is first else other
        more = tuple(r for r in accel.origin.repairs if r not in gyro.origin.repairs)
        origin = replace(gyro.origin, repairs=(*gyro.origin.repairs, *more))
        if gyro.angular_rate is not None and accel.specific_force is not None and "accel" not in named:
            return ImuStream(
                name, gyro.angular_rate, accel.specific_force, accel.temperature or gyro.temperature, origin
            )
    return None


def _epoch(log: Log) -> str:
    epochs = {stream.origin.epoch for stream in (*log.imus, *log.gnss, *log.references)}
    if len(epochs) > 1:
        message = (
            f"{log.provenance.path}: its streams run on different clocks ({', '.join(sorted(epochs))}), so one span of "
            "time cannot cut them all; leave --start and --end away"
        )
        raise UsageError(message)
    return epochs.pop() if epochs else "log"


def _instant(text: str, zero: int, epoch: str) -> int:
    try:
        seconds = float(text)
    except ValueError:
        return _date(text, epoch)
    if not abs(seconds) < LONGEST:
        message = f"{text!r} s from the log's start is no time in a log"
        raise UsageError(message)
    return zero + round(seconds * SECOND)


def _date(text: str, epoch: str) -> int:
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        message = f"{text!r} is neither seconds from the log's start nor an ISO time such as 2024-05-01T12:00:00"
        raise UsageError(message) from None
    if epoch != "unix":
        message = f"{text!r} is a date, but the log's clock starts at its own zero; give seconds"
        raise UsageError(message)
    when = when if when.tzinfo else when.replace(tzinfo=UTC)
    since = when - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86400 + since.seconds) * SECOND + since.microseconds * 1000


def _kept(streams: tuple[Timed, ...], first: int, last: int) -> tuple[Timed, ...]:
    return tuple(kept for stream in streams if len(kept := _cut(stream, first, last)))


def _cut(stream: Timed, first: int, last: int) -> Timed:
    inside = slice(*np.searchsorted(stream.time, (first, last)))
    names = (name for name in stream.__dataclass_fields__ if isinstance(getattr(stream, name), np.ndarray))
    take: Callable[[str], object] = lambda name: getattr(stream, name)[inside]  # noqa: E731
    return replace(stream, **{name: take(name) for name in names})


def _cut_imu(imu: ImuStream, first: int, last: int) -> ImuStream:
    parts = ("angular_rate", "specific_force", "temperature")
    kept = {name: _cut(part, first, last) for name in parts if (part := getattr(imu, name)) is not None}
    return replace(imu, **{name: kept[name] if name in kept and len(kept[name]) else None for name in parts})
