"""Rows of a stream: a time each, and columns of values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from imuwb.log import Effect, Floats, Kind, Nanoseconds, Origin
    from imuwb.notes import Note


@dataclass(frozen=True, eq=False, slots=True)
class Rows:
    """All rows of one stream with the same columns."""

    stream: str
    kind: Kind
    origin: Origin
    time: Nanoseconds  #: (n,) ns
    columns: dict[str, Floats]  #: (n,) or (n, 3) each


@dataclass(frozen=True, slots=True)
class Fault:
    """A kind of fault that assembly repairs."""

    what: Note
    effect: Effect = "lost"


def taken(
    time: Nanoseconds, columns: dict[str, Floats], rows: NDArray[np.bool_] | NDArray[np.int64]
) -> tuple[Nanoseconds, dict[str, Floats]]:
    """Return some rows of time and columns, by mask or by number."""
    return time[rows], {name: values[rows] for name, values in columns.items()}
