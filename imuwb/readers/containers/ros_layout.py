"""ROS message definitions as byte layouts, for ROS 1 and for ROS 2 (CDR), of any message.

A definition becomes a flat plan: fixed fields by dotted path, strings and sequences as jumps whose
length stands in the message. Messages of one channel that agree in those lengths have all fields at
the same offsets, so a whole chunk is gathered in a few array operations. No code is made or run
from what a log says.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from imuwb.readers.bytes.gather import alike, gather

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

Wire = Literal["cdr", "ros1"]

_PRIMITIVES = {
    "bool": "u1", "byte": "u1", "char": "u1", "octet": "u1", "int8": "i1", "uint8": "u1", "int16": "i2",
    "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4",
    "float64": "f8", "float": "f4", "double": "f8",
}  # fmt: skip
#: Types that definitions leave out because everyone has them.
_KNOWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "time": "uint32 sec\nuint32 nanosec",  # ROS 1's own; its names are secs and nsecs
    "duration": "int32 sec\nint32 nanosec",
}
#: CDR, big and little endian; XCDR2 in its plain form, where nothing aligns to more than 4.
_ENCAPSULATIONS = {0: (">", 8), 1: ("<", 8), 6: (">", 4), 7: ("<", 4)}
_FIELD = re.compile(r"^([\w/]+)(<=\d+)?(\[(<=)?(\d*)\])?\s+(\w+)\s*(.*)$")
LARGEST_ARRAY = 64  #: of messages; larger ones hold no stamp, rate or position of ours
DEEPEST = 16
DIGITS = 6  #: of a fixed array's length; no message is larger
LONGEST_PLAN = 4096


@dataclass(frozen=True, slots=True)
class Field:
    """A number, or ``count`` of them, at a fixed place behind what precedes it."""

    path: str
    kind: str  #: numpy type without byte order, such as "f8"
    count: int  #: 0 for a single number


@dataclass(frozen=True, slots=True)
class Jump:
    """A string or sequence: its length as u32, then that many elements."""

    path: str
    size: int  #: bytes of an element
    align: int


Plan = tuple[Field | Jump, ...]


class UnknownLayoutError(Exception):
    """The definition holds something that has no plan."""


def plan(name: str, definition: str) -> Plan:
    """Return the fields of message ``name``, as far as they can be found without decoding elements.

    A plan ends before the first sequence of messages, because what lies behind has no common place.

    Raises:
        UnknownLayoutError: a type is not defined, or the definition nests without end.
    """
    texts = dict(_sections(_short(name), definition))
    steps: list[Field | Jump] = []
    _flatten(texts, _short(name), "", steps, 0)
    return tuple(steps)


def _sections(name: str, definition: str) -> Iterator[tuple[str, str]]:
    yield from _KNOWN.items()
    main, *others = re.split(r"^=+\s*$", definition, flags=re.MULTILINE)
    yield name, main
    for other in others:
        head, _, body = other.lstrip().partition("\n")
        if head.startswith("MSG:"):
            yield _short(head.removeprefix("MSG:").strip()), body


def _short(name: str) -> str:
    """Return ``package/Type``, the form both ROS generations share."""
    return name.replace("/msg/", "/")


def _flatten(texts: dict[str, str], name: str, prefix: str, steps: list[Field | Jump], depth: int) -> bool:
    """Append the fields of a message; False when nothing behind it has a common place."""
    if depth > DEEPEST or len(steps) > LONGEST_PLAN:
        message = f"{name} nests too deep or holds too many fields"
        raise UnknownLayoutError(message)
    for line in texts[name].splitlines():
        match = _FIELD.match(line.split("#", 1)[0].strip())
        if match is None or match[7].startswith("="):  # blank, or a constant
            continue
        kind, array, bounded, number, path = match[1], match[3], match[4], match[5], prefix + match[6]
        if len(number or "") > DIGITS:
            message = f"an array of {number[:DIGITS]}... elements in {name}"
            raise UnknownLayoutError(message)
        fixed = int(number) if array and number and not bounded else None
        if kind in _PRIMITIVES and not (array and fixed is None):
            steps.append(Field(path, _PRIMITIVES[kind], fixed or 0))
        elif kind in _PRIMITIVES:
            size = int(_PRIMITIVES[kind][1])
            steps.append(Jump(path, size, size))
        elif kind in ("string", "wstring"):
            if array or kind == "wstring":
                return False
            steps.append(Jump(path, 1, 1))
        elif not _flatten_nested(texts, name, kind, path, steps, depth, array=bool(array), fixed=fixed):
            return False
    return True


def _flatten_nested(
    texts: dict[str, str], parent: str, kind: str, path: str, steps: list[Field | Jump], depth: int,
    *, array: bool, fixed: int | None,
) -> bool:  # fmt: skip
    if array and (fixed is None or fixed > LARGEST_ARRAY):
        return False
    child = _resolve(texts, kind, parent)
    places = [f"{path}."] if not array else [f"{path}.{i}." for i in range(fixed or 0)]
    return all(_flatten(texts, child, place, steps, depth + 1) for place in places)


def _resolve(texts: dict[str, str], kind: str, parent: str) -> str:
    package = parent.rpartition("/")[0]
    ends = [name for name in texts if name.rpartition("/")[2] == kind]
    for name in (_short(kind), f"{package}/{kind}", "std_msgs/Header" if kind == "Header" else "", *ends):
        if name in texts:
            return name
    message = f"type {kind!r}, used in {parent}, is not defined"
    raise UnknownLayoutError(message)


@dataclass(frozen=True, slots=True)
class Place:
    """Where a field stands."""

    path: str
    kind: str  #: numpy's name of its type, with byte order
    count: int  #: 0 for a single number
    offset: int  #: from the payload's start

    @property
    def end(self) -> int:
        """Return the offset behind it."""
        return self.offset + int(self.kind[2:]) * max(self.count, 1)


@dataclass(frozen=True, eq=False, slots=True)
class Group:
    """Messages whose fields lie at the same offsets."""

    rows: NDArray[np.int64]  #: which of the messages
    places: tuple[Place, ...]  #: of the wanted fields


def groups(
    steps: Plan, wanted: Sequence[str], wire: Wire, buffer: NDArray[np.uint8],
    start: NDArray[np.int64], length: NDArray[np.int64],
) -> Iterator[Group]:  # fmt: skip
    """Yield the messages group by group; those too short for their own definition are in none.

    A wanted ``name[0]`` is the first number of the array ``name``.
    """
    rows = np.arange(start.size)
    if wire == "ros1":
        yield from _split(steps, wanted, (), rows, 0, "<", 1, buffer, start, length, 0)
        return
    rows = rows[length >= 4]  # noqa: PLR2004 - the encapsulation header of CDR
    for code, chosen in alike(gather(buffer, start[rows], ">u2"), rows):
        if code in _ENCAPSULATIONS:
            order, align = _ENCAPSULATIONS[code]
            yield from _split(steps, wanted, (), chosen, 0, order, align, buffer, start, length, 4)


def _split(
    steps: Plan, wanted: Sequence[str], found: tuple[Place, ...], rows: NDArray[np.int64], at: int,
    order: str, align: int, buffer: NDArray[np.uint8], start: NDArray[np.int64], length: NDArray[np.int64], body: int,
) -> Iterator[Group]:  # fmt: skip
    """Walk the plan; at a jump, part the messages by its length and walk on with each part."""
    for i, step in enumerate(steps):
        if len(found) == len(wanted):
            break
        if isinstance(step, Field):
            size = int(step.kind[1])
            at = _aligned(at, min(size, align))
            for path, count in ((step.path, step.count), (f"{step.path}[0]", 0)):
                if path in wanted:
                    found = (*found, Place(path, f"{order}{step.kind}", count, body + at))
            at += size * max(step.count, 1)
            continue
        at = _aligned(at, min(4, align))
        rows = rows[length[rows] >= body + at + 4]
        counts = gather(buffer, start[rows] + (body + at), f"{order}u4").astype(np.int64)
        fits = counts * step.size <= length[rows] - (body + at + 4)
        for count, chosen in alike(counts[fits], rows[fits]):
            behind = at + 4
            if count:
                behind = _aligned(behind, min(step.align, align)) + count * step.size
            yield from _split(steps[i + 1 :], wanted, found, chosen, behind, order, align, buffer, start, length, body)
        return
    rows = rows[length[rows] >= max((place.end for place in found), default=0)]
    if rows.size and len(found) == len(wanted):
        yield Group(rows, found)


def _aligned(at: int, size: int) -> int:
    return (at + size - 1) // size * size
