"""The compiled loop of ``gather``, apart: what reads no message need not wait for the compiler."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numba

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@numba.njit(cache=True, nogil=True, error_model="numpy")
def pick(
    view: NDArray[Any], at: NDArray[np.int64], size: int, found: NDArray[Any]
) -> None:  # pragma: no cover - compiled
    """Copy, for each row, the numbers that stand ``size`` bytes from each other from its offset on."""
    for i in range(at.size):
        for j in range(found.shape[1]):
            found[i, j] = view[at[i] + size * j]
