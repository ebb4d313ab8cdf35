"""What a reader yields: pieces of streams, already in SI and FRD, in the order of the file."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003 - the command line reads the annotations as the program runs
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Literal, Protocol, get_args

from imuwb.errors import UsageError
from imuwb.log import Epoch, Origin
from imuwb.readers.text.column_names import check_units

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from imuwb.log import Effect

Kind = Literal["imu", "gnss", "velocity", "fix", "speed", "temperature", "reference"]
SLOWEST, FASTEST = 1e-6, 1e8  #: Hz
TimeSource = Literal["header", "log", "publish"]


@dataclass(frozen=True, slots=True)
class ReadOptions:
    """How a file is to be read where it does not say so itself."""

    time_source: TimeSource = "header"  #: which of a message's stamps counts
    rate: float | None = None  #: Hz, for text without a time column
    columns: tuple[str, ...] = ()  #: names for a text file's columns, in order
    units: Mapping[str, str] = field(default_factory=dict[str, str])  #: {"gyro": "deg/s", "time": "ms"}
    frame: str | None = None  #: "FRD" or "FLU", for a file that does not say
    epoch: str | None = None  #: "unix", "boot" or "log": where a text file's times count from

    def __post_init__(self) -> None:
        """Check what can be checked before the file is open."""
        if self.rate is not None and not SLOWEST <= self.rate <= FASTEST:
            message = f"a rate of {self.rate} Hz: it must be positive: {SLOWEST:g} to {FASTEST:g} Hz"
            raise UsageError(message)
        if self.time_source not in ("header", "log", "publish"):
            message = f"time source {self.time_source!r}: it is header, log or publish"
            raise UsageError(message)
        if self.frame not in (None, "FRD", "FLU"):
            message = f"frame {self.frame!r}: it is FRD (forward, right, down) or FLU (forward, left, up)"
            raise UsageError(message)
        if self.epoch not in (None, *get_args(Epoch)):
            message = f"epoch {self.epoch!r}: it is unix (UTC), boot (power-up) or log (its start)"
            raise UsageError(message)
        check_units(self.units)

    def unused(self, uses: Collection[str]) -> tuple[str, ...]:
        """Return the names of the options that are given but not among those that a format uses."""
        silent = ReadOptions()
        given = (f.name for f in fields(self) if getattr(self, f.name) != getattr(silent, f.name))
        return tuple(name for name in given if name not in uses)


@dataclass(frozen=True, eq=False, slots=True)
class Batch:
    """Consecutive rows of one stream.

    ``columns`` by kind: imu ``angular_rate`` and ``specific_force`` (n, 3), ``temperature`` (n,);
    gnss ``position``, ``velocity``, ``position_sigma``, ``velocity_sigma`` (n, 3), ``fix_type`` (n,);
    reference ``position``, ``velocity``, ``attitude`` (n, 3); speed ``speed`` (n,); velocity, of a receiver whose positions are a stream of their own, ``velocity`` and ``velocity_sigma`` (n, 3); fix, likewise, ``fix_type`` (n,); temperature ``temperature`` (n,). Triads of one IMU on clocks of their own
    come in batches of their own, under one stream name.
    """

    stream: str
    kind: Kind
    time: NDArray[np.int64]  #: (n,) ns, as found: order and repeats are mended later
    columns: Mapping[str, NDArray[np.float64]]
    origin: Origin = field(default_factory=Origin)
    bytes_read: int = 0  #: how far into the file the reader is


@dataclass(frozen=True, slots=True)
class Remark:
    """Something to tell about a file (or, with ``stream``, of a stream); ``count`` makes it a repair."""

    text: str
    stream: str = ""
    count: int = 0
    effect: Effect = "lost"  #: of the repair


class Reader(Protocol):
    """One file format: a module, or any object, with these names.

    It may also have ``describe(path) -> LogSummary | None``: what the file says of itself at no cost, such
    as in an index, None where it says nothing; and ``uses``, the names of the options that it looks at: that
    others are given is then told as a note.
    """

    format: str

    def probe(self, head: bytes) -> bool:
        """Return whether a file that begins with ``head`` (64 KiB, unpacked) is of this format."""
        ...

    def stream(self, path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
        """Yield the file piece by piece, with memory bounded by a piece.

        Raises:
            UnreadableLogError: not one message or row can be read.
        """
        ...
