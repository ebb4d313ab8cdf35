"""Text as bytes for a parser: unpacked, without comments, without a cut last line."""

import io
import re
from dataclasses import dataclass
from pathlib import Path

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.text.trust import is_number, trusted

BLOCK = 1 << 20
#: replaces every byte that is not ASCII by a question mark: no number has such a byte, and the parser fails on it
_ASCII = bytes(range(128)) + b"?" * 128
ROWS_COMPARED = 100  #: number of rows with which a last line without its end is compared
DELIMITER_ROWS = 50  #: number of last rows of the file's head in which the delimiter is found
COMMENT = (b"#", b"%", b"//")


@dataclass(frozen=True, slots=True)
class Layout:
    """The delimiter, header and first row of a text file."""

    delimiter: str  #: " " means any run of blanks
    skip: int  #: lines before the first row of numbers
    names: tuple[str, ...]  #: names in the header; empty without a header
    first: tuple[str, ...]  #: the cells of the first whole row of numbers
    cut_first: bool  #: the file begins in the middle of a line, which is skipped
    fault: str = ""  #: why the content of the packed file may be wrong; empty for a sound file

    @property
    def parsed_delimiter(self) -> str:
        """The delimiter after runs of blanks are replaced by commas."""
        return "," if self.delimiter == " " else self.delimiter


def layout(path: Path) -> Layout:
    """Return the layout of a text file, from its first lines.

    Raises:
        UnreadableLogError: these lines have no row of numbers.
    """
    lines = source.head(path).removeprefix(b"\xef\xbb\xbf").split(b"\n")
    lines = lines[:-1] if len(lines) > 1 else lines  # the last one may continue after the head
    texts = [line.decode("utf-8", "replace").strip("\r") for line in lines]
    rows = [i for i, text in enumerate(texts) if text.strip() and not text.encode().lstrip().startswith(COMMENT)]
    if not rows:
        raise UnreadableLogError(f"{path}: the first {len(lines)} lines are all comments; a log needs rows of numbers")
    delimiter = _delimiter([texts[i] for i in rows[-DELIMITER_ROWS:]])
    cells = {i: _cells(texts[i], delimiter) for i in rows}
    usual = max(set(sizes := [len(cells[i]) for i in rows]), key=sizes.count)
    numeric = [i for i in rows if _is_numeric(cells[i])]
    if not numeric or usual < 2:  # noqa: PLR2004 - a log has at least two columns
        raise UnreadableLogError(
            f"{path}: this text has no rows of numbers (its first line is {texts[rows[0]][:60]!r}); "
            "a log has numbers separated by commas, semicolons, tabs or blanks"
        )
    header = [i for i in rows if i < numeric[0] and len(cells[i]) == usual]
    cut_first = not header and len(cells[numeric[0]]) < usual
    first = next((i for i in numeric if len(cells[i]) == usual), numeric[0])
    names = tuple(name.strip().strip('"') for name in cells[header[-1]]) if header else ()
    return Layout(delimiter, first, names, tuple(cells[first]), cut_first, source.packed_fault(path))


def _is_numeric(cells: list[str]) -> bool:
    """Return whether at least half of the cells that are not empty are numbers."""
    filled = [cell for cell in cells if cell]
    numbers = sum(map(is_number, filled))
    return numbers > 0 and numbers * 2 >= len(filled)


def _delimiter(rows: list[str]) -> str:
    """Return the separator that is in all rows, else the most frequent one; blanks if there are fewer separators than rows."""
    counts = {mark: [row.count(mark) for row in rows] for mark in ",;\t"}
    best = max(counts, key=lambda mark: (min(counts[mark]) > 0, sum(counts[mark])))
    return best if sum(counts[best]) >= len(rows) else " "


def _cells(row: str, delimiter: str) -> list[str]:
    cells = row.split() if delimiter == " " else row.strip().split(delimiter)
    return [cell.strip().strip('"') for cell in cells]


class Rows(io.RawIOBase):
    """The rows of numbers of a text file, as bytes that end with a whole line.

    Runs of blanks become commas, comments and a cut last line are left out. If the checksum of a packed file is wrong,
    everything from the first damaged line on is left out. ``faults`` has a note on each fault.
    """

    def __init__(self, path: Path, layout: Layout) -> None:
        """Open the file before its first row."""
        super().__init__()
        self.faults: list[str] = []
        self.bytes_read = 0
        self._file = source.open_unpacked(path)
        self._layout = layout
        self._delimiter = layout.parsed_delimiter.encode()
        self._tail = b""
        self._out = b""
        self._skip = layout.skip
        # For a damaged file, the note on the first damaged line replaces the note on the end of the unpacked data.
        self._pieces = source.pieces(self._file, [] if layout.fault else self.faults)
        self._good = 0  # rows so far of a damaged file
        self._least: tuple[int, int] | None = None  # fewest cells and shortest last cell of the last whole rows

    def readable(self) -> bool:
        """Return True; the parser calls this."""
        return True

    def is_empty(self) -> bool:
        """Return whether no row is left; this reads the next rows."""
        while not self._out:
            block = self._block()
            if not block and not self._tail:
                return True
            self._out = self._whole_lines(block)
            if not block:
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
        out, self._out = self._out[:size], self._out[size:]
        return out

    def _block(self) -> bytes:
        block = bytearray()
        for piece in self._pieces:
            block += piece
            if len(block) >= BLOCK:
                break
        self.bytes_read = source.position(self._file)
        return bytes(block)

    def _whole_lines(self, block: bytes) -> bytes:
        """Return the next whole lines as the parser needs them; an empty block ends the file."""
        data = self._tail + block
        cut = data.rfind(b"\n") + 1
        data, self._tail = (data[:cut], data[cut:]) if block else (self._without_cut_end(data, cut), b"")
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
        self._remember_sizes(data)
        return data

    def _without_cut_end(self, data: bytes, cut: int) -> bytes:
        """Return the file's end without a last line that has too few cells, or a last cell shorter than in all rows before."""
        last = data[cut:]
        if not last.strip() or self._least is None:
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
