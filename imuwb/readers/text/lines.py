"""Text as bytes for a parser: unpacked, without comments before the header, without a cut last line."""

from __future__ import annotations

import io
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from imuwb.errors import UnreadableLogError
from imuwb.readers.bytes import source
from imuwb.readers.text.trust import DAMAGED, is_number, trusted

if TYPE_CHECKING:
    from pathlib import Path

BLOCK = 1 << 20
#: every byte that is no ASCII as a question mark: no number has one, and the parser stumbles over them
_ASCII = bytes(range(128)) + b"?" * 128
ROWS_COMPARED = 100  #: that a last line without its end is measured by
COMMENT = (b"#", b"%", b"//")


@dataclass(frozen=True, slots=True)
class Layout:
    """How a text file stands: its delimiter, header and first row of numbers."""

    delimiter: str  #: " " means any run of blanks
    skip: int  #: lines before the first row of numbers
    names: tuple[str, ...]  #: of the header; empty where there is none
    first: tuple[str, ...]  #: the cells of the first whole row of numbers
    cut_first: bool  #: the file began in the middle of a line, which is skipped
    fault: str = ""  #: why what the packed file unpacks to may be wrong; empty where nothing says so


def layout(path: Path) -> Layout:
    """Return how a text file stands, from its first lines.

    Raises:
        UnreadableLogError: no row of numbers among them.
    """
    lines = source.head(path).removeprefix(b"\xef\xbb\xbf").split(b"\n")
    lines = lines[:-1] if len(lines) > 1 else lines  # the last may go on behind the head
    texts = [line.decode("utf-8", "replace").strip("\r") for line in lines]
    rows = [i for i, text in enumerate(texts) if text.strip() and not text.encode().lstrip().startswith(COMMENT)]
    if not rows:
        message = f"{path}: no line but comments in its first {len(lines)} lines"
        raise UnreadableLogError(message)
    delimiter = _delimiter([texts[i] for i in rows[-50:]])
    cells = {i: _cells(texts[i], delimiter) for i in rows}
    usual = max(set(sizes := [len(cells[i]) for i in rows]), key=sizes.count)
    numeric = [i for i in rows if _is_numeric(cells[i])]
    if not numeric or usual < 2:  # noqa: PLR2004 - one column is no log
        message = (
            f"{path}: text without rows of numbers (its first line is {texts[rows[0]][:60]!r}); "
            "a log is comma, semicolon, tab or blank separated numbers"
        )
        raise UnreadableLogError(message)
    header = [i for i in rows if i < numeric[0] and len(cells[i]) == usual]
    cut_first = not header and len(cells[numeric[0]]) < usual
    first = next((i for i in numeric if len(cells[i]) == usual), numeric[0])
    names = tuple(name.strip().strip('"') for name in cells[header[-1]]) if header else ()
    return Layout(delimiter, first, names, tuple(cells[first]), cut_first, source.packed_fault(path))


def _is_numeric(cells: list[str]) -> bool:
    """Return whether half of the cells that hold something are numbers."""
    filled = [cell for cell in cells if cell]
    numbers = sum(map(is_number, filled))
    return numbers > 0 and numbers * 2 >= len(filled)


def _delimiter(rows: list[str]) -> str:
    """Return the separator that parts most rows into the same number of cells, more than one."""
    counts = {mark: [row.count(mark) for row in rows] for mark in ",;\t"}
    best = max(counts, key=lambda mark: (min(counts[mark]) > 0, sum(counts[mark])))
    return best if sum(counts[best]) >= len(rows) else " "


def _cells(row: str, delimiter: str) -> list[str]:
    cells = row.split() if delimiter == " " else row.strip().split(delimiter)
    return [cell.strip().strip('"') for cell in cells]


