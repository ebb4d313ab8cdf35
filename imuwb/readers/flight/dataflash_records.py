"""The records of ArduPilot's binary logs, found without a Python step per record.

Each record begins with two bytes and a number. FMT records state name, size and fields of each number. FMT records may come late in the
file, so they are searched first. A record is used only if another begins right after it, so that damage is not read as numbers.
"""

import re
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Bytes, Integers
from imuwb.compiled import compiled
from imuwb.readers.bytes.gather import Field

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
        if at + FMT_SIZE <= len(data) and (found := described(data[at + 3 : at + FMT_SIZE])) is not None:
            known.setdefault(data[at + 3], found)
    return known


def described(body: bytes) -> RecordFormat | None:
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
) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the tables; return the number of records, and where the search ended."""
    count, at, end = 0, 0, buffer.size
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
    return count, at


def walk(buffer: Bytes, *, last: bool, sizes: Integers) -> tuple[Bytes, Integers, int]:
    """Return the number and the place of each record of a block, and where the search ended.

    Args:
        buffer: bytes.
        last: whether nothing follows this block.
        sizes: (256,) bytes of the records of each number; 0 for a number without a format.
    """
    room = buffer.size // 3 + 1
    numbers, starts = np.empty(room, np.uint8), np.empty(room, np.int64)
    count, end = _walk(buffer, last, sizes, numbers, starts)
    return numbers[:count], starts[:count], end
