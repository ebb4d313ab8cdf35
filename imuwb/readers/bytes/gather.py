"""Numbers of all messages at once, from any offsets in a buffer of bytes."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.readers.bytes.loops import compiled_late, compiled_loop, worth_compiling


@dataclass(frozen=True, slots=True)
class Field:
    """A number, or ``count`` numbers, in a record."""

    name: str
    kind: str  #: numpy's name of its type, with the byte order
    count: int  #: 0 for a single number
    offset: int  #: bytes from the beginning of the record

    @property
    def end(self) -> int:
        """The offset after the field."""
        return self.offset + np.dtype(self.kind).itemsize * max(self.count, 1)


def columns(fields: Iterable[Field], buffer: Bytes, records: Integers) -> dict[str, NDArray[Any]]:
    """Return the fields of the records at some offsets of a buffer, {name: (n,) or (n, count)}."""
    return {f.name: gather(buffer, records + f.offset, f.kind, f.count) for f in fields}


def gather(buffer: Bytes, at: Integers, kind: str, count: int = 0) -> NDArray[Any]:
    """Return the numbers at some offsets of a buffer, aligned or not.

    Args:
        buffer: bytes.
        at: (n,) offsets; all numbers from each offset must lie within the buffer.
        kind: numpy's name of the numbers' type with its byte order, such as ``<f8``.
        count: how many numbers are read from each offset on; 0 for a single number.

    Returns:
        (n,) or, with a ``count``, (n, count).
    """
    dtype = np.dtype(kind)
    numbers = np.empty((at.size, max(count, 1)), dtype)
    if at.size:
        # Bytes are copied as whole numbers of their size, from a view in which a number begins at each byte.
        whole = f"u{dtype.itemsize}"
        view = np.ndarray((buffer.size - dtype.itemsize + 1,), whole, buffer, strides=(1,))
        if worth_compiling(numbers.nbytes):
            compiled_loop(_copy)(view, at, dtype.itemsize, numbers.view(whole))
        else:
            numbers.view(whole)[:] = view[at[:, None] + dtype.itemsize * np.arange(numbers.shape[1])]
    return numbers if count else numbers[:, 0]


@compiled_late
def _copy(view: NDArray[Any], at: Integers, size: int, numbers: NDArray[Any]) -> None:  # pragma: no cover - compiled
    """Copy, for each row, the numbers that are ``size`` bytes from each other from its offset on."""
    for i in range(at.size):
        for j in range(numbers.shape[1]):
            numbers[i, j] = view[at[i] + size * j]


def alike(keys: NDArray[Any], rows: Integers) -> Iterator[tuple[int, Integers]]:
    """Yield each key and the rows that have it. This is fast if all rows have the same key.

    Args:
        keys: (n,) integers.
        rows: (n,) the rows that the keys belong to.
    """
    if not keys.size:
        return
    if (keys == keys[0]).all():
        yield int(keys[0]), rows
        return
    order = np.argsort(keys, kind="stable")  # once for all keys, of which a file may have as many as rows
    for part in np.split(order, np.flatnonzero(np.diff(keys[order])) + 1):
        yield int(keys[part[0]]), rows[part]
