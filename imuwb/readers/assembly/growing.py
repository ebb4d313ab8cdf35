"""The rows of one stream as they are read: they stand in memory once, in the arrays that the log gets."""

import sys
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats, Integers
from imuwb.readers.batch import Batch

SMALL = 1 << 20  #: bytes; pieces of less are joined at the end
SPARE = 1.05  #: rows for which there is room, over those that the share of the file that is read lets expect
MOST = 64  #: factor by which the room grows at most, because the first rows may show the share badly
GROWTH = 1.5  #: factor by which the room grows where this is too little


class Growing:
    """An array that grows at its end. Room that no row fills takes no memory, because the system gives it when it is written."""

    def __init__(self, most: int = sys.maxsize) -> None:
        """Begin without rows; no room is made for more bytes than ``most`` before rows need it."""
        self._most = most
        self._pieces: list[NDArray[Any]] = []
        self._room: NDArray[Any] | None = None
        self._rows = 0

    def add(self, values: NDArray[Any], share: float) -> None:
        """Add rows.

        Args:
            values: (n, ...) rows.
            share: of all rows, which with these are there, about; 0: unknown.
        """
        self._rows += len(values)
        if self._room is None:
            self._pieces.append(values)
            if len(self._pieces) > 1 and sum(piece.nbytes for piece in self._pieces) > SMALL:
                self._move(share)
            return
        if self._rows > len(self._room) or np.result_type(self._room, values) != self._room.dtype:
            self._pieces = [self._room[: self._rows - len(values)], values]
            self._move(share)
        else:
            self._room[self._rows - len(values) : self._rows] = values

    def taken(self) -> NDArray[Any]:
        """Return all rows; they are no longer kept here."""
        pieces, self._pieces = self._pieces, []
        room, self._room = self._room, None
        if room is not None:
            return room[: self._rows]
        return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)

    def _move(self, share: float) -> None:
        """Move all pieces into an array with room for more."""
        expected = int(SPARE * self._rows / share) if share else 0
        one = max(self._pieces[0].nbytes // max(len(self._pieces[0]), 1), 1)
        size = max(min(expected, MOST * self._rows, self._most // one), int(GROWTH * self._rows))
        room = np.empty((size, *self._pieces[0].shape[1:]), np.result_type(*self._pieces))
        at = 0
        for piece in self._pieces:
            room[at : at + len(piece)] = piece
            at += len(piece)
        self._pieces, self._room = [], room


class GrowingRows:
    """The batches of one stream with one set of columns, joined as they come."""

    def __init__(self, first: Batch, size: int, most: int = sys.maxsize) -> None:
        """Begin without rows.

        Args:
            first: the first batch, without rows of its own here; its columns and its origin are those of all.
            size: bytes of the file.
            most: bytes that the rows of all streams may take.
        """
        self.first = replace(first, time=first.time[:0].copy(), columns={})
        self._size = size
        self._time = Growing(most)
        self._columns = {name: Growing(most) for name in first.columns}

    def add(self, batch: Batch) -> None:
        """Add the rows of a batch."""
        share = min(batch.bytes_read / self._size, 1.0) if self._size else 0.0
        self._time.add(batch.time, share)
        for name, column in self._columns.items():
            column.add(batch.columns[name], share)

    def taken(self) -> tuple[Integers, dict[str, Floats]]:
        """Return the time and the columns; they are no longer kept here."""
        return self._time.taken(), {name: column.taken() for name, column in self._columns.items()}
