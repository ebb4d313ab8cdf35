"""The messages of PX4's logs, found without a Python step per message; the file itself defines its topics.

Specification: https://docs.px4.io/main/en/dev_log/ulog_file_format
"""

import re
import struct
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Booleans, Bytes, Integers
from imuwb.compiled import compiled
from imuwb.readers.bytes.gather import Field, alike, columns, gather

HEADER = 16  #: bytes: magic, version, time
FLAGS = ord("B")
APPENDED = 0x01  #: bit in the first byte of incompatible flags: data was appended after an end that may be cut
KNOWN = b"AFIMPQLCDSORBX"  #: types of messages; another byte is damage
_PRIMITIVES = {
    "int8_t": "|i1", "uint8_t": "|u1", "int16_t": "<i2", "uint16_t": "<u2", "int32_t": "<i4", "uint32_t": "<u4",
    "int64_t": "<i8", "uint64_t": "<u8", "float": "<f4", "double": "<f8", "bool": "|u1", "char": "|u1",
}  # fmt: skip
_FIELD = re.compile(r"([\w/]+?)(?:\[(\d{1,4})\])? +(\w+)$")
DEEPEST, LONGEST = 8, 4096  #: levels of nested messages, and fields of a topic, at most
CHAIN = 8  #: messages that must follow each other after damage
LONG = 1024  #: bytes; a longer message after damage is probably garbage whose length leads by chance to a sound message
LARGEST = 4096  #: bytes; a longer message at the end of the file is damaged, not cut


@dataclass(slots=True)
class ULogFile:
    """Topics by name and instance, column by column; the whole file is taken at once."""

    formats: dict[str, str] = field(default_factory=dict[str, str])
    dropouts: list[int] = field(default_factory=list[int])  #: ms each
    messages: int = 0
    data: int = 0  #: messages of all topics, wanted or not
    skipped: int = 0  #: bytes that belong to no message
    misfits: int = 0  #: messages that are shorter than their topic's definition
    counts: dict[str, int] = field(default_factory=lambda: defaultdict(int))  #: messages by topic
    stated: list[tuple[str, float]] = field(default_factory=list[tuple[str, float]])  #: parameters: name, value
    _topics: dict[int, tuple[str, int]] = field(default_factory=dict[int, tuple[str, int]])
    _columns: dict[tuple[str, int], list[dict[str, NDArray[Any]]]] = field(default_factory=lambda: defaultdict(list))

    def take(self, buffer: Bytes, wanted: frozenset[str]) -> None:
        """Keep the messages of wanted topics."""
        for start, end in segments(buffer):
            kind, at, size, skipped = walk(buffer[start:end])
            at = at + start
            self.messages += kind.size
            self.skipped += skipped
            for i in np.flatnonzero(np.isin(kind, list(b"FAOP"))):
                self._declare(int(kind[i]), bytes(buffer.data[at[i] : at[i] + size[i]]))
            data = np.flatnonzero((kind == ord("D")) & (size >= 2))  # noqa: PLR2004 - the topic's number
            self.data += data.size
            for number, rows in alike(gather(buffer, at[data], "<u2"), data):
                topic = self._topics.get(number)
                if topic is not None:
                    self.counts[topic[0]] += rows.size
                if topic is not None and topic[0] in wanted:
                    self._gather(topic, buffer, at[rows] + 2, size[rows] - 2)

    def topics(self, name: str) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
        """Yield (instance, {field: (n,) or (n, count)}) of a topic, by instance."""
        for key in sorted(key for key in self._columns if key[0] == name):
            pieces = self._columns[key]
            yield key[1], {column: np.concatenate([piece[column] for piece in pieces]) for column in pieces[0]}

    def _declare(self, kind: int, content: bytes) -> None:
        if kind == ord("F"):
            name, _, text = content.decode("ascii", "replace").partition(":")
            self.formats.setdefault(name, text)
        elif kind == ord("A") and len(content) > 3:  # noqa: PLR2004 - instance, number
            instance, number = struct.unpack_from("<BH", content)
            self._topics[number] = content[3:].decode("ascii", "replace"), instance
        elif kind == ord("O") and len(content) >= 2:  # noqa: PLR2004 - u16
            self.dropouts.append(struct.unpack_from("<H", content)[0])
        elif kind == ord("P") and len(content) == 1 + content[0] + 4:
            form, _, name = content[1:-4].decode("ascii", "replace").partition(" ")
            if form in ("int32_t", "float"):
                self.stated.append((name, float(struct.unpack("<i" if form == "int32_t" else "<f", content[-4:])[0])))

    def _gather(self, topic: tuple[str, int], buffer: Bytes, at: Integers, size: Integers) -> None:
        fields, whole = layout(topic[0], self.formats)
        fits = size >= whole
        self.misfits += int(np.count_nonzero(~fits))
        if fields and fits.any():
            self._columns[topic].append(columns(fields, buffer, at[fits]))


