"""Trajectories of Applanix POSPac (SBET): rows of 17 doubles without a header."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "sbet"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
WIDTH = 17  #: numbers in a row
LEAST = 4  #: rows
WEEK_END = 604_801  #: s
LONGEST_STEP = 10.0  #: s
RISING = 0.95  #: least share of such steps; a trajectory may have gaps
HEIGHTS = (-12_000.0, 60_000.0)  #: m
FASTEST = 3000.0  #: m/s


def probe(head: bytes) -> bool:
    """Return whether the first rows have rising times of week, possible positions in radians, velocities and attitudes."""
    count = len(head) // (8 * WIDTH)
    if count < LEAST or b"\0" not in head:
        return False
    import numpy as np  # noqa: PLC0415 - text needs no numbers

    rows = np.frombuffer(head, "<f8", count * WIDTH).reshape(count, WIDTH)
    with np.errstate(invalid="ignore", over="ignore"):
        steps = np.diff(rows[:, 0])
        angles = np.abs(rows[:, [1, 2, 7, 8, 9, 10]]) <= np.array(
            [np.pi / 2, 2 * np.pi, np.pi, np.pi, 4 * np.pi, 4 * np.pi]
        )
        return bool(
            (rows[:, 0] >= 0).all() and (rows[:, 0] < 2 * WEEK_END).all() and ((steps > 0) & (steps <= LONGEST_STEP)).mean() > RISING
            and angles.all() and (rows[:, 1:3] != 0).any() and (rows[:, 3] > HEIGHTS[0]).all() and (rows[:, 3] < HEIGHTS[1]).all()
            and (np.abs(rows[:, 4:7]) < FASTEST).all() and np.ptp(rows[:, 1:3], axis=0).max() < 1
        )  # fmt: skip


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Return the trajectory as a reference.

    Raises:
        UnreadableLogError: the file has no whole row.
    """
    from imuwb.readers.tables.sbet_rows import streamed  # noqa: PLC0415 - a probe needs no rows

    return streamed(path)
