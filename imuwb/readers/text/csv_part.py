"""A part of a text log by bisection of the file: its rows are looked up by their time, and the rest is not read.

This needs a file that is not packed, has a time in every row, and whose time rises at some places that are looked at.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

from pyarrow import DataType, RecordBatch

from imuwb.readers.assembly.time_order import CLOCK_STEP
from imuwb.readers.batch import CannotSeekError, Limits
from imuwb.readers.bytes import source
from imuwb.readers.bytes.bisection import bracket
from imuwb.readers.text.cells import blocks
from imuwb.readers.text.clock import Clock
from imuwb.readers.text.layout import Layout
from imuwb.readers.text.lines import Span
from imuwb.units import SECOND

BEGINNING = 12 * SECOND  #: ns; rows of this time from the start on are read: the first rows of a part's streams
PLACES = 64  #: places of the file at which its time must rise
FEWEST = 1 << 24  #: bytes; a smaller file is read as a whole
LOOKED_AT = 1 << 15  #: bytes that are looked at for a row
FINE = 1 << 18  #: bytes; a place is found with this precision


@dataclass(frozen=True, slots=True)
class Search:
    """The rows of a file between limits that its first rows show; ``blocks`` reads them."""

    clock: Clock
    limits: Limits  #: it knows the rows that were read before

    def blocks(
        self, path: Path, layout: Layout, kinds: Mapping[int, DataType], faults: Counter[str]
    ) -> Iterator[tuple[RecordBatch, int]]:
        """Yield some columns as ``cells.blocks`` does, of the first rows and of the rows of the part.

        Raises:
            CannotSeekError: the file cannot be searched.
        """
        size = source.size(path)
        if size < FEWEST or not self._searchable(path, layout):
            raise CannotSeekError
        read = partial(blocks, path, layout, kinds, faults)
        times = _Times(path, layout, self.clock, size)
        begun = times.place_after(times.first + BEGINNING)
        yield from read(span=Span(0, begun))
        start, end = self.limits(())
        yield from read(span=Span(max(begun, times.place_before(start)), max(begun, times.place_after(end))))

    def _searchable(self, path: Path, layout: Layout) -> bool:
        """Return whether a row has a time of its own, and can be read without the rows before it."""
        stamp = self.clock.stamp
        if stamp is None or (stamp.form is not None and not stamp.form.dated):
            return False
        with source.open_unpacked(path) as file:
            packed = source.is_packed(file)
        return not packed and layout.encoding.name == "utf-8" and not layout.encoding.carriage


class _Times:
    """The times at some places of a file."""

    def __init__(self, path: Path, layout: Layout, clock: Clock, size: int) -> None:
        """Look at places all over the file.

        Raises:
            CannotSeekError: the time does not rise, or a place has no time.
        """
        self._path, self._layout, self._clock, self._size = path, layout, clock, size
        self._known = {place: self._time(place) for place in (size * i // PLACES for i in range(PLACES))}
        self.first = self._known[0]
        if any(b < a - CLOCK_STEP for a, b in pairwise(self._known.values())):
            raise CannotSeekError

    def place_before(self, time: int) -> int:
        """Return the beginning of a line before all rows of a time, and at most ``FINE`` bytes before them."""
        return self._bracket(time)[0]

    def place_after(self, time: int) -> int:
        """Return the end of a line after all rows before a time, and at most ``FINE`` bytes after them."""
        return self._bracket(time)[1]

    def _bracket(self, time: int) -> tuple[int, int]:
        low, high = bracket(self._known, self._time, time, self._size, FINE)
        return self._line(low), self._line(high)

    def _time(self, place: int) -> int:
        """Return the time of the first row that has one from a place on."""
        span = Span(self._line(place), self._line(place + LOOKED_AT))
        for block, _ in blocks(self._path, self._layout, self._clock.kinds, Counter(), span=span):
            time, _ = self._clock.time(block, 0)
            if time.size:
                return int(time[0])
        raise CannotSeekError

    def _line(self, place: int) -> int:
        """Return the beginning of the first line that begins at a place or after it."""
        if place <= 0 or place >= self._size:
            return min(max(place, 0), self._size)
        with source.opened(self._path) as file:
            file.seek(place - 1)
            return min(place - 1 + len(file.readline()), self._size)
