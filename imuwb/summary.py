"""What a log contains, stream by stream; ``imuwb info`` prints it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from imuwb.log import Epoch, Kind, Log, Nanoseconds, Repair
from imuwb.sampling import sampling
from imuwb.texts import rows_text
from imuwb.units import SECOND


@dataclass(frozen=True, slots=True)
class StreamSummary:
    """One stream: rows, rate, times, gaps and repairs."""

    name: str
    kind: Kind
    count: int
    rate_hz: float | None  #: rows over duration without the gaps; None for a single row
    start_ns: int
    end_ns: int
    epoch: Epoch
    gaps: tuple[tuple[float, float], ...]  #: (start from the stream's first row, length), s
    repairs: tuple[Repair, ...]
    units: str  #: units in the file; a Log has SI
    frame: str  #: frame in the file; a Log has FRD or NED

    def __repr__(self) -> str:
        """Return name, kind, rows, rate, duration, gaps, units and frame in a line."""
        rows = rows_text(self.count, self.rate_hz, (self.end_ns - self.start_ns) / SECOND, self.gaps)
        return ", ".join(filter(None, (f"{self.name}: {self.kind}", rows, self.units, self.frame)))


@dataclass(frozen=True, slots=True)
class LogSummary:
    """A file and its streams."""

    path: str
    format: str
    hash: str  #: "sha256:...", or empty for a summary from an index
    streams: tuple[StreamSummary, ...]
    notes: tuple[str, ...]
    truth: Mapping[str, str] = field(default_factory=dict[str, str])  #: as in ``Log``

    def __repr__(self) -> str:
        """Return a line with path and format, then a line for each stream."""
        return "\n".join(
            (f"{self.path} ({self.format})", *(map(str, self.streams) if self.streams else ("no streams",)))
        )


def summarize(log: Log) -> LogSummary:
    """Return the summary of a log."""
    file = log.provenance
    return LogSummary(file.path, file.format, file.hash, tuple(_streams(log)), log.notes, log.truth)


def _streams(log: Log) -> Iterator[StreamSummary]:
    epoch: Epoch = "log"
    for imu in log.imus:
        origin, epoch = imu.origin, imu.origin.epoch
        for name, triad in imu.sensors().items():
            yield _stream(name, "imu", triad.time, epoch, origin.units, origin.frame, origin.repairs)
        if imu.temperature is not None:
            warm = imu.temperature
            yield _stream(warm.name, "temperature", warm.time, epoch, "°C", repairs=warm.repairs)
    for gnss in log.gnss:
        origin, epoch = gnss.origin, gnss.origin.epoch
        yield _stream(gnss.name, "gnss", gnss.time, epoch, origin.units, origin.frame, origin.repairs)
    for reference in log.references:
        origin = reference.origin
        yield _stream(
            reference.name, "reference", reference.time, origin.epoch, origin.units, origin.frame, origin.repairs
        )
    for orientation in log.orientations:
        origin = orientation.origin
        yield _stream(orientation.name, "orientation", orientation.time, origin.epoch, "quaternion", origin.frame)
    for speed in log.speeds:  # a speed and a pose state no clock of their own
        yield _stream(speed.name, "speed", speed.time, epoch, "m/s", repairs=speed.repairs)
    for pose in log.poses:
        yield _stream(pose.name, "pose", pose.time, epoch, "m, quaternion", "its own")


def _stream(
    name: str,
    kind: Kind,
    time: Nanoseconds,
    epoch: Epoch,
    units: str,
    frame: str = "",
    repairs: tuple[Repair, ...] = (),
) -> StreamSummary:
    clock = sampling(time)
    return StreamSummary(
        name, kind, time.size, clock.rate, int(time[0]), int(time[-1]), epoch, clock.gaps, repairs, units, frame
    )
