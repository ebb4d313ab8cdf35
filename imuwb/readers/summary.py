"""What a log holds, stream by stream: the answer of ``imuwb info``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.log import SECOND, Epoch, Log, Repair

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.log import Nanoseconds, Origin
    from imuwb.readers.batch import Kind

GAP = 1.5  # nominal steps: from here on at least one sample is missing


@dataclass(frozen=True, slots=True)
class StreamSummary:
    """One stream: how much, how fast, from when to when, and what was mended."""

    name: str
    kind: Kind
    count: int
    rate_hz: float | None  #: count over duration, gaps left out; None for a single row
    start_ns: int
    end_ns: int
    epoch: Epoch
    gaps: tuple[tuple[float, float], ...]  #: (start in seconds from the stream's first row, length in s)
    repairs: tuple[Repair, ...]
    units: str  #: of the file; inside all is SI
    frame: str  #: of the file; inside all is FRD or NED


@dataclass(frozen=True, slots=True)
class LogSummary:
    """A file and its streams."""

    path: str
    format: str
    hash: str
    streams: tuple[StreamSummary, ...]
    notes: tuple[str, ...]


def sampling_interval(time: Nanoseconds) -> float:
    """Return the mean time between samples in s, gaps left out; nan for fewer than two samples.

    The mean, because stamps rounded to milliseconds make a median that is off by per cents.
    """
    if time.size < 2:  # noqa: PLR2004 - a step needs two rows
        return float("nan")
    steps = np.diff(time)
    usual = steps[steps <= GAP * np.median(steps)]
    return float(usual.mean()) / SECOND


def gaps(time: Nanoseconds) -> tuple[tuple[float, float], ...]:
    """Return (start, length) in s of every step longer than 1.5 usual ones; start from the first row."""
    if time.size < 3:  # noqa: PLR2004 - a gap is a step unlike the others
        return ()
    steps = np.diff(time)
    at = np.flatnonzero(steps > GAP * np.median(steps))
    return tuple((float(time[i] - time[0]) / SECOND, float(steps[i]) / SECOND) for i in at)


def summarize(log: Log) -> LogSummary:
    """Return what a log holds."""
    where = log.provenance
    return LogSummary(where.path, where.format, where.hash, tuple(_streams(log)), log.notes)


def _streams(log: Log) -> Iterator[StreamSummary]:
    epoch: Epoch = "log"
    for imu in log.imus:
        epoch = imu.origin.epoch
        triads = [t for t in (imu.angular_rate, imu.specific_force) if t is not None]
        if all(t.time is triads[0].time or np.array_equal(t.time, triads[0].time) for t in triads):
            yield _stream(imu.name, "imu", triads[0].time, imu.origin)
        else:
            yield _stream(f"{imu.name} (gyro)", "imu", triads[0].time, imu.origin)
            yield _stream(f"{imu.name} (accelerometer)", "imu", triads[1].time, imu.origin)
        if imu.temperature is not None:
            yield _stream(
                imu.temperature.name,
                "temperature",
                imu.temperature.time,
                imu.origin,
                units="°C",
                frame="",
                mended=False,
            )
    for gnss in log.gnss:
        epoch = gnss.origin.epoch
        yield _stream(gnss.name, "gnss", gnss.time, gnss.origin)
    for reference in log.references:
        yield _stream(reference.name, "reference", reference.time, reference.origin)
    for speed in log.speeds:
        yield StreamSummary(
            speed.name, "speed", len(speed), _rate(speed.time), int(speed.time[0]), int(speed.time[-1]), epoch,
            gaps(speed.time), (), "m/s", "",
        )  # fmt: skip


def _rate(time: Nanoseconds) -> float | None:
    interval = sampling_interval(time)
    return None if np.isnan(interval) else 1 / interval


def _stream(
    name: str, kind: Kind, time: Nanoseconds, origin: Origin, *, units: str | None = None, frame: str | None = None,
    mended: bool = True,
) -> StreamSummary:  # fmt: skip
    return StreamSummary(
        name, kind, time.size, _rate(time), int(time[0]), int(time[-1]), origin.epoch, gaps(time),
        origin.repairs if mended else (), origin.units if units is None else units,
        origin.frame if frame is None else frame,
    )  # fmt: skip
