"""Names for arrays, by what they hold."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from threading import RLock

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
Booleans = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

_BLOCK = 1 << 18  #: rows


def blocks_of(rows: int) -> Iterator[slice]:
    """Yield slices of a long array, block by block, for work that needs other arrays of the size of a block only."""
    return (slice(first, min(first + _BLOCK, rows)) for first in range(0, rows, _BLOCK))


def all_finite(values: Floats) -> bool:
    """Return whether all numbers are finite."""
    return all(bool(np.isfinite(values[rows]).all()) for rows in blocks_of(len(values)))


LARGE = 1 << 22  #: rows
_ALONE = RLock()  # work that is done alone may do other such work


def alone(rows: int) -> AbstractContextManager[object]:
    """Return a context for work with several arrays of some rows: of long records, one thread does such work at a time."""
    return _ALONE if rows > LARGE else nullcontext()
