"""What a log holds, stream by stream: the answer of ``imuwb info``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.sampling import sampling

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.log import Epoch, Log, Nanoseconds, Origin, Repair
    from imuwb.readers.batch import Kind


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
            speed.name, "speed", len(speed), sampling(speed.time).rate, int(speed.time[0]), int(speed.time[-1]), epoch,
            sampling(speed.time).gaps, (), "m/s", "",
        )  # fmt: skip


def _stream(
    name: str, kind: Kind, time: Nanoseconds, origin: Origin, *, units: str | None = None, frame: str | None = None,
    mended: bool = True,
) -> StreamSummary:  # fmt: skip
    return StreamSummary(
        name, kind, time.size, sampling(time).rate, int(time[0]), int(time[-1]), origin.epoch, sampling(time).gaps,
        origin.repairs if mended else (), origin.units if units is None else units,
        origin.frame if frame is None else frame,
    )  # fmt: skip
