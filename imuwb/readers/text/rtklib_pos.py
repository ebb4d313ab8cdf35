"""RTKLIB solution files (.pos): latitude, longitude, height, sigmas and velocity of one receiver."""

import re
from collections import Counter
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.gps_time import GPS_EPOCH, WEEK, ahead_of_utc
from imuwb.readers.read_options import ReadOptions
from imuwb.units import SECOND, unix_nanoseconds

Row = tuple[int, list[float]]  #: time (ns), and the numbers after the time

format = "rtklib"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
LEFT_OUT = Note("bad_line", "lines left out: they are cut, or have text in place of numbers")
ROWS = 20_000  #: most rows in a batch
YEARS = range(1980, 2200)  #: a date outside is damage
#: RTKLIB's quality flag (no solution, fixed, float, SBAS, DGPS, single, PPP) -> MAVLink's fix type
FIX_TYPE = {0: 1, 1: 6, 2: 5, 3: 4, 4: 4, 5: 3, 6: 8}
#: column of a receiver, RTKLIB's names of its parts north, east, up, and the sign that makes up down
_TRIPLES = (
    ("position_sigma", ("sdn", "sde", "sdu"), 1), ("velocity", ("vn", "ve", "vu"), -1),
    ("velocity_sigma", ("sdvn", "sdve", "sdvu"), 1),
)  # fmt: skip
_HEADER = re.compile(rb"^%\s+(GPST|UTC|JST)\s+latitude\(deg\)\s+longitude\(deg\)\s+height\(m\)(?=\s|$)", re.MULTILINE)


def probe(head: bytes) -> bool:
    """Return whether the file has RTKLIB's header of geodetic positions in degrees."""
    return _HEADER.search(head) is not None


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the fixes.

    Raises:
        UnreadableLogError: the file has no line of numbers after its header.
    """
    fixes, scale, faults = 0, "GPST", Counter[str]()
    notes: list[str] = []
    for rows, names, scale, bytes_read in _tables(path, notes, faults):
        yield _batch(rows, names, scale, bytes_read)
        fixes += len(rows)
    yield from (Remark(note) for note in notes)
    if not fixes:
        raise UnreadableLogError(f"{path}: this RTKLIB file has no solution; check the log of its processing")
    yield from (Remark(fault, "gnss", count) for fault, count in faults.items())
    if scale == "GPST":
        yield Remark(Note("gps_time", "GPS time converted to UTC with the leap seconds of its date"))


def _tables(path: Path, notes: list[str], faults: Counter[str]) -> Iterator[tuple[list[Row], list[str], str, int]]:
    """Yield rows with the names of their columns, their time scale, and the bytes read."""
    names, scale, bytes_read = list[str](), "GPST", 0
    rows: list[Row] = []
    fault = source.packed_fault(path)
    with source.open_unpacked(path) as file:
        for line in _lines(source.pieces(file, notes), faults):
            bytes_read = source.position(file)
            if match := _HEADER.match(line):
                if rows:  # a second solution in the same file, perhaps with other columns
                    yield rows, names, scale, bytes_read
                    rows = []
                scale = match[1].decode()
                names = [re.sub(r"\(.*\)", "", name) for name in line[1:].decode("ascii", "replace").split()][1:]
            elif line.strip() and not line.startswith(b"%"):
                row = _row(line.split(), len(names), scale)
                if row is not None:
                    rows.append(row)
                elif fault:
                    notes.append(source.damaged(fault, "everything from the first odd line on is left out"))
                    break
                faults.update([LEFT_OUT] if row is None else [])
            if len(rows) == ROWS:
                yield rows, names, scale, bytes_read
                rows = []
    if rows:
        yield rows, names, scale, path.stat().st_size


def _lines(pieces: Iterator[bytes], faults: Counter[str]) -> Iterator[bytes]:
    """Yield lines; a last line without its end is taken as cut if it has fewer cells than the others, or a shorter last cell."""
    rest, least = b"", list[tuple[int, int]]()
    for block, last in source.lines(pieces):
        *whole, rest = block.split(b"\n")
        if last:
            break
        yield from whole
        sizes = [_size(line) for line in whole if line.strip() and not line.startswith(b"%")]
        least = [min(least + sizes)] if sizes else least
    if not rest.strip() or not least or _size(rest) >= least[0]:
        yield rest
    else:
        faults[LEFT_OUT] += 1


def _size(line: bytes) -> tuple[int, int]:
    """Return the number of cells, and the length of the last cell."""
    cells = line.split()
    return len(cells), len(cells[-1])


def _row(cells: list[bytes], columns: int, scale: str) -> Row | None:
    """Return time and numbers of a line; None if the line is cut or has other text."""
    try:
        row = _time(cells[0], cells[1], scale), [float(cell) for cell in cells[2 : 2 + columns]]
    except (ValueError, IndexError, OverflowError):
        return None
    return row if len(row[1]) == columns and columns and np.isfinite(row[1]).all() else None


def _time(first: bytes, second: bytes, scale: str) -> int:
    """Return ``yyyy/mm/dd hh:mm:ss.sss`` or ``week seconds`` as ns since 1970 UTC."""
    if b"/" in first:
        year, month, day = map(int, first.split(b"/"))
        hour, minute, rest = second.split(b":")
        whole, _, fraction = rest.partition(b".")
        when = datetime(year, month, day, int(hour), int(minute), tzinfo=UTC) + timedelta(seconds=int(whole))
        nanoseconds = int(fraction.ljust(9, b"0")[:9] or b"0")
    else:
        seconds = float(second)
        when = GPS_EPOCH + timedelta(seconds=int(first) * WEEK + int(seconds))
        nanoseconds = round((seconds % 1) * SECOND)
    if scale == "GPST":
        when -= timedelta(seconds=ahead_of_utc(when))
    elif scale == "JST":
        when -= timedelta(hours=9)
    if when.year not in YEARS:
        raise ValueError(f"year {when.year}")
    return unix_nanoseconds(when) + nanoseconds


def _batch(table: list[Row], names: list[str], scale: str, bytes_read: int) -> Batch:
    time, rows = np.array([stamp for stamp, _ in table]), np.array([row for _, row in table])
    at = {name: rows[:, i] for i, name in enumerate(names)}
    columns = {"position": np.stack([np.radians(at["latitude"]), np.radians(at["longitude"]), at["height"]], axis=1)}
    if "Q" in at:
        columns["fix_type"] = np.array([float(FIX_TYPE.get(int(q), 0)) for q in at["Q"]])
    for column, (north, east, up), sign in _TRIPLES:
        if {north, east, up} <= at.keys():
            columns[column] = np.stack([at[north], at[east], sign * at[up]], axis=1)
    return Batch("gnss", "gnss", time, columns, Origin(f"deg, m, {scale}", "NEU", "unix"), bytes_read)
