"""Binary IMU files of KF-GINS and OB_GINS: rows of doubles without a header, increments over the time between rows.

A row is the time of the GPS week (s), three attitude increments (rad), three velocity increments (m/s), forward-right-down, and
perhaps the speed of an odometer (m/s). Source: i2Nav-WHU/KF-GINS, README.md and src/fileio/imufileloader.h.
"""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "kf_gins"  # noqa: A001 - the contract's name
uses = ("frame", "epoch")
WIDTHS = (7, 8)  #: numbers in a row
LEAST = 8  #: rows
WEEK_END = 604_801  #: s
LONGEST_STEP = 1.0  #: s
RISING = 0.95  #: least share of such steps; a log may have gaps
LARGEST_ANGLE = 1.0  #: rad in a step
GRAVITY = (3.0, 30.0)  #: m/s²; the median specific force of a vehicle lies in between


def probe(head: bytes) -> bool:
    """Return whether the first rows have rising times of week and increments of about one gravity."""
    return b"\0" in head and _width(head) > 0


def _width(head: bytes) -> int:
    """Return how many numbers a row has; 0 for another file."""
    import numpy as np  # noqa: PLC0415 - text needs no numbers

    for width in WIDTHS:
        count = len(head) // (8 * width)
        if count < LEAST:
            continue
        rows = np.frombuffer(head, "<f8", count * width).reshape(count, width)
        with np.errstate(invalid="ignore", over="ignore"):
            steps = np.diff(rows[:, 0])
            if not (np.isfinite(rows).all() and (rows[:, 0] >= 0).all() and (rows[:, 0] < WEEK_END).all()):
                continue
            if ((steps > 0) & (steps <= LONGEST_STEP)).mean() < RISING or not (
                np.abs(rows[:, 1:4]) < LARGEST_ANGLE
            ).all():
                continue
            force = float(np.median(np.linalg.norm(rows[1:, 4:7], axis=1) / np.median(steps)))
        if GRAVITY[0] < force < GRAVITY[1]:
            return width
    return 0


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rates and specific forces.

    Raises:
        UnreadableLogError: the rows are no increments.
    """
    from imuwb.notes import Note  # noqa: PLC0415 - a probe needs no tables
    from imuwb.readers.bytes import source  # noqa: PLC0415
    from imuwb.readers.tables.array_tables import array_table, doubles  # noqa: PLC0415
    from imuwb.readers.tables.arrow_tables import streamed  # noqa: PLC0415

    width = _width(source.head(path))
    table = array_table({str(i): column for i, column in enumerate(doubles(path, width).T)})
    yield from streamed(path, options, lambda _: table, named=False)
    yield Remark(
        Note("week_unknown", "the file states times of week without the week; times count from the start of the week")
    )
    rest = source.size(path) % (8 * width)
    if rest and not source.head(path).startswith(source.GZIP_MAGIC):
        yield Remark(Note("row_cut", f"the last {rest} bytes are no whole row; the file is cut"))
