"""NMEA 0183 sentences in text or between binary frames: found, checked, and decoded.

A sentence is ``$``, two letters of the talker, three of the kind, cells after commas, ``*``, and the exclusive-or of the bytes
between ``$`` and ``*`` as two hexadecimal digits. Source of the cells: u-blox F9 HPS 1.30 interface description (UBX-22010984),
section "NMEA protocol".
"""

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Floats

Columns = Mapping[str, NDArray[Any]]
Cells = Sequence[Sequence[bytes]]  #: one sequence of cells for each column

LONGEST = 256  #: bytes; the standard allows 82, receivers send more
POSITIONS = (b"GGA", b"GNS", b"RMC")  #: kinds of sentences with a position, the best first
ROWS = 20_000  #: sentences that are decoded at once
#: the name of a proprietary sentence begins with P
_BODY = rb"[$!](P[A-Z0-9]{3,9}|[A-OQ-Z][A-Z][A-Z]{3}),([^$!*\r\n\x80-\xff]*)"
_CHECKED = re.compile(_BODY + rb"\*([0-9A-Fa-f]{2})")
_BARE = re.compile(_BODY + rb"()(?=\r?\n)")


def _numbers(cells: Sequence[bytes]) -> Floats:
    """Return cells as numbers; nan for an empty cell, or one that is no number."""
    try:
        return np.array([cell or b"nan" for cell in cells]).astype(np.float64)
    except ValueError:
        return np.array([_number(cell) for cell in cells])


def _number(cell: bytes) -> float:
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def _angles(cells: Sequence[bytes], ways: Sequence[bytes]) -> Floats:
    """Return angles such as ``4717.112`` (47 degrees, 17.112 minutes) in degrees, south and west negative."""
    numbers = _numbers(cells)
    degrees = np.floor(numbers / 100)
    signs = np.array([-1.0 if way in (b"S", b"W") else 1.0 if way in (b"N", b"E") else np.nan for way in ways])
    with np.errstate(over="ignore", invalid="ignore"):  # of damaged numbers
        return signs * (degrees + (numbers - 100 * degrees) / 60)


def _texts(cells: Sequence[bytes]) -> NDArray[np.bytes_]:
    return np.array(cells, dtype="S8")


def _gga(c: Cells) -> Columns:
    return {
        "time": _numbers(c[0]), "latitude": _angles(c[1], c[2]), "longitude": _angles(c[3], c[4]), "quality": _numbers(c[5]),
        "above_sea": _numbers(c[8]), "separation": _numbers(c[10]),
    }  # fmt: skip


def _gns(c: Cells) -> Columns:
    return {
        "time": _numbers(c[0]), "latitude": _angles(c[1], c[2]), "longitude": _angles(c[3], c[4]), "mode": _texts(c[5]),
        "above_sea": _numbers(c[8]), "separation": _numbers(c[9]),
    }  # fmt: skip


def _rmc(c: Cells) -> Columns:
    return {
        "time": _numbers(c[0]), "status": _texts(c[1]), "latitude": _angles(c[2], c[3]), "longitude": _angles(c[4], c[5]),
        "knots": _numbers(c[6]), "course": _numbers(c[7]), "date": _numbers(c[8]),
    }  # fmt: skip


def _vtg(c: Cells) -> Columns:
    return {"course": _numbers(c[0]), "knots": _numbers(c[4])}


def _gst(c: Cells) -> Columns:
    return {"time": _numbers(c[0]), "north": _numbers(c[5]), "east": _numbers(c[6]), "up": _numbers(c[7])}


def _zda(c: Cells) -> Columns:
    return {"time": _numbers(c[0]), "date": _numbers(c[1]) * 1e4 + _numbers(c[2]) * 100 + _numbers(c[3]) % 100}


#: kind of the sentences that are read -> the fewest cells after the name, and how the cells become columns
READ: dict[bytes, tuple[int, Callable[[Cells], Columns]]] = {
    b"GGA": (11, _gga), b"RMC": (9, _rmc), b"VTG": (5, _vtg), b"GST": (8, _gst), b"GNS": (10, _gns), b"ZDA": (4, _zda),
}  # fmt: skip


class Sentences:
    """The sentences of a file by kind, in the file's order."""

    def __init__(self, *, checked: bool = True) -> None:
        """Begin without a sentence; ``checked``: only those with a checksum count, else only whole lines without one."""
        self._pattern = _CHECKED if checked else _BARE
        self.counts = Counter[bytes]()  #: sentences of each kind, proprietary ones by their whole name
        self.failed = self.short = 0  #: sentences whose checksum is wrong, and with too few cells
        self.stamped = 0  #: sentences with other text before them in their line
        self.other = 0  #: bytes that belong to no sentence and are not before one in its line
        self._pending: dict[bytes, list[tuple[int, bytes, list[bytes]]]] = defaultdict(list)
        self._pieces: dict[bytes, list[Columns]] = defaultdict(list)

    def take(self, text: bytes, offset: int, *, last: bool) -> int:
        """Keep the sentences of a text; return how many of its bytes are done with. ``last``: nothing can complete its end."""
        end = len(text) if last else _sure(text)
        running = np.bitwise_xor.accumulate(np.frombuffer(text, np.uint8))
        done = 0
        for match in self._pattern.finditer(text, 0, end):
            begin, name = match.start(), match[1]
            self._between(text[done:begin], last=False)
            done = match.end()
            if match[3] and int(running[match.end(2) - 1] ^ running[begin]) != int(match[3], 16):
                self.failed += 1
            elif name[:1] == b"P":
                self.counts[name] += 1
            else:
                self.counts[name[2:]] += 1
                self._keep(name[2:], (offset + begin, name[:2], match[2].split(b",")))
        self._between(text[done:end], last=True)
        return end

    @property
    def has_positions(self) -> bool:
        """Whether there is a sentence of a kind that states positions."""
        return any(self._pending.get(kind) or self._pieces.get(kind) for kind in POSITIONS)

    def rows(self, kind: bytes) -> Columns | None:
        """Return the sentences of a kind as columns, with their ``place`` in the file and ``talker``; None without one."""
        self._decode(kind)
        pieces = self._pieces.get(kind)
        if not pieces:
            return None
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}

    def _keep(self, kind: bytes, row: tuple[int, bytes, list[bytes]]) -> None:
        if kind not in READ:
            return
        if len(row[2]) < READ[kind][0]:
            self.short += 1
            return
        self._pending[kind].append(row)
        if len(self._pending[kind]) >= ROWS:
            self._decode(kind)

    def _decode(self, kind: bytes) -> None:
        rows = self._pending.pop(kind, [])
        if rows:
            least, columns = READ[kind]
            cells = list(zip(*(row[2][:least] for row in rows), strict=True))
            place, talker = np.array([row[0] for row in rows]), _texts([row[1] for row in rows])
            self._pieces[kind].append({"place": place, "talker": talker, **columns(cells)})

    def _between(self, text: bytes, *, last: bool) -> None:
        """Count the bytes between two sentences."""
        line = b"" if last else text[text.rfind(b"\n") + 1 :]
        before = line.strip()
        if before and len(before) <= LONGEST and before.isascii():
            self.stamped += 1
            text = text[: len(text) - len(line)]
        self.other += sum(len(part.strip()) for part in text.split(b"\n")) if text.strip() else 0


def _sure(text: bytes) -> int:
    """Return the end of the part of a text that no later bytes can change."""
    begin = max(text.rfind(mark, max(len(text) - LONGEST, 0)) for mark in (b"$", b"!"))
    return len(text) if begin < 0 or b"\n" in text[begin:] else begin