def segments(buffer: Bytes) -> list[tuple[int, int]]:
    """Return (start, end) of the file's parts: data may be appended after an end that is cut."""
    edges = [HEADER, buffer.size]
    if buffer.size >= HEADER + 3 + 40 and buffer[HEADER + 2] == FLAGS and buffer[HEADER + 3 + 8] & APPENDED:
        offsets = gather(buffer, np.array([HEADER + 3 + 16]), "<u8", 3)[0]
        edges[1:1] = sorted(int(offset) for offset in offsets if HEADER < offset < buffer.size)
    return [(a, b) for a, b in pairwise(edges) if b > a]


@compiled()
def _end_of(buffer: Bytes, at: int, known: Booleans) -> int:  # pragma: no cover - compiled
    """Return where the message that begins here ends; -1 if no message begins here."""
    if at + 3 > buffer.size or not known[buffer[at + 2]]:
        return -1
    size = int(buffer[at]) | int(buffer[at + 1]) << 8
    return at + 3 + size if size > 0 and at + 3 + size <= buffer.size else -1


@compiled()
def _chained(buffer: Bytes, at: int, links: int, known: Booleans) -> bool:  # pragma: no cover - compiled
    """Return whether some messages follow each other from here; the end of the file counts as a message."""
    for _ in range(links):
        if at + 3 > buffer.size:
            return at == buffer.size
        at = _end_of(buffer, at, known)
        if at < 0:
            return False
    return True


@compiled()
def _walk(buffer: Bytes, known: Booleans, tables: Integers) -> tuple[int, int]:  # pragma: no cover - compiled
    """Fill the table (if it has room) with the whole messages; return their number and the bytes between messages.

    Garbage often has a plausible length, and a false message hides up to 64 KiB of sound messages. So after damage, several
    messages must follow each other.
    """
    count, at, skipped, sure = 0, 0, 0, True
    while at + 3 <= buffer.size:
        after = _end_of(buffer, at, known)
        if after >= 0 and not sure:
            sure = after - at < LONG and _chained(buffer, at, CHAIN, known)
        if after >= 0 and sure:
            # A message must follow; otherwise this one may be damaged.
            if after + 3 <= buffer.size and _end_of(buffer, after, known) < 0:
                sure = False
                if not _ends_well(buffer, after, known):
                    at += 1
                    skipped += 1
                    continue
            if tables.size:
                tables[0, count], tables[1, count], tables[2, count] = buffer[at + 2], at + 3, after - at - 3
            count += 1
            at = after
        else:
            sure = False
            at += 1
            skipped += 1
    return count, skipped + buffer.size - at


@compiled()
def _ends_well(buffer: Bytes, after: int, known: Booleans) -> bool:  # pragma: no cover - compiled
    """Return whether a message that the end of the file cuts begins here."""
    size = int(buffer[after]) | int(buffer[after + 1]) << 8
    return size > 0 and bool(known[buffer[after + 2]]) and after + 3 + size > buffer.size and size < LARGEST


def walk(buffer: Bytes) -> tuple[Integers, Integers, Integers, int]:
    """Return type, start and size of the content of each whole message, and the bytes that belong to no message."""
    known = np.zeros(256, np.bool_)
    known[list(KNOWN)] = True
    count, skipped = _walk(buffer, known, np.empty((0, 0), np.int64))
    tables = np.empty((3, count), np.int64)
    if count:
        _walk(buffer, known, tables)
    kind, at, size = tables
    return kind, at, size, skipped


def layout(name: str, formats: dict[str, str]) -> tuple[tuple[Field, ...], int]:
    """Return a topic's fields, and the least size of its messages, which are written without padding at their end.

    A definition is used up to the first unknown type.
    """
    fields: list[Field] = []
    end = _flatten(_Walk(formats), name, "", 0, fields, 0)
    last = max((f.end for f in fields), default=0)
    return (tuple(fields), last) if end is not None or fields else ((), 0)


class _Walk:
    """The definitions of messages; each is parsed once, and all fields that are looked at are counted."""

    def __init__(self, formats: dict[str, str]) -> None:
        self._formats = formats
        self._parsed: dict[str, list[re.Match[str] | None]] = {}
        self._looked = 0

    def fields(self, name: str) -> list[re.Match[str] | None]:
        """Return the fields of a message; one that is no field, or after which the message has too many, is None."""
        if name not in self._parsed:
            texts = (text.strip() for text in self._formats.get(name, "?").split(";"))
            self._parsed[name] = [_FIELD.match(text) for text in texts if text]
        self._looked += 1 + len(self._parsed[name])
        return self._parsed[name] if self._looked <= LONGEST else [None]


def _flatten(walk: _Walk, name: str, prefix: str, at: int, fields: list[Field], depth: int) -> int | None:
    """Append the fields of a message; return the offset of its end, or None if the end is unknown."""
    for match in walk.fields(name) if depth <= DEEPEST else [None]:
        if match is None:
            return None
        kind, count, label = match[1], int(match[2] or 0), match[3]
        if kind in _PRIMITIVES:
            if not label.startswith("_padding"):
                fields.append(Field(prefix + label, _PRIMITIVES[kind], count, at))
            at += np.dtype(_PRIMITIVES[kind]).itemsize * max(count, 1)
            continue
        for i in range(max(count, 1)):
            inner = _flatten(walk, kind, f"{prefix}{label}{f'[{i}]' if count else ''}.", at, fields, depth + 1)
            if inner is None:
                return None
            at = inner
    return at
