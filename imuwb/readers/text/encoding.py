"""The bytes of a text file as UTF-8 with LF at the ends of lines: UTF-16, ISO 8859-1, byte order marks, and line ends of one CR."""

import codecs
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

#: mark at the beginning of a file -> name of the encoding
_MARKS = {codecs.BOM_UTF8: "utf-8", codecs.BOM_UTF16_LE: "utf-16-le", codecs.BOM_UTF16_BE: "utf-16-be"}
PRINTABLE = 0.99  #: least share of printable bytes in text
_CONTROL = bytes(set(range(32)) - set(b"\t\r\n\f"))  #: characters that text has not
_OLDER = frozenset((*range(9), *range(14, 32), *range(127, 160)))  #: bytes that no text of ISO 8859-1 has
_EVEN_ZEROS = 0.3  #: least share of zero bytes at even or odd places that shows UTF-16 without a mark


@dataclass(frozen=True, slots=True)
class Encoding:
    """How the characters and the line ends of a file are written."""

    name: str = "utf-8"
    mark: bytes = b""  #: at the beginning of the file
    carriage: bool = False  #: lines end with CR alone


def encoding_of(head: bytes) -> Encoding:
    """Return the encoding of a file that begins with ``head``."""
    mark = next((mark for mark in _MARKS if head.startswith(mark)), b"")
    name = _MARKS.get(mark) or _unmarked(head)
    text = _decoded(head.removeprefix(mark), name)
    return Encoding(name, mark, b"\r" in text and b"\n" not in text)


def _unmarked(head: bytes) -> str:
    """Return the encoding of text without a mark: half of the bytes of numbers in UTF-16 are zero."""
    for place, name in ((1, "utf-16-le"), (0, "utf-16-be")):
        zeros, others = head[place::2].count(0), head[1 - place :: 2].count(0)
        if not others and zeros > _EVEN_ZEROS * len(head):
            return name
    return "utf-8" if _is_utf8(head) else "iso-8859-1"


def _is_utf8(head: bytes) -> bool:
    """Return whether bytes may be UTF-8: they are, or have control characters, so they are damaged and no older text (``°``, ``²``)."""
    try:
        codecs.getincrementaldecoder("utf-8")().decode(head)
    except UnicodeDecodeError:
        return not _OLDER.isdisjoint(head)
    return True


def _decoded(data: bytes, name: str) -> bytes:
    return data if name == "utf-8" else data.decode(name, "replace").encode("utf-8", "replace")


def head_text(head: bytes, encoding: Encoding) -> bytes:
    """Return the beginning of a file as UTF-8 with LF at the ends of lines."""
    return b"".join(plain((head,), encoding))


def plain(pieces: Iterable[bytes], encoding: Encoding) -> Iterator[bytes]:
    """Yield the pieces of a file as UTF-8 with LF at the ends of lines; a character cut by the end of a piece is whole in the next."""
    decoder = codecs.getincrementaldecoder(encoding.name)("replace") if encoding.name != "utf-8" else None
    mark = encoding.mark
    for piece in pieces:
        rest, mark = piece.removeprefix(mark), b""
        if decoder is not None:
            rest = decoder.decode(rest).encode("utf-8", "replace")
        yield rest.replace(b"\r", b"\n") if encoding.carriage else rest


def is_text(head: bytes) -> bool:
    """Return whether a file begins with text that has digits."""
    head = head_text(head, encoding_of(head))
    if b"\0" in head or not any(digit in head for digit in b"0123456789"):
        return False
    return len(head.translate(None, _CONTROL)) >= PRINTABLE * len(head)
