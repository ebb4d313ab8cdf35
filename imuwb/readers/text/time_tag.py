"""The clock of a text log from its time tag ``LOG.tag``, which RTKLIB's stream server writes beside a log.

A tag file has a header of 64 bytes, "TIMETAG RTKLIB" and the server's tick (ms) at the start, then the GPS time of the start (whole
seconds since 1970 as uint32, and the rest as double), then a record for each piece that was received: ticks since the start (ms)
and the size of the log after the piece, two uint32. The bytes are little-endian.

A piece arrives late, never early. The clock of the log is therefore the lower edge of arrival over device time; its slope is the
rate of the device's clock.
"""

import struct
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.notes import Note
from imuwb.readers.gps_time import ahead_of_utc
from imuwb.readers.text.trust import is_number
from imuwb.units import SECOND

MAGIC = b"TIMETAG RTKLIB"
HEADER = 76  #: bytes before the first record
MOST = 4000  #: records that are used
LEAST = 20  #: records that a clock needs
PIECE = 1 << 22  #: bytes
RATE_SPAN = 60.0  #: s; a shorter log does not show the rate of its clock
WRONG_RATE = 0.01  #: a rate that differs from 1 by more is no clock's
LATEST = 1.0  #: s; pieces whose delays scatter by more are not those of this log
EDGE = 0.02  #: share of the pieces that arrive before the lower edge
LONGEST_LINE = 4096  #: bytes


@dataclass(frozen=True, slots=True)
class TagClock:
    """A straight line from the device's time to Unix time."""

    start: int  #: ns since 1970 UTC, at which the server began
    device: float  #: s, the device's time at the start
    rate: float  #: true seconds in a second of the device's clock
    note: Note

    def unix(self, time: Integers) -> Integers:
        """Return device times, (n,) ns, as ns since 1970 UTC."""
        passed = (time - round(self.device * SECOND)) * self.rate
        return self.start + np.rint(passed).astype(np.int64)


def name_of(log: str) -> str:
    """Return the name of the tag of a log of some name."""
    return f"{log}.tag"


def tag_clock(path: Path, column: int, delimiter: str, factor: float) -> TagClock | Note | None:
    """Return the clock that the tag beside a log gives; a note if the tag does not fit the log; None without a tag.

    Args:
        path: the log.
        column: index of the column of the device's time.
        delimiter: of the columns; a blank means any run of blanks.
        factor: s in the unit of that column.
    """
    tag = path.with_name(name_of(path.name))
    head = _head(tag)
    if head is None:
        return None
    start, records = head
    ends = _line_ends(path)
    if ends.size < LEAST or records.shape[0] < LEAST:
        return Note(
            "time_tag_unused",
            f"{tag.name}: too few records for a clock; the time column counts from the log's own start",
        )
    lines: list[_Edge] = []
    # Where line ends were converted, the log has one byte a line less than the server received.
    for received in (ends, ends + np.arange(1, ends.size + 1)):
        inside = records[(records[:, 1] >= received[0]) & (records[:, 1] <= received[-1])]
        inside = inside[:: max(1, -(-inside.shape[0] // MOST))]
        rows = np.searchsorted(received, inside[:, 1], side="right") - 1
        edge = _lower_edge(_cells(path, ends, rows, column, delimiter) * factor, inside[:, 0] / 1000)
        lines.extend(() if edge is None else (edge,))
    line = min(lines, key=lambda edge: edge.scatter, default=None)
    if line is None:
        return Note(
            "time_tag_unused", f"{tag.name} does not fit the log; the time column counts from the log's own start"
        )
    text = (
        f"{tag.name} gives the time: its server began at {datetime.fromtimestamp(start / SECOND, UTC):%Y-%m-%d %H:%M:%S} UTC, a second of "
        f"the device is {line.rate:.6f} s, and a piece arrives {1000 * line.latency:.0f} ms late in the median; the server's own clock may be off"
    )
    return TagClock(start, line.device, line.rate, Note("time_tag", text))


def _head(tag: Path) -> tuple[int, Integers] | None:
    """Return the start, ns since 1970 UTC, and the records, (n, 2) ms and bytes; None if the file is no tag."""
    try:
        content = tag.read_bytes()
    except OSError:
        return None
    if not content.startswith(MAGIC) or len(content) < HEADER:
        return None
    whole, rest = struct.unpack_from("<Id", content, 64)
    if not 0.0 <= rest < 1.0:
        return None
    count = (len(content) - HEADER) // 8
    records = np.frombuffer(content, "<u4", 2 * count, HEADER).reshape(-1, 2).astype(np.int64)
    rising = np.append(True, (np.diff(records, axis=0) >= 0).all(axis=1))
    gps = datetime.fromtimestamp(whole, UTC)
    return (whole - ahead_of_utc(gps)) * SECOND + round(rest * SECOND), records[rising]


def _line_ends(path: Path) -> Integers:
    """Return the number of bytes up to the end of each line."""
    ends: list[Integers] = []
    done = 0
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            ends.append(np.flatnonzero(np.frombuffer(piece, np.uint8) == ord("\n")).astype(np.int64) + done + 1)
            done += len(piece)
    return np.concatenate(ends) if ends else np.zeros(0, np.int64)


def _cells(path: Path, ends: Integers, rows: Integers, column: int, delimiter: str) -> Floats:
    """Return a cell of some lines as numbers; nan if it is none."""
    values = np.full(rows.size, np.nan)
    with path.open("rb") as file:
        for i, row in enumerate(rows):
            begin = int(ends[row - 1]) if row > 0 else 0
            file.seek(begin)
            line = file.read(min(int(ends[row]) - begin, LONGEST_LINE)).decode("ascii", "replace")
            cells = line.split() if delimiter == " " else line.split(delimiter)
            if column < len(cells) and is_number(cells[column].strip()):
                values[i] = float(cells[column])
    return values


@dataclass(frozen=True, slots=True)
class _Edge:
    """The lower edge of arrival over device time."""

    device: float  #: s, the device's time at arrival time 0
    rate: float
    latency: float  #: s, median delay of a piece
    scatter: float  #: s, standard deviation of the delays


def _lower_edge(device: Floats, arrival: Floats) -> _Edge | None:
    """Return the lower edge; None if it is no straight line of a clock."""
    known = np.isfinite(device)
    device, arrival = device[known], arrival[known]
    if device.size < LEAST or np.ptp(device) <= 0:
        return None
    rate = 1.0
    if np.ptp(device) >= RATE_SPAN:
        rate = float(np.polyfit(device - device[0], arrival, 1)[0])
    late = arrival - rate * (device - device[0])
    edge, scatter = float(np.quantile(late, EDGE)), float(late.std())
    if abs(rate - 1) > WRONG_RATE or scatter > LATEST:
        return None
    return _Edge(float(device[0] - edge / rate), rate, float(np.median(late) - edge), scatter)
