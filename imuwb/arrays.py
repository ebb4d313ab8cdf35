"""Names for arrays, by what they hold."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
Booleans = NDArray[np.bool_]
Bytes = NDArray[np.uint8]

_BLOCK = 1 << 18  #: rows


def all_finite(values: Floats) -> bool:
    """Return whether all numbers are finite; a long array is looked at block by block, so that no mask of its size is needed."""
    return all(bool(np.isfinite(values[i : i + _BLOCK]).all()) for i in range(0, len(values), _BLOCK))
