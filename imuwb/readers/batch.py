"""What a reader yields: pieces of streams, already in SI and FRD, in the order of the file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, Protocol

from imuwb.errors import UsageError
from imuwb.log import Origin

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

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


class Reader(Protocol):
    """One file format: a module, or any object, with these names.

    It may also have ``describe(path) -> LogSummary | None``: what the file says of itself at no cost, such
    as in an index; None where it says nothing.
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
