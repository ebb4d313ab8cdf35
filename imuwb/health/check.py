"""All faults of a log, and a verdict for each stream."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.health.channel import channels
from imuwb.health.clocks import clock_faults
from imuwb.health.fault import RANK, Fault
from imuwb.health.inertial import inertial_faults
from imuwb.health.motion import segments
from imuwb.health.receivers import receiver_faults
from imuwb.health.repairs import repair_faults
from imuwb.health.spikes import lone_samples

if TYPE_CHECKING:
    from collections.abc import Iterator

    from imuwb.health.motion import Segment
    from imuwb.log import Floats, ImuStream, Log, Nanoseconds, Repair

WINDOWS = 400  #: in which the rate of a stream is counted over a log
FEWEST = 20  #: rows in a window
_VERDICTS = ("good", "usable: see what is said", "not to be trusted as it stands")


@dataclass(frozen=True, eq=False, slots=True)
class StreamHealth:
    """One stream: its verdict, and its rate over time."""

    name: str
    verdict: str
    time: Floats  #: (w,) s from the log's start
    rate: Floats  #: (w,) Hz


@dataclass(frozen=True, eq=False, slots=True)
class Health:
    """A log's streams and what is wrong with them, the worst first."""

    streams: tuple[StreamHealth, ...]
    faults: tuple[Fault, ...]
    segments: tuple[Segment, ...]  #: of one IMU: still or moving; none where that cannot be told
    segments_of: (
        str | None
    )  #: name of that IMU: the first of which it can be told, else the first; None: none was looked at


def check(log: Log, *, lines: bool = True, samples: bool = True) -> Health:
    """Return what is wrong with a log.

    Args:
        log: what was read.
        lines: look for periodic lines in still records too.
        samples: look at the IMUs' samples, the long part, besides clocks and receivers.
    """
    faults: list[Fault] = []
    found: list[tuple[str, Nanoseconds]] = []
    for name, time, repairs, inertial in _clocks(log):
        faults += repair_faults(name, repairs, time.size)
        faults += clock_faults(name, log.seconds(time), inertial=inertial)
        found.append((name, time))
    parts: dict[str, tuple[Segment, ...]] = {}
    for imu in log.imus if samples else ():
        parts[imu.name], own = _looked_at(log, imu, lines=lines)
        faults += own
    for gnss in log.gnss:
        faults += receiver_faults(log, gnss)
    faults += _apart(log)
    faults.sort(key=lambda fault: -RANK[fault.severity])
    streams = tuple(_stream(log, name, time, faults) for name, time in found)
    told = next((name for name, own in parts.items() if own), next(iter(parts), None))
    return Health(streams, tuple(faults), parts[told] if told is not None else (), told)


def _looked_at(log: Log, imu: ImuStream, *, lines: bool) -> tuple[tuple[Segment, ...], list[Fault]]:
    """Return when an IMU is still and when it moves, and what is wrong with its samples."""
    axes = channels(log, imu)
    lone = {axis: lone_samples(channel) for axis, channel in axes.items()}
    parts = segments(axes, lone)
    return parts, list(inertial_faults(log, imu, axes, lone, parts, lines=lines))


def _clocks(log: Log) -> Iterator[tuple[str, Nanoseconds, tuple[Repair, ...], bool]]:
    for imu in log.imus:
        triads = [t for t in (imu.angular_rate, imu.specific_force) if t is not None]
        same = len(triads) < 2 or np.array_equal(triads[0].time, triads[1].time)  # noqa: PLR2004 - gyro and accelerometer
        for i, triad in enumerate(triads[:1] if same else triads):
            name = imu.name if same else f"{imu.name} {('gyros', 'accelerometers')[i]}"
            yield name, triad.time, imu.origin.repairs if not i else (), True
    for stream in (*log.gnss, *log.references):
        yield stream.name, stream.time, stream.origin.repairs, False
    for speed in log.speeds:
        yield speed.name, speed.time, (), False


def _apart(log: Log) -> Iterator[Fault]:
    """Yield receivers whose times do not meet the IMU's: two clocks in one file."""
    for gnss in log.gnss:
        spans = [
            (t.time[0], t.time[-1]) for imu in log.imus for t in (imu.angular_rate, imu.specific_force) if t is not None
        ]
        if spans and not any(gnss.time[0] <= end and gnss.time[-1] >= start for start, end in spans):
            yield Fault(gnss.name, "its times and the IMU's do not meet: two clocks in one file", "fault",
                        consequence="they cannot be used together before one is shifted")  # fmt: skip


def is_of(fault: Fault, stream: str) -> bool:
    """Return whether a fault is one of a stream, or of one of its axes."""
    imu, _, sensor = stream.rpartition(" ")
    axes = {"gyros": f"{imu} gyro_", "accelerometers": f"{imu} accel_"}.get(sensor, f"{stream} ")
    return fault.stream == stream or fault.stream.startswith(axes)


def _stream(log: Log, name: str, time: Nanoseconds, faults: list[Fault]) -> StreamHealth:
    worst = max((RANK[f.severity] for f in faults if is_of(f, name)), default=0)
    at = log.seconds(time)
    count = int(min(WINDOWS, max(time.size // FEWEST, 1)))
    edges = np.linspace(float(at[0]), float(at[-1]), count + 1)
    width = (edges[-1] - edges[0]) / count
    rows = np.diff(np.searchsorted(at, edges)).astype(float)
    rate = rows / width if width > 0 else np.zeros(count)
    return StreamHealth(name, _VERDICTS[worst], (edges[:-1] + edges[1:]) / 2, rate)
