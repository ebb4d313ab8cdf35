"""The header and the rows of a raw inertial file of Inertial Explorer, in SI.

The header has 512 bytes without padding, a row 32: time of week (s), three gyros, three accelerometers. Numbers times the header's
scales are rates (deg/s, m/s²), or increments over a sample (deg, m/s), which times the header's rate are rates. Sources:
docs.novatel.com, Waypoint, Data Formats, "IMR File"; PSINS, imrfile.m (rows of a header's fields in order).
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.column_names import Column
from imuwb.readers.text.gravity import check_gravity
from imuwb.texts import counted
from imuwb.units import SECOND, unit

HEADER, ROW = 512, 32  #: bytes
BIG = 8  #: offset of the flag of big-endian numbers; the fields follow it
FIELDS = "diidddiid32s"  #: version, increments of angle, of velocity, rate, scales, kinds of time, bias of time, name
UTC = 1  #: kind of time
RATES = (0.1, 1e5)  #: Hz
LARGEST_SCALE = 1e3
LATEST = 2 * 604_800  #: s; a later time of week is damage
FORCE = Column(0, "accel", "accel", 0, unit("m/s²"))


@dataclass(frozen=True, slots=True)
class Header:
    """What a header states."""

    order: str  #: byte order
    gyro: float  #: deg/s for a step of an integer
    accel: float  #: m/s²
    units: str  #: of an integer in the file
    utc: bool
    bias: float  #: s
    name: str


def header_of(path: source.Source) -> Header:
    """Return what the header states.

    Raises:
        UnreadableLogError: it is cut, or states an impossible rate or scale.
    """
    head = source.head(path)
    if len(head) < HEADER:
        raise UnreadableLogError(f"{path}: the file ends within its header of {HEADER} bytes; copy it again")
    order = ">" if head[BIG] else "<"
    _, angles, velocities, rate, gyro, accel, kind, _, bias, name = struct.unpack_from(
        f"{order}{FIELDS}", head, BIG + 1
    )
    if not (RATES[0] <= rate <= RATES[1] and 0 < abs(gyro) < LARGEST_SCALE and 0 < abs(accel) < LARGEST_SCALE):
        raise UnreadableLogError(
            f"{path}: the header states a rate of {rate:g} Hz and scales of {gyro:g} and {accel:g}; a log has a rate of {RATES[0]:g} to "
            f"{RATES[1]:g} Hz, and scales that are not 0; the header is damaged"
        )
    units = f"{gyro:g} deg{'' if angles else '/s'}, {accel:g} m/s{'' if velocities else '²'}"
    shown = name.split(b"\0")[0].decode("ascii", "replace").strip()
    return Header(
        order, gyro * (rate if angles else 1), accel * (rate if velocities else 1), units, kind == UTC, bias, shown
    )


def streamed(path: source.Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the rates and specific forces, block by block.

    Raises:
        UnreadableLogError: as in ``header_of``, or the specific forces are in another unit.
    """
    header = header_of(path)
    row = np.dtype([("time", f"{header.order}f8"), ("gyro", f"{header.order}i4", 3), ("accel", f"{header.order}i4", 3)])
    signs = np.array([1.0, -1.0, -1.0]) if options.frame == "FLU" else np.ones(3)
    origin = Origin(header.units, f"{options.frame} (stated)" if options.frame else "FRD (assumed)", "log")
    notes, checked, damaged, rest, first = list[str](), False, 0, b"", HEADER
    with source.open_unpacked(path) as file:
        for block, _ in source.blocks(file, notes):
            data = rest + block
            if len(data) < first:
                rest = data
                continue
            rows = np.frombuffer(data, row, (len(data) - first) // ROW, first)
            rest, first = data[first + rows.size * ROW :], 0
            sound = np.isfinite(rows["time"]) & (rows["time"] >= 0) & (rows["time"] < LATEST)
            damaged += int(np.count_nonzero(~sound))
            rows = rows[sound]
            values = {
                "angular_rate": np.radians(rows["gyro"] * header.gyro) * signs,
                "specific_force": rows["accel"] * header.accel * signs,
            }
            checked = checked or (
                bool(rows.size) and check_gravity(Path(str(path)), values["specific_force"], (FORCE,))
            )
            time = np.rint(rows["time"] * SECOND).astype(np.int64)
            yield Batch("imu", "imu", time, values, origin, source.position(file))
    yield from map(Remark, (*notes, *_notes(header)))
    if damaged:
        yield Remark(Note("no_time", "rows without a usable time left out"), "imu", damaged)
    if rest:
        yield Remark(Note("row_cut", f"the last {counted(len(rest), 'byte')} are no whole row; the file is cut"))


def _notes(header: Header) -> Iterator[Note]:
    name, scale = header.name or "imu", "UTC" if header.utc else "GPS"
    yield Note(
        "week_unknown", f"{name}: times of the {scale} week without the week; they count from the start of the week"
    )
    if header.bias:
        yield Note(
            "time_bias",
            f"{name}: the header states a bias of {header.bias:g} s of the times, which is not applied: its sign is not documented",
        )
