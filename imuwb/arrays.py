"""Names for arrays, by what they hold."""

from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from threading import RLock
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
Booleans = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

Number = TypeVar("Number", np.float64, np.int64)

_BLOCK = 1 << 18  #: rows


def blocks_of(rows: int, block: int = _BLOCK) -> Iterator[slice]:
    """Yield slices of a long array, block by block, for work that needs other arrays of the size of a block only."""
    return (slice(first, min(first + block, rows)) for first in range(0, rows, block))


def standard_deviation(values: Floats) -> float:
    """Return the standard deviation of many numbers, without other arrays of their size."""
    mean = float(values.mean())
    return (sum(float(np.square(values[rows] - mean).sum()) for rows in blocks_of(values.size)) / values.size) ** 0.5


def step_blocks(time: NDArray[Number]) -> Iterator[NDArray[Number]]:
    """Yield the differences between neighbours of a long array, block by block; none for fewer than two rows."""
    return (np.diff(time[rows.start : rows.stop + 1]) for rows in blocks_of(time.size - 1))


def step_range(time: Integers) -> tuple[int, int]:
    """Return the smallest and the largest difference between neighbours of at least two rows."""
    ends = [(int(steps.min()), int(steps.max())) for steps in step_blocks(time)]
    return min(low for low, _ in ends), max(high for _, high in ends)


def all_finite(values: Floats) -> bool:
    """Return whether all numbers are finite."""
    return all(bool(np.isfinite(values[rows]).all()) for rows in blocks_of(len(values)))


LARGE = 1 << 22  #: rows
_ALONE = RLock()  # work that is done alone may do other such work


def alone(rows: int) -> AbstractContextManager[object]:
    """Return a context for work with several arrays of some rows: of long records, one thread does such work at a time."""
    return _ALONE if rows > LARGE else nullcontext()
