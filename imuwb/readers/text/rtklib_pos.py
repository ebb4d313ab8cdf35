"""RTKLIB solution files (.pos): latitude, longitude, height, sigmas and velocity of one receiver."""

from __future__ import annotations

import re
from collections import Counter
from datetime import UTC, datetime, timedelta
from typing import TYPE_CHECKING

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.log import SECOND, Origin
from imuwb.readers.assembly.gps_time import GPS_EPOCH, WEEK, ahead_of_utc
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.bytes import source
from imuwb.readers.text.trust import DAMAGED

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    Row = tuple[int, list[float]]  #: ns, and the numbers behind the time

format = "rtklib"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
LEFT_OUT = "lines that are cut or no numbers left out"
ROWS = 20_000  #: in a batch
YEARS = range(1980, 2200)  #: what a GNSS receiver may say
#: RTKLIB's quality flag as MAVLink's fix type: fixed, float, SBAS, DGPS, single, PPP.
FIX_TYPE = {1: 6, 2: 5, 3: 4, 4: 4, 5: 3, 6: 8}
_HEADER = re.compile(rb"^%\s+(GPST|UTC|JST)\s+latitude\(deg\)\s+longitude\(deg\)\s+height\(m\)(?=\s|$)", re.MULTILINE)


def probe(head: bytes) -> bool:
    """Return whether the file has RTKLIB's header of geodetic positions in degrees."""
    return _HEADER.search(head) is not None


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the fixes.

    Raises:
        UnreadableLogError: no line of numbers under the header.
    """
    del options  # the format says everything itself
    done, scale, bad = 0, "GPST", Counter[str]()
    trouble: list[str] = []
    for rows, names, scale, read in _tables(path, trouble, bad):
        yield _batch(rows, names, scale, read)
        done += len(rows)
    yield from (Remark(text) for text in trouble)
    if not done:
        message = f"{path}: an RTKLIB file without a single solution"
        raise UnreadableLogError(message)
    yield from (Remark(what, "gnss", count) for what, count in bad.items())
    if scale == "GPST":
        yield Remark("GPS time made UTC by the leap seconds of its date")


def _tables(path: Path, trouble: list[str], bad: Counter[str]) -> Iterator[tuple[list[Row], list[str], str, int]]:
    """Yield rows, at most so many, with the names of their columns, their time scale, and the bytes read."""
    names, scale, read = list[str](), "GPST", 0
    rows: list[Row] = []
    fault = source.packed_fault(path)
    with source.open_unpacked(path) as file:
        for line in _lines(source.pieces(file, trouble), bad):
            read = source.position(file)
            if match := _HEADER.match(line):
                if rows:  # a second solution in the same file, perhaps with other columns
                    yield rows, names, scale, read
                    rows = []
                scale = match[1].decode()
                names = [re.sub(r"\(.*\)", "", name) for name in line[1:].decode("ascii", "replace").split()][1:]
            elif line.strip() and not line.startswith(b"%"):
                row = _row(line.split(), len(names), scale)
                if row is not None:
                    rows.append(row)
                elif fault:
                    trouble.append(f"{DAMAGED} ({fault}): all from the first odd line on is left out")
                    break
                bad.update([LEFT_OUT] if row is None else [])
            if len(rows) == ROWS:
                yield rows, names, scale, read
                rows = []
    if rows:
        yield rows, names, scale, path.stat().st_size


def _lines(pieces: Iterator[bytes], bad: Counter[str]) -> Iterator[bytes]:
    """Yield lines; a last one without its end was cut if it has fewer cells than others, or its last is shorter than all."""
    rest, least = b"", list[tuple[int, int]]()
    for piece in pieces:
        *whole, rest = (rest + piece).split(b"\n")
        yield from whole
        sizes = [_size(line) for line in whole if line.strip() and not line.startswith(b"%")]
        least = [min(least + sizes)] if sizes else least
    if not rest.strip() or not least or _size(rest) >= least[0]:
        yield rest
    else:
        bad[LEFT_OUT] += 1


def _size(line: bytes) -> tuple[int, int]:
    """Return the number of cells, and the size of the last."""
    cells = line.split()
    return len(cells), len(cells[-1])


def _row(cells: list[bytes], columns: int, scale: str) -> Row | None:
    """Return time and numbers of a line; None when it is cut or holds something else."""
    try:
        row = _time(cells[0], cells[1], scale), [float(cell) for cell in cells[2 : 2 + columns]]
    except (ValueError, IndexError, OverflowError):
        return None
    return row if len(row[1]) == columns and columns and np.isfinite(row[1]).all() else None


def _time(first: bytes, second: bytes, scale: str) -> int:
    """Return ns since 1970 UTC of ``yyyy/mm/dd hh:mm:ss.sss`` or ``week seconds``."""
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
        message = f"year {when.year}"
        raise ValueError(message)
    since = when - datetime(1970, 1, 1, tzinfo=UTC)
    return (since.days * 86400 + since.seconds) * SECOND + nanoseconds


def _batch(table: list[Row], names: list[str], scale: str, read: int) -> Batch:
    time, rows = np.array([stamp for stamp, _ in table]), np.array([row for _, row in table])
    at = {name: rows[:, i] for i, name in enumerate(names)}
    columns = {"position": np.stack([np.radians(at["latitude"]), np.radians(at["longitude"]), at["height"]], axis=1)}
    if "Q" in at:
        columns["fix_type"] = np.array([float(FIX_TYPE.get(int(q), 0)) for q in at["Q"]])
    if {"sdn", "sde", "sdu"} <= at.keys():
        columns["position_sigma"] = np.stack([at["sdn"], at["sde"], at["sdu"]], axis=1)
    if {"vn", "ve", "vu"} <= at.keys():
        columns["velocity"] = np.stack([at["vn"], at["ve"], -at["vu"]], axis=1)
    if {"sdvn", "sdve", "sdvu"} <= at.keys():
        columns["velocity_sigma"] = np.stack([at["sdvn"], at["sdve"], at["sdvu"]], axis=1)
    return Batch("gnss", "gnss", time, columns, Origin(f"deg, m, {scale}", "NEU", "unix"), read)
