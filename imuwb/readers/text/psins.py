"""Text files of PSINS's IMUs: three rows about the file, then increments in counts at even steps.

The rows are: pitch, roll, yaw (deg), velocity east, north, up (m/s); latitude, longitude (deg), height (m), start (s), step (ms), gravity
(m/s²); scales of the gyros (arcsec) and of the accelerometers (µg s) for each count. Increments are x right, y forward, z up; a seventh
number is what the step differs from the stated one (µs). Source: PSINS toolbox, imufile.m.
"""

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats
from imuwb.errors import UnreadableLogError
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.units import SECOND, unit

format = "psins"  # noqa: A001 - the contract's name
uses = ("frame",)
ABOUT = 3  #: rows about the file
CELLS = (6, 7)
LONGEST_STEP = 1.0  #: s
GRAVITY = (9.5, 10.0)  #: m/s²
LATEST = 9.2e9  #: s; later nanoseconds do not fit into int64


def probe(head: bytes) -> bool:
    """Return whether the first line is that of PSINS."""
    first = head[:200].split(b"\n")[0]
    return first.startswith(b"%") and b"PSINS" in first and b"SIMU" in first


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the IMU.

    Raises:
        UnreadableLogError: the file lacks the rows about itself, or a row is not like the others.
    """
    notes = list[str]()
    with source.open_unpacked(path) as file:
        text = source.whole(file, notes)
    rows = _rows(path, text)
    start, step, gravity = rows[1, 3], rows[1, 4] / 1000, rows[1, 5]
    if not (0 < step < LONGEST_STEP and GRAVITY[0] < gravity < GRAVITY[1] and abs(start) < LATEST):
        raise UnreadableLogError(
            f"{path}: its second row states a step of {rows[1, 4]:g} ms and a gravity of {gravity:g} m/s²; these are no values of a PSINS file"
        )
    counts = rows[ABOUT:]
    gyro = counts[:, :3] * rows[2, :3] * unit("arcsec").factor / step
    accel = counts[:, 3:6] * rows[2, 3:6] * 1e-6 * gravity / step
    seconds = np.arange(1, len(counts) + 1) * step
    late = np.cumsum(counts[:, 6]) * 1e-6 if counts.shape[1] == CELLS[1] else 0.0
    time = round(start * SECOND) + np.rint((seconds + late) * SECOND).astype(np.int64)
    columns = {"angular_rate": _in_frd(gyro, options), "specific_force": _in_frd(accel, options)}
    origin = Origin("arcsec, µg s (increments)", f"{options.frame} (stated)" if options.frame else "RFU (PSINS)", "log")
    yield Batch("imu", "imu", time, columns, origin, len(text))
    yield Remark(
        Note("shape", "read as a PSINS file of increments; its start is of a clock that the file does not name")
    )
    yield from map(Remark, notes)


def _in_frd(values: Floats, options: ReadOptions) -> Floats:
    if options.frame:
        return values * (1.0, -1.0, -1.0) if options.frame == "FLU" else values
    return values[:, [1, 0, 2]] * (1.0, 1.0, -1.0)


def _rows(path: Path, text: bytes) -> Floats:
    try:
        rows = np.loadtxt(io.BytesIO(text), comments="%", ndmin=2, encoding="utf-8")
    except (ValueError, UnicodeDecodeError) as error:
        raise UnreadableLogError(f"{path}: a row is not like the others: {error}; remove it") from error
    if rows.shape[1] not in CELLS or len(rows) <= ABOUT or not np.isfinite(rows).all():
        raise UnreadableLogError(
            f"{path}: {len(rows)} rows of {rows.shape[1]} numbers; a PSINS file has 3 rows, then increments of 6 or 7"
        )
    return rows
