"""Byte layouts of any ROS message from its definition, for ROS 1 and for ROS 2 (CDR).

A definition becomes a flat plan: fixed fields by dotted path, and strings and sequences as jumps, whose length is in the message.
Messages of one channel with equal lengths have all fields at the same offsets, so a whole chunk is gathered in a few array
operations. No code is made or run from a log's definitions.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from imuwb.arrays import Booleans, Bytes, Integers
from imuwb.readers.bytes.gather import Field, alike, gather
from imuwb.ros import short

Wire = Literal["cdr", "ros1"]

_PRIMITIVES = {
    "bool": "u1", "byte": "u1", "char": "u1", "octet": "u1", "int8": "i1", "uint8": "u1", "int16": "i2",
    "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8", "float32": "f4",
    "float64": "f8", "float": "f4", "double": "f8",
}  # fmt: skip
#: types that definitions omit
_KNOWN = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "builtin_interfaces/Duration": "int32 sec\nuint32 nanosec",
    "time": "uint32 sec\nuint32 nanosec",  # of ROS 1, with its fields secs and nsecs renamed
    "duration": "int32 sec\nint32 nanosec",
}
#: encapsulation -> byte order and largest alignment: CDR, big and little endian, and plain XCDR2
_ENCAPSULATIONS = {0: (">", 8), 1: ("<", 8), 6: (">", 4), 7: ("<", 4)}
_FIELD = re.compile(r"^([\w/]+)(<=\d+)?(\[(<=)?(\d*)\])?\s+(\w+)\s*(.*)$")
_BODIES = {"cdr": 4, "ros1": 0}  #: bytes before a message's fields
LARGEST_ARRAY = 64  #: messages in an array; larger arrays have no stamp, rate or position that imuwb reads
DEEPEST = 16  #: levels of nested messages
DIGITS = 6  #: digits of the length of a fixed array; a number with more digits is damage
LONGEST_PLAN = 4096  #: fields that are looked at, also those that are messages
MOST_JUMPS = 64  #: strings and sequences before a field that is read
PADDING = 3  #: bytes at most after a message, with which some middleware fills it up to a multiple of 4


@dataclass(frozen=True, slots=True)
class LayoutField:
    """A number, or ``count`` numbers, that follow the step before."""

    path: str
    kind: str  #: numpy type without byte order, such as "f8"
    count: int  #: 0 for a single number


@dataclass(frozen=True, slots=True)
class Jump:
    """A string or sequence: its length as u32, then its elements."""

    path: str
    size: int  #: bytes of an element
    align: int


Plan = tuple[LayoutField | Jump, ...]


class UnknownLayoutError(Exception):
    """A definition has no plan; the text states why."""


def plan(name: str, definition: str) -> Plan:
    """Return the plan of message ``name``, up to the first sequence of messages, because later fields have no common offset.

    Raises:
        UnknownLayoutError: a type is not defined, or the definition nests without end.
    """
    return whole_plan(name, definition)[0]


def whole_plan(name: str, definition: str, part: Callable[[str], str] = lambda _: "") -> tuple[Plan, bool]:
    """Return the plan of message ``name``, and whether it reaches the message's end.

    Args:
        name: the message's type.
        definition: its definition, with those of the types that it contains.
        part: returns the fields of a type (``package/Type``) that the definition omits; an empty text if it is not known.

    Raises:
        UnknownLayoutError: a type is not defined, or the definition nests without end.
    """
    texts = _Types({**_KNOWN, **dict(sections(short(name), definition))}, part)
    steps: list[LayoutField | Jump] = []
    whole = _flatten(texts, short(name), "", steps, 0)
    return tuple(steps), whole


def sections(name: str, definition: str) -> Iterator[tuple[str, str]]:
    """Yield (type, fields) of a definition: of the message ``name`` itself, then of the types that follow it."""
    main, *others = re.split(r"^=+\s*$", definition, flags=re.MULTILINE)
    yield name, main
    for other in others:
        head, _, body = other.lstrip().partition("\n")
        if head.startswith("MSG:"):
            yield short(head.removeprefix("MSG:").strip()), body


class _Types:
    """The definitions of a message and of the types that it contains; each is parsed once, however often it is used."""

    def __init__(self, own: dict[str, str], part: Callable[[str], str]) -> None:
        self.own, self.part = own, part
        self.looked = 0  #: fields so far
        self._lines: dict[str, list[re.Match[str]]] = {}
        self._found: dict[tuple[str, str], str] = {}

    def fields(self, name: str) -> Iterator[re.Match[str]]:
        """Yield the fields of a type.

        Raises:
            UnknownLayoutError: too many fields were looked at; a small definition can nest so that they never end.
        """
        if name not in self._lines:
            lines = (_FIELD.match(line.split("#", 1)[0].strip()) for line in self.own[name].splitlines())
            # blank lines and constants are no fields
            self._lines[name] = [match for match in lines if match is not None and not match[7].startswith("=")]
        for match in self._lines[name]:
            self.count(name)
            yield match

    def count(self, name: str) -> None:
        """Count a field or a message."""
        self.looked += 1
        if self.looked > LONGEST_PLAN:
            raise UnknownLayoutError(f"{name} has too many levels or too many fields")

    def find(self, kind: str, parent: str) -> str:
        """Return the whole name of a type that is used in another."""
        if (kind, parent) not in self._found:
            self._found[kind, parent] = self._find(kind, parent)
        return self._found[kind, parent]

    def _find(self, kind: str, parent: str) -> str:
        package = parent.rpartition("/")[0]
        names = (short(kind), f"{package}/{kind}", *(("std_msgs/Header",) if kind == "Header" else ()))
        for name in names:
            if name in self.own:
                return name
        for name in names:
            if text := self.part(name):
                self.own[name] = text
                return name
        for name in self.own:
            if name.rpartition("/")[2] == kind:
                return name
        raise UnknownLayoutError(f"type {kind!r}, used in {parent}, is not defined")


def _flatten(texts: _Types, name: str, prefix: str, steps: list[LayoutField | Jump], depth: int) -> bool:
    """Append the fields of a message; return False if later fields have no common offset."""
    texts.count(name)
    if depth > DEEPEST:
        raise UnknownLayoutError(f"{name} has too many levels or too many fields")
    for match in texts.fields(name):
        kind, array, bounded, number, path = match[1], match[3], match[4], match[5], prefix + match[6]
        if len(number or "") > DIGITS:
            raise UnknownLayoutError(f"an array in {name} has {number[:DIGITS]}... elements, which is too many")
        fixed = int(number) if array and number and not bounded else None
        if kind in _PRIMITIVES and not (array and fixed is None):
            steps.append(LayoutField(path, _PRIMITIVES[kind], fixed or 0))
        elif kind in _PRIMITIVES or (kind == "string" and not array):
            if sum(isinstance(step, Jump) for step in steps) >= MOST_JUMPS:
                return False
            size = int(_PRIMITIVES.get(kind, "u1")[1])
            steps.append(Jump(path, size, size))
        elif kind in ("string", "wstring") or (array and (fixed is None or fixed > LARGEST_ARRAY)):
            return False
        else:
            child = texts.find(kind, name)
            places = [f"{path}.{i}." for i in range(fixed or 0)] if array else [f"{path}."]
            if not all(_flatten(texts, child, place, steps, depth + 1) for place in places):
                return False
    return True


@dataclass(frozen=True, eq=False, slots=True)
class Group:
    """Messages whose fields have the same offsets."""

    rows: Integers  #: numbers of the messages
    places: tuple[Field, ...]  #: the wanted fields; their offsets count from the payload's start


def groups(
    steps: Plan, wanted: Sequence[str], wire: Wire, buffer: Bytes,
    start: Integers, length: Integers,
) -> Iterator[Group]:  # fmt: skip
    """Yield the messages group by group; a message that is too short for its definition is in no group.

    A wanted ``name[0]`` is the first number of the array ``name``.
    """
    rows = np.arange(start.size)
    if wire == "ros1":
        yield from _split(steps, wanted, (), rows, 0, "<", 1, buffer, start, length, 0)
        return
    rows = _of(rows, length >= 4)  # noqa: PLR2004 - the encapsulation header of CDR
    for code, chosen in alike(gather(buffer, start[rows], ">u2"), rows):
        if code in _ENCAPSULATIONS:
            order, align = _ENCAPSULATIONS[code]
            yield from _split(steps, wanted, (), chosen, 0, order, align, buffer, start, length, 4)


def _split(
    steps: Plan, wanted: Sequence[str], places: tuple[Field, ...], rows: Integers, at: int,
    order: str, align: int, buffer: Bytes, start: Integers, length: Integers, body: int,
) -> Iterator[Group]:  # fmt: skip
    """Follow the plan; at a jump, split the messages by the length of the jump, and go on with each part."""
    for i, step in enumerate(steps):
        if len(places) == len(wanted):
            break
        if isinstance(step, LayoutField):
            size = int(step.kind[1])
            at = _aligned(at, min(size, align))
            for path, count in ((step.path, step.count), (f"{step.path}[0]", 0)):
                if path in wanted:
                    places = (*places, Field(path, f"{order}{step.kind}", count, body + at))
            at += size * max(step.count, 1)
            continue
        at = _aligned(at, min(4, align))
        rows = _of(rows, length[rows] >= body + at + 4)
        counts = gather(buffer, start[rows] + (body + at), f"{order}u4").astype(np.int64)
        fits = counts * step.size <= length[rows] - (body + at + 4)
        for count, chosen in alike(_of(counts, fits), _of(rows, fits)):
            after = at + 4
            if count:
                after = _aligned(after, min(step.align, align)) + count * step.size
            yield from _split(steps[i + 1 :], wanted, places, chosen, after, order, align, buffer, start, length, body)
        return
    rows = _of(rows, length[rows] >= max((place.end for place in places), default=0))
    if rows.size and len(places) == len(wanted):
        yield Group(rows, places)


def _of(rows: Integers, which: Booleans) -> Integers:
    """Return some of the rows; usually these are all, which are then not copied."""
    return rows if which.all() else rows[which]


def surplus(steps: Plan, wire: Wire, message: bytes, *, whole: bool) -> int | None:
    """Return by how many bytes a message is longer than a plan, up to its padding; None if the plan does not fit it.

    Args:
        steps: the plan.
        wire: how the message is written.
        message: its bytes.
        whole: whether the plan reaches the message's end; otherwise the message may be longer.
    """
    places = list(_walked(steps, wire, message))
    if len(places) < len(steps):
        return None
    rest = len(message) - (places[-1][1] if places else _BODIES[wire])
    return rest if 0 <= rest <= (PADDING if whole else len(message)) else None


def text(steps: Plan, wire: Wire, message: bytes, path: str) -> bytes:
    """Return a string in a message; empty if the message has none."""
    for step, end, count in _walked(steps, wire, message):
        if step.path == path and isinstance(step, Jump):
            return message[end - count : end] if end <= len(message) else b""
    return b""


def _walked(steps: Plan, wire: Wire, message: bytes) -> Iterator[tuple[LayoutField | Jump, int, int]]:
    """Yield each step of a plan that begins within a message, with the offset of its end, and its number of elements."""
    little, align, body = True, 1, _BODIES[wire]
    if wire == "cdr":
        code = int.from_bytes(message[:2], "big")
        if len(message) < body or code not in _ENCAPSULATIONS:
            return
        order, align = _ENCAPSULATIONS[code]
        little = order == "<"
    size, at = len(message) - body, 0
    for step in steps:
        if isinstance(step, LayoutField):
            width, count = int(step.kind[1]), max(step.count, 1)
            at = _aligned(at, min(width, align)) + width * count
        else:
            at = _aligned(at, min(4, align)) + 4
            count = int.from_bytes(message[body + at - 4 : body + at], "little" if little else "big")
            if count:
                at = _aligned(at, min(step.align, align)) + count * step.size
        if at > size:
            return
        yield step, body + at, count


def _aligned(at: int, size: int) -> int:
    return (at + size - 1) // size * size
