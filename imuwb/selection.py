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
RULE = "A+B takes the gyro of A with the accelerometer of B"
LONGEST = 1e9  #: s, thirty years


def select(log: Log, imu: str | None = None, start: str | None = None, end: str | None = None) -> Log:
    """Return the part of a log between two times, with one IMU if named.

    Args:
        log: what was read.
        imu: an IMU's name, or two with a + between: the gyro of the first with the accelerometer of the second (the other
            way round where only that can be, or a name says so); None keeps all.
        start: seconds from the log's start (``"12.5"``) or an ISO time (``"2024-05-01T12:00:00"``,
            UTC unless it says otherwise).
        end: likewise.

    Raises:
        MissingDataError: no such IMU (the message lists those there are), or nothing in the span.
        UsageError: ``start`` or ``end`` is neither seconds from 0 on nor ISO, ``end`` is not behind ``start``, or one IMU is
            named twice.
    """
    if imu is not None:
        log = _with_one(log, imu)
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


def _with_one(log: Log, name: str) -> Log:
    """Return the log with one IMU: of that name, or made of two."""
    for imu in log.imus:
        if imu.name == name:
            return replace(log, imus=(imu,))
    parts = {part: imu for imu in log.imus for part in (imu.name, *imu.name.split("+"))}
    splits = [(name[:at], name[at + 1 :]) for at, letter in enumerate(name) if letter == "+"]
    if any(one and one == other for one, other in splits):
        message = f"--imu {name}: the same IMU twice; its own name alone takes both its sensors"
        raise UsageError(message)
    for one, other in splits:
        if one in parts and other in parts:
            return _composed(log, name, (one, parts[one]), (other, parts[other]))
    there = ", ".join(imu.name for imu in log.imus) or "none"
    rule = f"; {RULE}" if splits else ""
    message = f"{log.provenance.path}: no IMU called {name!r}; there are: {there}{rule}"
    raise MissingDataError(message)


def _composed(log: Log, name: str, first: tuple[str, ImuStream], second: tuple[str, ImuStream]) -> Log:
    """Return the log with the gyro of one IMU and the accelerometer of another as its only IMU; a note says which is which."""
    for (gyro_name, gyro), (accel_name, accel) in ((first, second), (second, first)):
        rate, force = gyro.angular_rate, accel.specific_force
        if rate is None or force is None or "accel" in gyro_name:
            continue
        more = tuple(r for r in accel.origin.repairs if r not in gyro.origin.repairs)
        origin = replace(gyro.origin, repairs=(*gyro.origin.repairs, *more))
        imu = ImuStream(name, rate, force, accel.temperature or gyro.temperature, origin)
        note = f"{name}: the gyro of {gyro_name} with the accelerometer of {accel_name}"
        return replace(log, imus=(imu,), notes=(*log.notes, note))
    lack = [f"{part} has no {'gyro' if imu.angular_rate is None else 'accelerometer'}" for part, imu in (first, second)
            if imu.angular_rate is None or imu.specific_force is None]  # fmt: skip
    message = (
        f"{log.provenance.path}: --imu {name} makes no IMU ({', '.join(lack) or 'both name accelerometers'}); {RULE}"
    )
    raise MissingDataError(message)


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
    if not 0 <= seconds < LONGEST:
        message = f"{text!r} s from the log's start is no time in a log; it is 0 or more, or an ISO time"
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
