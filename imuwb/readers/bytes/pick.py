"""The compiled loop of ``gather``, apart: what reads no message need not wait for the compiler."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from imuwb.compiled import compiled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


@compiled()
def pick(
    view: NDArray[Any], at: NDArray[np.int64], size: int, found: NDArray[Any]
) -> None:  # pragma: no cover - compiled
    """Copy, for each row, the numbers that stand ``size`` bytes from each other from its offset on."""
    for i in range(at.size):
        for j in range(found.shape[1]):
            found[i, j] = view[at[i] + size * j]
