"""The rows of a text file as bytes for a parser: unpacked, in UTF-8, without comments, without a cut last line."""

import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import reduce
from operator import xor
from pathlib import Path

from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.budget import check_line
from imuwb.readers.text.encoding import plain
from imuwb.readers.text.grouping import ungrouped
from imuwb.readers.text.keyed_lines import values_of
from imuwb.readers.text.layout import COMMENT, Layout
from imuwb.readers.text.trust import trusted

BLOCK = 1 << 20
#: replaces every byte that is not ASCII by a question mark: no number has such a byte, and the parser fails on it
_ASCII = bytes(range(128)) + b"?" * 128
_COMMENTS = tuple(mark.encode() for mark in COMMENT)
_QUOTED = re.compile(rb'"([^"\n]*)"')
ROWS_COMPARED = 100  #: number of rows with which a last line without its end is compared


@dataclass(frozen=True, slots=True)
class Span:
    """A part of a file between the ends of two lines, bytes."""

    start: int
    end: int


class Rows(io.RawIOBase):
    """The rows of numbers of a text file, as bytes that end with a whole line.

    Runs of blanks become commas and decimal commas points; comments and a cut last line are left out. If the checksum of a packed file is wrong,
    everything from the first damaged line on is left out. ``faults`` has a note on each fault.
    """

    def __init__(self, path: Path, layout: Layout, span: Span | None = None) -> None:
        """Open the file before its first row, or before the first row of a span of it."""
        super().__init__()
        self.faults: list[str] = []
        self.bytes_read = 0
        self.unsound = 0  #: lines left out because their checksum is wrong
        self._file = source.open_unpacked(path)
        self._layout = layout
        self._delimiter = layout.parsed_delimiter.encode()
        self._tail = b""
        self._out = b""
        self._skip = layout.skip if span is None or not span.start else 0
        # For a damaged file, the note on the first damaged line replaces the note on the end of the unpacked data.
        pieces = source.pieces(self._file, [] if layout.fault else self.faults)
        if span is not None:
            self._file.seek(span.start)
            pieces = _within(pieces, span.end - span.start)
        self._pieces = plain(pieces, layout.encoding)
        self._good = 0  # rows so far of a damaged file
        self._least: tuple[int, int] | None = None  # fewest cells and shortest last cell of the last whole rows

    def readable(self) -> bool:
        """Return True; the parser calls this."""
        return True

    def is_empty(self) -> bool:
        """Return whether no row is left; this reads the next rows."""
        while not self._out:
            pieces = self._next_pieces()
            if not pieces and not self._tail:
                return True
            self._out = self._whole_lines(pieces)
            if not pieces:
                return not self._out
        return False

    def close(self) -> None:
        """Close this object and the file."""
        self._file.close()
        super().close()

    def read(self, size: int = -1) -> bytes:
        """Return at most the next ``size`` bytes; none at the end."""
        if self.is_empty():
            return b""
        if size < 0 or size >= len(self._out):
            out, self._out = self._out, b""
        else:
            out, self._out = self._out[:size], self._out[size:]
        return out

    def _next_pieces(self) -> list[bytes]:
        pieces, size = list[bytes](), 0
        for piece in self._pieces:
            pieces.append(piece)
            size += len(piece)
            if size >= BLOCK:
                break
        self.bytes_read = source.position(self._file)
        return pieces

    def _whole_lines(self, pieces: list[bytes]) -> bytes:
        """Return the next whole lines as the parser needs them; no piece ends the file."""
        if pieces:  # the last piece is cut after its last line, so that the others are copied once
            last = next((i for i in range(len(pieces) - 1, -1, -1) if b"\n" in pieces[i]), None)
            if last is None:
                self._tail = b"".join([self._tail, *pieces])
                check_line(len(self._tail))
                return b""
            cut = pieces[last].rfind(b"\n") + 1
            data = b"".join([self._tail, *pieces[:last], pieces[last][:cut]])
            self._tail = b"".join([pieces[last][cut:], *pieces[last + 1 :]])
        else:
            data, self._tail = self._without_cut_end(self._tail, self._tail.rfind(b"\n") + 1), b""
        if not data.isascii():
            data = data.translate(_ASCII)
        while self._skip and data:
            _, _, data = data.partition(b"\n")
            self._skip -= 1
        data = self._separated(self._of_tag(data) if self._layout.tag is not None else self._without_comments(data))
        if self._layout.fault:
            data = self._trusted(data)
        self._remember_sizes(data)
        return data

    def _without_comments(self, data: bytes) -> bytes:
        """Return the lines without comments; the rows of a file in which every row has a comment's mark without it."""
        if self._layout.marked:
            return re.sub(rb"(?m)^[ \t]*" + self._layout.marked.encode() + rb"[ \t]*", b"", data)
        if b"#" in data or b"%" in data or (b"/" in data and b"//" in data):
            return b"".join(x for x in data.splitlines(keepends=True) if not x.lstrip().startswith(_COMMENTS))
        return data

    def _of_tag(self, data: bytes) -> bytes:
        """Return the lines with the tag of the layout, without their checksum; a line whose checksum is wrong is left out."""
        tag = self._layout.tag
        if tag is None:
            return data
        if tag.keyed:
            return values_of(data, tag.text)
        mark = b"[ \\t]+" if self._layout.delimiter == " " else b"[ \\t]*" + re.escape(self._delimiter)
        cell = b"[^ \\t\\n]+" if self._layout.delimiter == " " else b"[^" + re.escape(self._delimiter) + b"\\n]*"
        before = b"(?:" + cell + mark + b"){%d}[ \\t]*" % tag.column
        lines = re.findall(
            b"(?m)^[ \\t]*"
            + before
            + b'"?'
            + re.escape(tag.text.encode())
            + b'"?[ \\t]*(?:'
            + mark
            + b".*|\\r?)(?:\\n|$)",
            data,
        )
        if tag.checked:
            sound = [line for line in lines if is_sound(line)]
            self.unsound += len(lines) - len(sound)
            lines = [line[: line.rindex(b"*")] + b"\n" for line in sound]
        return b"".join(lines)

    def _separated(self, data: bytes) -> bytes:
        """Return the lines with the delimiter and the decimal point that the parser expects."""
        if self._layout.thousands:
            data = ungrouped(data, self._layout.delimiter, self._layout.thousands)
        if self._layout.decimal == ",":
            data = (
                _QUOTED.sub(lambda cell: cell[1].replace(b",", b"."), data)
                if self._layout.delimiter == ","
                else data.replace(b",", b".")
            )
        if self._layout.delimiter == " ":
            data = re.sub(rb"[ \t]+", b",", re.sub(rb"(?m)^[ \t]+|[ \t]+(?=\r?$)", b"", data))
        return data

    def _without_cut_end(self, data: bytes, cut: int) -> bytes:
        """Return the file's end without a last line that has too few cells, or a last cell shorter than in all rows before."""
        last = data[cut:]
        other = self._layout.tag is not None and not self._of_tag(last)
        if not last.strip() or self._least is None or other:
            return data
        cells = last.split() if self._layout.delimiter == " " else last.strip().split(self._delimiter)
        if (len(cells), len(cells[-1].strip())) >= self._least:
            return data
        text = f"last line left out, because it is cut: {last[:40].decode('utf-8', 'replace')!r}"
        self.faults.append(Note("last_line_cut", text))
        return data[:cut]

    def _remember_sizes(self, data: bytes) -> None:
        if not data.rstrip():
            return
        parts = data.rstrip().rsplit(b"\n", ROWS_COMPARED)  # if there are more rows, the first part is all earlier ones
        rows = [row.split(self._delimiter) for row in parts[len(parts) > ROWS_COMPARED :]]
        if rows:
            self._least = (min(map(len, rows)), min(len(row[-1].strip()) for row in rows))

    def _trusted(self, data: bytes) -> bytes:
        """Return the rows before the first row that shows the damage; nothing after these is read."""
        lines = data.splitlines(keepends=True)
        good = trusted(lines, self._layout.first, self._delimiter)
        self._good += good
        if good < len(lines):
            text = f"the damage shows after row {self._good}; all later rows are left out, and earlier ones may be wrong too"
            self.faults.append(source.damaged(self._layout.fault, text))
            self._pieces, self._tail = iter(()), b""
        return b"".join(lines[:good])


def is_sound(sentence: bytes) -> bool:
    """Return whether the checksum of a sentence is right: the exclusive or of the bytes between ``$`` and ``*``."""
    body, star, stated = sentence.strip().rpartition(b"*")
    try:
        return bool(star) and reduce(xor, body[body.find(b"$") + 1 :], 0) == int(stated, 16)
    except ValueError:
        return False


def _within(pieces: Iterator[bytes], size: int) -> Iterator[bytes]:
    """Yield the first bytes of a file."""
    for piece in pieces:
        yield piece[:size]
        size -= len(piece)
        if size <= 0:
            return
