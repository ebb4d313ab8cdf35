"""One thing that is wrong, or worth knowing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Severity = Literal["note", "warning", "fault"]
RANK: dict[Severity, int] = {"note": 0, "warning": 1, "fault": 2}


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a stream, or an axis of it."""

    stream: str
    what: str
    severity: Severity
    count: int = 1
    start: float | None = None  #: s from the log's start, where it (first) is; None: all along, or not known
    length: float | None = None  #: s, of the longest
    consequence: str = ""


def runs(inside: NDArray[np.bool_]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return first row and length of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
    return edges[::2], edges[1::2] - edges[::2]
