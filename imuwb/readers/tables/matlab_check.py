"""Checks the structure of a MATLAB file of version 5 before a library reads it, which trusts the sizes and types that the file states.

Source: MathWorks, MAT-File Format, version 5: data elements with a tag, matrices of sub-elements.
"""

import math
import zlib
from collections.abc import Iterator

from imuwb.readers.bytes import budget

HEADER, TAG = 128, 8  #: bytes
MATRIX, COMPRESSED = 14, 15  #: types of elements
#: type of numbers -> bytes of each
WIDTHS = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
TEXT = {16: 1, 17: 2, 18: 4}
CELL, STRUCTURE, OBJECT, CHARACTERS, SPARSE, NUMBERS = 1, 2, 3, 4, 5, range(6, 16)  #: classes of matrices
COMPLEX = 0x0800  #: flag of a matrix
DEEPEST = 16  #: matrices within each other


def check_structure(content: bytes) -> None:
    """Raise ValueError for a file whose matrices do not fit their elements, and OverBudgetError for one that unpacks to too much."""
    order = "big" if content[126:128] == b"MI" else "little"
    file, held = _Elements(content, order), 0
    for kind, start, end in file.elements(HEADER, len(content)):
        if kind == COMPRESSED:
            held += _check_packed(content[start:end], order)
            budget.check(held, "its unpacked content")
        elif kind == MATRIX:
            file.check_matrix(start, end, 0)


def _check_packed(packed: bytes, order: str) -> int:
    """Check the matrices in a packed element, and return the bytes that it unpacks to."""
    most = budget.current().most
    inner = zlib.decompressobj().decompress(packed, most + 1)
    budget.check(len(inner), "its unpacked content")
    file = _Elements(inner, order)
    for kind, start, end in file.elements(0, len(inner)):
        if kind == MATRIX:
            file.check_matrix(start, end, 0)
    return len(inner)


class _Elements:
    """The elements in some bytes."""

    def __init__(self, content: bytes, order: str) -> None:
        self._content, self._order = content, order

    def _whole(self, at: int, size: int = 4) -> int:
        return int.from_bytes(self._content[at : at + size], "big" if self._order == "big" else "little")

    def elements(self, at: int, end: int) -> Iterator[tuple[int, int, int]]:
        """Yield type, start and end of each element."""
        while at + TAG <= end:
            kind, size = self._whole(at), self._whole(at + 4)
            if kind >> 16:  # a small element has its content in the tag
                size, kind = kind >> 16, kind & 0xFFFF
                if size > 4:  # noqa: PLR2004 - bytes
                    raise ValueError(f"a small element of {size} bytes")
                yield kind, at + 4, at + 4 + size
                at += TAG
                continue
            if at + TAG + size > end:
                raise ValueError(f"an element of {size} bytes goes beyond the end of what contains it")
            yield kind, at + TAG, at + TAG + size
            at += TAG + (size if kind == COMPRESSED else (size + 7) // 8 * 8)

    def check_matrix(self, start: int, end: int, depth: int) -> None:
        """Raise ValueError unless the sub-elements of a matrix fit its class and its dimensions."""
        if start == end:  # an empty matrix
            return
        if depth > DEEPEST:
            raise ValueError(f"matrices nest deeper than {DEEPEST}")
        parts = list(self.elements(start, end))
        if len(parts) < 1 or parts[0][2] - parts[0][1] != 8:  # noqa: PLR2004 - bytes of the flags
            raise ValueError("a matrix without its flags")
        flags = self._whole(parts[0][1])
        kind = flags & 0xFF
        if kind not in (CELL, STRUCTURE, OBJECT, CHARACTERS, SPARSE, *NUMBERS):
            return  # objects and functions, which are named and not read
        if len(parts) < 3 or parts[1][0] != 5:  # noqa: PLR2004 - flags, dimensions, name; int32
            raise ValueError("a matrix without dimensions or name")
        _, first, last = parts[1]
        sizes = [self._whole(at) for at in range(first, last, 4)]
        count = math.prod(sizes)
        if len(sizes) < 2 or max(sizes) >= 1 << 31 or count > (end - start):  # noqa: PLR2004 - each value takes a byte at least
            raise ValueError(f"a matrix of {' x '.join(map(str, sizes))} values in {end - start} bytes")
        rest = parts[3:]
        if kind in (CELL, STRUCTURE, OBJECT):
            self._check_nested(kind, count, rest, depth)
        elif kind == SPARSE:
            if not all(part[0] in WIDTHS for part in rest):
                raise ValueError("a sparse matrix of values of an unknown type")
        else:
            self._check_values(kind, count, rest[: 2 if flags & COMPLEX else 1], twice=bool(flags & COMPLEX))

    def _check_nested(self, kind: int, count: int, rest: list[tuple[int, int, int]], depth: int) -> None:
        heads = {CELL: 0, STRUCTURE: 2, OBJECT: 3}[kind]
        if len(rest) < heads:
            raise ValueError("a structure without the names of its fields")
        if heads:
            (_, length, after), (_, begin, end) = rest[heads - 2 : heads]
            width = self._whole(length) if after - length == 4 else 0  # noqa: PLR2004 - bytes
            if width <= 0 or (end - begin) % width:
                raise ValueError("a structure whose fields have names of no length")
            count *= (end - begin) // width
        if len(rest) - heads != count or not all(part[0] == MATRIX for part in rest[heads:]):
            raise ValueError(f"{len(rest) - heads} values where {count} are stated")
        for _, start, end in rest[heads:]:
            self.check_matrix(start, end, depth + 1)

    def _check_values(self, kind: int, count: int, rest: list[tuple[int, int, int]], *, twice: bool) -> None:
        widths = WIDTHS | TEXT if kind == CHARACTERS else WIDTHS
        if len(rest) != 1 + twice:
            raise ValueError("a matrix without its values")
        for own, start, end in rest:
            if own not in widths:
                raise ValueError(f"values of the unknown type {own}")
            if kind != CHARACTERS and end - start != count * widths[own]:
                raise ValueError(f"{(end - start) // widths[own]} values where {count} are stated")
