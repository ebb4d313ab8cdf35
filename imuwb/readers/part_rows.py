"""Keeps the rows of a part while a log is read, so that memory follows the part and not the file.

Of every stream the first rows are kept too: they show the log's start, the clocks and the names of all IMUs, so the rest is cut
as it is cut from a whole log. Rows that are out of order or repeated are repaired in a part as in the whole log. A clock that is
set back, or a damaged stamp, may change the times of all later rows: then the part cannot be read alone.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Booleans
from imuwb.errors import UsageError
from imuwb.log import Log
from imuwb.readers.assembly.assemble import Key, finite_rows
from imuwb.readers.assembly.time_order import CLOCK_STEP, END_STEP, LATEST
from imuwb.readers.batch import Batch, Remark
from imuwb.selection import FAR, Part, limits, separations
from imuwb.units import SECOND

MARGIN = 10 * SECOND  #: ns; rows that are kept before and after the part: late rows, and rows that are joined to others
NEAR = MARGIN // 2  #: ns; by so much a start that was taken while the log was read may differ from the log's start
BEGIN = MARGIN  #: ns; every stream keeps its rows of this time from its first row on; they show how its stamps scatter
FEWEST = 16  #: rows; every stream keeps at least as many first rows
NOTHING = (FAR, -FAR)
_STARTING = ("gnss", "speed", "reference")  #: kinds that may be the log's start, beside the sensors of an IMU


@dataclass(slots=True)
class _Stream:
    """What is known so far of one stream with one set of columns."""

    first: int | None = None  #: ns, of the first usable row
    last: int | None = None  #: ns, of the last row
    begun: int = 0  #: usable first rows that are kept


class PartRows:
    """The rows of a part, for one reading of a log."""

    def __init__(self, part: Part, *, zero: int | None = None, every_imu: bool = False) -> None:
        """Set the part.

        Args:
            part: the part.
            zero: ns; the log's start, if it is known.
            every_imu: whether all IMUs are kept, because assembly makes the wanted one of several.
        """
        self._part, self._known, self._every_imu = part, zero, every_imu
        self.reset()

    def reset(self) -> None:
        """Forget the rows, before the log is read from its beginning again."""
        self._zero = self._known
        self._streams: dict[Key, _Stream] = {}
        self._earliest = FAR  #: ns; first time so far
        self._epochs: set[str] = set()
        self._zeros: set[int] = set()  #: the starts with which rows were left out
        self.sought = False  #: whether the reader asked for the limits, so that it may read only the part
        self.in_order = True  #: whether no clock was set back and no stamp is damaged

    def kept(self, parts: Iterable[Batch | Remark]) -> Iterator[Batch | Remark]:
        """Yield the remarks, and the rows of the part with their margins."""
        for part in parts:
            if isinstance(part, Remark):
                yield part
                continue
            rows = self._rows(part)
            if rows.all():
                yield part
            elif rows.any():
                columns = {name: values[rows] for name, values in part.columns.items()}
                yield replace(part, time=part.time[rows], columns=columns)

    def limits(self, batches: Iterable[Batch]) -> tuple[int, int]:
        """Return the first time of the part and the time after its end, ns, with their margins.

        Args:
            batches: the first rows of all streams, which show the log's start and clock.
        """
        self.sought = True
        for batch in batches:
            self._note_start(batch)
        self._zero = self._earliest if self._zero is None else self._zero
        return self._limits()

    def near(self, log: Log) -> bool:
        """Return whether rows were left out with the log's start, or near to it."""
        return all(abs(zero - (log.zero or 0)) <= NEAR for zero in self._zeros)

    def whole_imu(self, log: Log) -> bool:
        """Return whether no row of the wanted IMU was left out because it came as a row of another."""
        names = {name for name, kind, _ in self._streams if kind == "imu"}
        # Where assembly has joined two IMUs to one, a name is missing.
        return all(map(self._wanted, names)) or names <= {imu.name for imu in log.imus}

    def _rows(self, batch: Batch) -> Booleans:
        stream = self._streams.setdefault((batch.stream, batch.kind, tuple(batch.columns)), _Stream())
        self._check_order(stream, batch)
        self._note_start(batch)
        rows = _beginning(stream, batch)
        if batch.kind == "imu" and not self._wanted(batch.stream):
            return rows
        first, last = self._limits()
        return rows | ((batch.time >= first) & (batch.time < last))

    def _wanted(self, name: str) -> bool:
        imu = self._part.imu
        if imu is None or self._every_imu:
            return True
        return name == imu or any({name, *name.split("+")} & set(pair) for pair in separations(imu))

    def _check_order(self, stream: _Stream, batch: Batch) -> None:
        time = batch.time[np.abs(batch.time) < LATEST]
        if not time.size:
            return
        steps = np.diff(time, prepend=time[0] if stream.last is None else stream.last)
        self.in_order &= bool(steps.min() >= -CLOCK_STEP and steps.max() <= END_STEP)
        stream.last = int(time[-1])

    def _note_start(self, batch: Batch) -> None:
        if batch.kind in ("imu", "gnss", "reference"):
            self._epochs.add(batch.origin.epoch)
        sensor = batch.kind == "imu" and batch.columns.keys() & {"angular_rate", "specific_force"}
        if (sensor or batch.kind in _STARTING) and batch.time.size and batch.time.min() < self._earliest:
            usable = batch.time[_usable(batch)]
            self._earliest = min(self._earliest, int(usable.min())) if usable.size else self._earliest

    def _limits(self) -> tuple[int, int]:
        """Return the limits with margins; nothing is between them if the part cannot be had, for which ``select`` gives the reason."""
        if self._part.start is None and self._part.end is None:
            return -FAR, FAR
        zero = self._zero if self._zero is not None else self._earliest
        if zero == FAR:
            return -FAR, FAR
        self._zeros.add(zero)
        try:
            first, last = limits(self._part, zero, "unix" if "unix" in self._epochs else "log")
        except UsageError:
            return NOTHING
        return max(first, MARGIN - FAR) - MARGIN, min(last, FAR - MARGIN) + MARGIN


def _usable(batch: Batch) -> Booleans:
    """Return the rows that assembly may use: their values are finite and their times possible."""
    return finite_rows(batch.kind, batch.time.size, batch.columns) & (np.abs(batch.time) < LATEST)


def _beginning(stream: _Stream, batch: Batch) -> Booleans:
    """Return which rows belong to the first ones of a stream."""
    rows = np.zeros(batch.time.size, dtype=bool)
    if stream.begun < FEWEST:
        usable = np.flatnonzero(_usable(batch))
        rows[usable[: FEWEST - stream.begun]] = True
        stream.begun += min(usable.size, FEWEST - stream.begun)
        if stream.first is None and usable.size:
            stream.first = int(batch.time[usable[0]])
    if stream.first is not None:
        rows |= batch.time <= stream.first + BEGIN
    return rows
