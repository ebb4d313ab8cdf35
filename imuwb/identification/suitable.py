"""What every noise analysis asks of a series before it begins."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LARGEST = 1e12  #: rad/s or m/s²; no sensor puts out more


def unsuitable(values: Floats, fewest: int) -> str | None:
    """Return why a series cannot be analysed; None where it can."""
    if values.size < fewest:
        return f"the longest part without gaps has {values.size} samples; it takes {fewest}"
    if np.ptp(values) == 0:
        return "the channel is constant: stuck, or not connected"
    if (most := float(np.abs(values).max())) > LARGEST:
        return f"it holds a value of {most:.3g}, which no sensor puts out; leave its time out with --start and --end"
    return None
