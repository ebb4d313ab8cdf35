"""The folder ``oxts`` of KITTI's raw data: a file of one line for each sample, and their times in a file of their own.

A line has 30 numbers: latitude, longitude (deg), altitude (m), roll, pitch, yaw (rad; roll: left side up, pitch: front down, yaw:
counter-clockwise from east), velocity north, east, forward, leftward, up (m/s), acceleration x, y, z, f, l, u (m/s²), angular rate
x, y, z, f, l, u (rad/s), accuracies of position and velocity, and five numbers of status; x forward, y left, z up. Source: KITTI raw
data, oxts/dataformat.txt; pykitti, utils.py. The empty lines that some copies have in place of times are rows without a time.
"""

from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.errors import UnreadableLogError
from imuwb.log import BY_FILTER, Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.instants import form_of, nanoseconds

format = "kitti"  # noqa: A001 - the contract's name
uses = ("frame",)
CELLS = 30
TIMES, DATA = "timestamps.txt", "data"
FLU = (1.0, -1.0, -1.0)
NO_TIME = Note("no_time", "samples without a time left out")
ODD = Note("cell_count", "files without 30 numbers left out")


def probe(head: bytes) -> bool:
    """Return False: a log of this format is a folder."""
    return False


def probe_folder(folder: Path) -> bool:
    """Return whether a folder, or its folder ``oxts``, has times and a first sample of 30 numbers."""
    place = _place(folder)
    if place is None:
        return False
    first = next(iter(sorted((place / DATA).glob("*.txt"))), None)
    return first is not None and _numbers(first) is not None


def _place(folder: Path) -> Path | None:
    """Return the folder with the times; a user may also name the one above it, or that of the samples."""
    places = (folder, folder / "oxts", folder.parent)
    return next((p for p in places if (p / TIMES).is_file() and (p / DATA).is_dir()), None)


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the IMU and the solution of KITTI's inertial navigation system.

    Raises:
        UnreadableLogError: no sample has a time and 30 numbers.
    """
    place = _place(path)
    if place is None:
        raise UnreadableLogError(f"{path}: no {TIMES} and {DATA} in this folder")
    names = sorted((place / DATA).glob("*.txt"))
    times = _times(place / TIMES)
    numbers = [_numbers(name) for name in names]
    timed = [time for time, row in zip(times, numbers, strict=False) if time is not None and row is not None]
    rows = [row for time, row in zip(times, numbers, strict=False) if time is not None and row is not None]
    if not rows:
        raise UnreadableLogError(f"{path}: no sample has a line in {TIMES} and {CELLS} numbers in {DATA}")
    time, table = np.array(timed, np.int64), np.array(rows)
    signs = np.ones(3) if options.frame == "FRD" else np.array(FLU)
    origin = Origin("rad/s, m/s²", f"{options.frame} (stated)" if options.frame else "FLU (KITTI)", "unix")
    columns = {"angular_rate": table[:, 17:20] * signs, "specific_force": table[:, 11:14] * signs}
    size = sum(name.stat().st_size for name in names)
    yield Batch("imu", "imu", time, columns, origin, size)
    yield _solution(time, table, size)
    yield Remark(Note("shape", "read as KITTI oxts; the times have no zone, and are taken as UTC"))
    odd, untimed = sum(row is None for row in numbers), len(names) - len(rows)
    for note, count in ((ODD, odd), (NO_TIME, untimed - odd)):
        if count > 0:
            yield Remark(note, "imu", count)


def _solution(time: Integers, table: Floats, size: int) -> Batch:
    velocity = np.stack([table[:, 6], table[:, 7], -table[:, 10]], axis=1)
    heading = (np.pi / 2 - table[:, 5]) % (2 * np.pi)
    columns = {
        "position": np.column_stack([np.radians(table[:, :2]), table[:, 2]]),
        "velocity": velocity,
        "attitude": np.stack(
            [table[:, 3], -table[:, 4], np.where(heading > np.pi, heading - 2 * np.pi, heading)], axis=1
        ),
    }
    return Batch("oxts", "reference", time, columns, Origin("deg, m, m/s", f"ENU ({BY_FILTER})", "unix"), size)


def _times(path: Path) -> list[int | None]:
    """Return the time of each line, ns since 1970, None for a line without one."""
    texts = path.read_text("utf-8", "replace").splitlines()
    form = form_of(text.strip() for text in texts)
    if form is None or not form.dated:
        raise UnreadableLogError(f"{path}: its lines are no dates such as {datetime(2011, 9, 26, 13, 2, 25)}.594360375")  # noqa: DTZ001
    return [nanoseconds(text.strip(), form) for text in texts]


def _numbers(path: Path) -> list[float] | None:
    """Return the numbers of a file of one line; None if these are not 30."""
    try:
        row = [float(cell) for cell in path.read_text("ascii", "replace").split()]
    except ValueError:
        return None
    return row if len(row) == CELLS else None
