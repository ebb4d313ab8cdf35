"""Numbers picked out of a buffer of bytes, at any offsets, of all messages at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray


def gather(buffer: NDArray[np.uint8], at: NDArray[np.int64], kind: str, count: int = 0) -> NDArray[Any]:
    """Return the numbers that stand at some offsets of a buffer, aligned or not.

    Args:
        buffer: bytes.
        at: (n,) offsets; from each, all numbers must lie within the buffer.
        kind: numpy's name of their type with its byte order, such as ``<f8``.
        count: how many stand one behind the other.

    Returns:
        (n,) or, with a ``count``, (n, count).
    """
    dtype = np.dtype(kind)
    found = np.empty((at.size, max(count, 1)), dtype)
    if at.size:
        from imuwb.readers.bytes.pick import pick  # noqa: PLC0415 - see there

        # Bytes are copied as whole numbers of their size: a view in which each byte begins one.
        whole = f"u{dtype.itemsize}"
        view = np.ndarray((buffer.size - dtype.itemsize + 1,), whole, buffer, strides=(1,))
        pick(view, at, dtype.itemsize, found.view(whole))
    return found if count else found[:, 0]


def alike(keys: NDArray[Any], rows: NDArray[np.int64]) -> Iterator[tuple[int, NDArray[np.int64]]]:
    """Yield each key there is, and the rows that have it; at little cost where all have the same.

    Args:
        keys: (n,) integers.
        rows: (n,) what they are the keys of.
    """
    if not keys.size:
        return
    if (keys == keys[0]).all():
        yield int(keys[0]), rows
        return
    for key in np.unique(keys):
        yield int(key), rows[keys == key]
