"""What every noise analysis asks of a series before it begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LARGEST = 1e12  #: rad/s or m/s²; no sensor puts out more


def unsuitable(values: Floats, fewest: int) -> str | None:
    """Return why a series cannot be analysed; None where it can."""
    if values.size < fewest:
        return f"the longest part without gaps has {values.size} samples; it takes {fewest}"
    lowest, highest = float(values.min()), float(values.max())
    if lowest == highest:
        return "the channel is constant: stuck, or not connected"
    if (most := max(-lowest, highest)) > LARGEST:
        return f"it holds a value of {most:.3g}, which no sensor puts out; leave its time out with --start and --end"
    return None