class Rows(io.RawIOBase):
    """The rows of numbers of a text file, as bytes that end with a whole line.

    Blank-separated files come out with commas, comment lines are dropped, and a last line that was
    cut is left out, as is everything from the first odd line on in a packed file whose checksum fails;
    ``trouble`` says what was found.
    """

    def __init__(self, path: Path, layout: Layout) -> None:
        """Open the file and stand before its first row."""
        super().__init__()
        self.trouble: list[str] = []
        self.bytes_read = 0
        self._file = source.open_unpacked(path)
        self._layout = layout
        self._tail = b""
        self._out = b""
        self._skip = layout.skip
        # Of a damaged file is told where that shows, not what the unpacking ended with.
        self._pieces = source.pieces(self._file, [] if layout.fault else self.trouble)
        self._good = 0  # rows so far, of a damaged file
        self._least: tuple[int, int] | None = None  # cells, and the shortest last one, of the last whole rows

    def readable(self) -> bool:
        """Say yes, as the parser asks."""
        return True

    def is_empty(self) -> bool:
        """Return whether no row is left (the next rows are fetched to know)."""
        while not self._out:
            block = self._block()
            if not block and not self._tail:
                return True
            self._out = self._whole_lines(block)
            if not block:
                return not self._out
        return False

    def close(self) -> None:
        """Close the file below."""
        self._file.close()
        super().close()

    def readinto(self, buffer: object) -> int:
        """Fill ``buffer`` with the next bytes; 0 at the end."""
        view = memoryview(buffer)  # pyright: ignore[reportArgumentType] - io's protocol has no narrower type
        if self.is_empty():
            return 0
        size = min(len(view), len(self._out))
        view[:size] = self._out[:size]
        self._out = self._out[size:]
        return size

    def _block(self) -> bytes:
        block = bytearray()
        for piece in self._pieces:
            block += piece
            if len(block) >= BLOCK:
                break
        self.bytes_read = source.position(self._file)
        return bytes(block)

    def _whole_lines(self, block: bytes) -> bytes:
        data = self._tail + block
        if block:
            cut = data.rfind(b"\n") + 1
            data, self._tail = data[:cut], data[cut:]
        else:
            self._tail = b""
            cut = data.rfind(b"\n") + 1
            if self._is_cut(data[cut:]):
                self.trouble.append(f"last line cut ({data[cut:][:40].decode('utf-8', 'replace')!r}): left out")
                data = data[:cut]
        data = data.translate(_ASCII)
        while self._skip and data:
            _, _, data = data.partition(b"\n")
            self._skip -= 1
        if b"#" in data or b"%" in data or b"//" in data:
            data = b"".join(x for x in data.splitlines(keepends=True) if not x.lstrip().startswith(COMMENT))
        if self._layout.delimiter == " ":
            data = re.sub(rb"[ \t]+", b",", re.sub(rb"(?m)^[ \t]+|[ \t]+(?=\r?$)", b"", data))
        if self._layout.fault:
            data = self._trusted(data)
        if data.rstrip():
            parts = data.rstrip().rsplit(b"\n", ROWS_COMPARED)  # the first is all that lies before, if there is more
            rows = [row.split(self._mark()) for row in parts[len(parts) > ROWS_COMPARED :]]
            if rows:
                self._least = (min(map(len, rows)), min(len(row[-1].strip()) for row in rows))
        return data

    def _trusted(self, data: bytes) -> bytes:
        """Return the rows up to the first that shows the damage; behind it nothing is read."""
        lines = data.splitlines(keepends=True)
        good = trusted(lines, self._layout.first, self._mark())
        self._good += good
        if good < len(lines):
            self.trouble.append(
                f"{DAMAGED} ({self._layout.fault}): it shows behind row {self._good}, from where on all is "
                "left out; rows before may hold wrong values as well"
            )
            self._pieces, self._tail = iter(()), b""
        return b"".join(lines[:good])

    def _mark(self) -> bytes:
        return b"," if self._layout.delimiter == " " else self._layout.delimiter.encode()

    def _is_cut(self, line: bytes) -> bool:
        """Return whether a last line without its end lacks cells, or has a shorter last one than all rows before."""
        if not line.strip() or self._least is None:
            return False
        cells = line.split() if self._layout.delimiter == " " else line.strip().split(self._mark())
        return (len(cells), len(cells[-1].strip())) < self._least
