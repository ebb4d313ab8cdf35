"""Logs of the format plugin_name: a line of text, then rows of seven numbers in binary.

The file begins with ``plugin_name 1`` and a line end. Each row is a time (int64, ns from power-up) and six numbers (float32):
angular rate about x, y, z (rad/s) and specific force along x, y, z (m/s²), forward-right-down, all little-endian.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from imuwb.errors import UnreadableLogError
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

FIRST = b"plugin_name 1\n"
ROW = np.dtype([("time", "<i8"), ("rate", "<f4", 3), ("force", "<f4", 3)])
PIECE = 65_536  #: rows that are read at once, so that memory does not grow with the file
IMU = "/imu"

format = "plugin_name"
uses: tuple[str, ...] = ()  #: options of reading that the format needs; it states everything itself


def probe(head: bytes) -> bool:
    """Return whether a file begins as this format does."""
    return head.startswith(FIRST)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rows piece by piece.

    Raises:
        UnreadableLogError: the file is of another format, or has no whole row.
    """
    del options  # the format states units, frame and clock itself
    with path.open("rb") as file:
        if file.read(len(FIRST)) != FIRST:
            raise UnreadableLogError(
                f"{path}: it does not begin with {FIRST.decode().strip()!r}; it is no log of this format"
            )
        found = False
        while content := file.read(PIECE * ROW.itemsize):
            whole = len(content) // ROW.itemsize
            if whole:
                rows = np.frombuffer(content, ROW, whole)
                finite = np.isfinite(rows["rate"]).all(axis=1) & np.isfinite(rows["force"]).all(axis=1)
                if not finite.all():
                    yield Remark(
                        Note("not_finite", "rows that are no numbers are left out"), IMU, int(np.count_nonzero(~finite))
                    )
                rows = rows[finite]
                found = found or bool(rows.size)
                columns = {"angular_rate": rows["rate"].astype(float), "specific_force": rows["force"].astype(float)}
                origin = Origin("gyro rad/s, accel m/s²", "FRD", "boot")
                yield Batch(IMU, "imu", rows["time"].astype(np.int64), columns, origin, file.tell(), exact=True)
            if len(content) % ROW.itemsize:
                yield Remark(Note("cut", "the last row is cut, and left out"), IMU, 1)
        if not found:
            raise UnreadableLogError(f"{path}: it has no whole row; copy the file again")
