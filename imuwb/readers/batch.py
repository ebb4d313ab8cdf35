"""What a reader yields: pieces of streams in SI units and FRD axes, in the file's order."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol, TypeAlias

from imuwb.arrays import Floats, Integers
from imuwb.log import Effect, Kind, Origin
from imuwb.notes import Note
from imuwb.readers.read_options import ReadOptions


@dataclass(frozen=True, eq=False, slots=True)
class Batch:
    """Consecutive rows of one stream.

    ``columns`` depends on the kind:

    * imu: ``angular_rate`` and ``specific_force`` (n, 3), ``temperature`` (n,); an axis that the sensor does not have is nan
      in all batches;
    * gnss: ``position``, ``velocity``, ``position_sigma``, ``velocity_sigma`` (n, 3), ``fix_type`` (n,);
    * reference: ``position``, ``velocity``, ``attitude``, ``position_sigma``, ``velocity_sigma``, ``attitude_sigma`` (n, 3);
    * pose: ``position`` (n, 3) m and ``quaternion`` (n, 4) w, x, y, z in a frame of their own, ``position_sigma`` (n, 3) m;
    * orientation: ``quaternion`` (n, 4) w, x, y, z of FRD relative to NED, ``sigma`` (n, 3) rad about north, east and down;
    * speed: ``speed`` (n,); temperature: ``temperature`` (n,);
    * velocity and fix: ``velocity`` and ``velocity_sigma`` (n, 3), or ``fix_type`` (n,): values of a receiver whose positions
      are in another stream.

    Triads of one IMU with different clocks come in different batches with the same stream name.
    """

    stream: str
    kind: Kind
    time: Integers  #: (n,) ns, as in the file; imuwb later repairs the order and repeated times
    columns: Mapping[str, Floats]
    origin: Origin = field(default_factory=Origin)
    bytes_read: int = 0  #: the reader's position in the file
    exact: bool = False  #: the times are the sensor's own; times of arrival, or in a log of unknown making, are not

    def __repr__(self) -> str:
        """Return stream, kind, rows and columns in a line."""
        return f"{self.stream}: {self.kind}, {self.time.size} rows of {', '.join(self.columns)}"


@dataclass(frozen=True, slots=True)
class Remark:
    """A note about the file, or, with ``stream`` and ``count``, a repair of that stream."""

    text: str  #: a ``Note``, if tests or programs need its id
    stream: str = ""
    count: int = 0
    effect: Effect = "lost"  #: effect of the repair on the stream
    truth: Mapping[str, str] = field(
        default_factory=dict[str, str]
    )  #: parameters that a simulator wrote, as in ``Log``
    settings: Mapping[str, float] = field(default_factory=dict[str, float])  #: of an autopilot, as in ``Log``
    devices: Mapping[str, Mapping[str, int]] = field(
        default_factory=dict[str, Mapping[str, int]]
    )  #: of an autopilot's IMUs, as in ``Log``


#: From the first rows of all streams to the first time of the wanted part and the time after its end, ns, with margins.
Limits: TypeAlias = Callable[[Iterable[Batch]], tuple[int, int]]


class CannotSeekError(Exception):
    """A reader cannot find the part that is wanted without reading the whole file; the file is then read from its beginning."""


def unused(names: Iterable[str], reason: str) -> Remark:
    """Return the remark that columns, topics or messages are not used, and why."""
    return Remark(Note("unused", f"not used: {', '.join(names)} ({reason})"))


def simulated(truth: Mapping[str, str]) -> Remark:
    """Return the remark of a log that states the parameters of its simulation."""
    parts = ", ".join(dict.fromkeys(name.partition(".")[0] for name in truth))
    text = f"a simulator made the log; imuwb info shows its {len(truth)} true parameters ({parts})"
    return Remark(Note("simulated", text), truth=truth)


class Reader(Protocol):
    """One file format: a module, or any object, with these names.

    Some names are optional. ``describe(path, options) -> LogSummary | None`` returns the summary that the file's index states, or None
    without an index. ``uses`` lists the names of the options that the format uses; a note names the others if they are set.
    ``part(path, options, limits)`` yields, as ``stream`` does, the first rows of each stream and those rows, of all streams, that lie
    within ``limits``, or more, in the file's order; it raises ``CannotSeekError``, at any time, where the file does not allow this.
    ``probe_folder(folder) -> bool`` returns whether a folder is a log of this format; ``stream`` then gets the folder.
    ``has_several_logs(folder) -> bool`` returns whether such a folder is several logs in truth.
    ``ranged = True`` states that the reader opens logs only by ``imuwb.readers.bytes.source.opened``, so that ``stream`` and
    ``describe`` may get a remote log in place of a path; other readers get the path of a copy. ``beside(name)`` returns the names
    of files that the reader looks for beside a log of some name; they are copied with a remote log.
    """

    format: str

    def probe(self, head: bytes) -> bool:
        """Return whether a file that begins with ``head`` (64 KiB, unpacked) has this format."""
        ...

    def stream(self, path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
        """Yield the file piece by piece; memory is bounded by the size of a piece.

        Raises:
            UnreadableLogError: the file has no readable message or row.
            UsageError: the file needs an option.
        """
        ...
