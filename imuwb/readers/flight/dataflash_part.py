"""A part of a binary DataFlash log, by bisection of the file on the time of its records; the rest is not read.

Besides the part, the beginning is read, and short pieces all over the file, whose fixes show the date. Where a piece has bytes of no
record, a format may be described elsewhere, and the file is read as a whole.
"""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

import numpy as np

from imuwb.arrays import Integers
from imuwb.readers.assembly.time_order import CLOCK_STEP
from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes import source
from imuwb.readers.bytes.bisection import bracket
from imuwb.readers.bytes.gather import gather
from imuwb.readers.flight.dataflash_records import RecordFormat, formats, walk
from imuwb.readers.flight.dataflash_streams import WANTED, batches_of
from imuwb.readers.flight.dataflash_tables import Tables
from imuwb.units import SECOND

BEGINNING = 12 * SECOND  #: ns; records of this time from the first one on are read: the first rows of a part's streams
FEWEST = 1 << 24  #: bytes; a smaller file is read as a whole
HEAD = 1 << 20  #: bytes at the beginning, which describe the records
PLACES = 32  #: places of the file at which its time must rise
PIECE = 1 << 17  #: bytes that are read at such a place; their fixes show the date
FINE = 1 << 18  #: bytes; a place is found with this precision
MICRO = 1000  #: ns


def part(path: Path, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the beginning, of some pieces, and of the records within the limits.

    Raises:
        CannotSeekError: the file cannot be searched by time.
    """
    size = path.stat().st_size
    if size < FEWEST:
        raise CannotSeekError
    with source.open_unpacked(path) as file:
        if source.is_packed(file):
            raise CannotSeekError
        records = _Records(file, size)
        begun = records.place_after(records.first + BEGINNING)
        pieces = [(0, begun), *((place, place + PIECE) for place in records.places)]
        found = batches_of(records.tables(pieces), [], size)
        batches = [x for x in found if isinstance(x, Batch)]
        # Times of the streams may count from 1970, those of the records count from power-up.
        ahead = min((int(b.time.min()) for b in batches if b.kind == "imu" and b.time.size), default=0) - records.first
        start, end = limits(batches)
        span = records.place_before(start - ahead - SECOND), records.place_after(end - ahead + SECOND)
        tables = records.tables([*pieces, span])
    yield from batches_of(tables, [], size)


class _Records:
    """The records of a file at any place."""

    def __init__(self, file: BinaryIO, size: int) -> None:
        """Look at places all over the file.

        Raises:
            CannotSeekError: the time does not rise, or a place has no time.
        """
        self._file, self._size = file, size
        self._formats = formats(np.frombuffer(self._bytes(0, HEAD), np.uint8))
        self._sizes = np.zeros(256, np.int64)
        for number, one in self._formats.items():
            self._sizes[number] = one.size
        self._timed = [n for n, one in self._formats.items() if one.name in WANTED and _counts_microseconds(one)]
        self.places = [size * i // PLACES for i in range(PLACES)]
        self._known = {place: self._time(place) for place in self.places}
        self.first = self._known[0]
        if any(b < a - CLOCK_STEP for a, b in pairwise(self._known.values())):
            raise CannotSeekError

    def tables(self, spans: list[tuple[int, int]]) -> Tables:
        """Return the records of some spans of the file, each record once, in the order of the file.

        Raises:
            CannotSeekError: bytes between the records belong to none.
        """
        tables, at = Tables(dict(self._formats), WANTED), 0
        for first, end in sorted(spans):
            begin = max(first, at)
            while begin < end:  # in blocks, because the tables of places are larger than the bytes
                data = np.frombuffer(self._bytes(begin, min(end, begin + source.BLOCK)), np.uint8)
                _, starts, _ = walk(data, last=False, sizes=self._sizes)
                if not starts.size:
                    break
                skip = int(starts[0]) if begin != at else 0  # the piece begins within a record
                taken = tables.take(data[skip:], last=False)
                if not taken:
                    break
                at = begin = begin + skip + taken
        if tables.skipped:
            raise CannotSeekError
        return tables

    def place_before(self, time: int) -> int:
        """Return a place before all records of a time (ns since power-up), at most ``FINE`` bytes before them."""
        return self._bracket(time)[0]

    def place_after(self, time: int) -> int:
        """Return a place after all records before a time (ns since power-up), at most ``FINE`` bytes after them."""
        return self._bracket(time)[1]

    def _bracket(self, time: int) -> tuple[int, int]:
        return bracket(self._known, self._time, time, self._size, FINE)

    def _time(self, place: int) -> int:
        """Return the time since power-up (ns) of the first record that has one from a place on."""
        data = np.frombuffer(self._bytes(place, place + (PIECE if place else HEAD)), np.uint8)
        numbers, starts, _ = walk(data, last=False, sizes=self._sizes)
        timed: Integers = starts[np.isin(numbers, self._timed)]
        if not timed.size:
            raise CannotSeekError
        return int(gather(data, timed[:1] + 3, "<u8")[0]) * MICRO

    def _bytes(self, begin: int, end: int) -> bytes:
        self._file.seek(begin)
        return self._file.read(end - begin)


def _counts_microseconds(one: RecordFormat) -> bool:
    """Return whether a record begins with a time in microseconds."""
    first = one.fields[0] if one.fields else None
    return first is not None and first.name == "TimeUS" and first.kind == "<u8"
