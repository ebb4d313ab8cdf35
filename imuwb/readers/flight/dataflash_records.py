"""The records of ArduPilot's binary logs, found without a Python step per record.

Each record begins with two bytes and a number. FMT records state name, size and fields of each number. FMT records may come late in the
file, so they are searched first. A record is used only if another begins right after it, so that damage is not read as numbers.
"""

import re
from collections import defaultdict
from collections.abc import Collection
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.compiled import compiled
from imuwb.readers.bytes.gather import Field, columns

HEAD = b"\xa3\x95"
FMT, FMT_SIZE = 128, 89
#: letter of a field -> numpy type, count, factor (of types that scale their field)
_KINDS: dict[str, tuple[str, int, float]] = {
    "a": ("<i2", 32, 1.0), "b": ("|i1", 0, 1.0), "B": ("|u1", 0, 1.0), "h": ("<i2", 0, 1.0), "H": ("<u2", 0, 1.0),
    "i": ("<i4", 0, 1.0), "I": ("<u4", 0, 1.0), "f": ("<f4", 0, 1.0), "d": ("<f8", 0, 1.0), "g": ("<f2", 0, 1.0),
    "n": ("|u1", 4, 1.0), "N": ("|u1", 16, 1.0), "Z": ("|u1", 64, 1.0), "c": ("<i2", 0, 0.01), "C": ("<u2", 0, 0.01),
    "e": ("<i4", 0, 0.01), "E": ("<u4", 0, 0.01), "L": ("<i4", 0, 1e-7), "M": ("|u1", 0, 1.0), "q": ("<i8", 0, 1.0),
    "Q": ("<u8", 0, 1.0),
}  # fmt: skip
_NAME = re.compile(rb"[A-Z0-9a-z_]{1,4}\0*")


@dataclass(frozen=True, slots=True)
class RecordField(Field):
    """A field of a record; its numbers are multiplied by the factor."""

    factor: float


@dataclass(frozen=True, slots=True)
class RecordFormat:
    """The fields of the records of one number."""

    name: str
    size: int  #: bytes, including the head
    fields: tuple[RecordField, ...]


def formats(buffer: Bytes) -> dict[int, RecordFormat]:
    """Return the formats that a buffer's FMT records describe, by number; the first one of a number counts."""
    known = {FMT: RecordFormat("FMT", FMT_SIZE, ())}
    data = buffer.tobytes()
    for match in re.finditer(HEAD + bytes([FMT]), data):
        at = match.start()
        if at + FMT_SIZE <= len(data) and (described := _format(data[at + 3 : at + FMT_SIZE])) is not None:
            known.setdefault(data[at + 3], described)
    return known


def _format(body: bytes) -> RecordFormat | None:
    """Return the format that an FMT record's body describes; None for another body."""
    size, name, letters, names = body[1], body[2:6], body[6:22].rstrip(b"\0"), body[22:86].rstrip(b"\0")
    if not _NAME.fullmatch(name) or not all(chr(letter) in _KINDS for letter in letters):
        return None
    labels = names.decode("ascii", "replace").split(",") if names else []
    fields: list[RecordField] = []
    end = 3
    for letter, label in zip(letters.decode(), [*labels, *[""] * len(letters)], strict=False):
        kind, count, factor = _KINDS[letter]
        fields.append(RecordField(label.strip(), kind, count, end, factor))
        end = fields[-1].end
    return RecordFormat(name.rstrip(b"\0").decode(), size, tuple(fields)) if end == size else None


@compiled()
def _walk(
    buffer: Bytes,
    last: bool,  # noqa: FBT001 - compiled code is called by place
    sizes: Integers,
    number: Bytes,
    start: Integers,
) -> tuple[int, int, int]:  # pragma: no cover - compiled
    """Fill the tables; return the number of records, where the search ended, and the bytes between records."""
    count, at, skipped, end = 0, 0, 0, buffer.size
    while at + 3 <= end and count < number.size:
        size = sizes[buffer[at + 2]] if buffer[at] == 0xA3 and buffer[at + 1] == 0x95 else 0  # noqa: PLR2004 - HEAD
        after = at + int(size)
        if size and after + 2 > end and not (last and after <= end):
            if not last:
                break
            size = 0  # cut
        if size and after + 2 <= end and not (buffer[after] == 0xA3 and buffer[after + 1] == 0x95):  # noqa: PLR2004
            size = 0
        if size:
            number[count], start[count] = buffer[at + 2], at
            count += 1
            at = after
        else:
            at += 1
            skipped += 1
    return count, at, skipped


@dataclass(slots=True)
class Tables:
    """Records by name, column by column; the file is taken block by block."""

    formats: dict[int, RecordFormat]
    wanted: Collection[str]
    records: int = 0
    skipped: int = 0  #: bytes that belong to no record
    _pieces: dict[str, list[dict[str, NDArray[Any]]]] = field(default_factory=lambda: defaultdict(list))

    def take(self, buffer: Bytes, *, last: bool) -> int:
        """Keep the records of a block; return where the next block begins."""
        sizes = np.zeros(256, np.int64)
        for number, described in self.formats.items():
            sizes[number] = described.size
        room = buffer.size // 3 + 1
        numbers, starts = np.empty(room, np.uint8), np.empty(room, np.int64)
        count, end, skipped = _walk(buffer, last, sizes, numbers, starts)
        self.records += count
        self.skipped += skipped + (buffer.size - end if last else 0)
        for number, described in self.formats.items():
            if described.name in self.wanted:
                rows = starts[:count][numbers[:count] == number]
                if rows.size:
                    raw = columns(described.fields, buffer, rows)
                    scaled = {f.name: raw[f.name] * f.factor for f in described.fields if f.factor != 1}
                    self._pieces[described.name].append(raw | scaled)
        return end

    def table(self, name: str) -> dict[str, NDArray[Any]] | None:
        """Return a record's columns, {field: (n,) or (n, count)}; None without such a record."""
        pieces = self._pieces.get(name)
        if not pieces:
            return None
        return {key: np.concatenate([piece[key] for piece in pieces]) for key in pieces[0]}
