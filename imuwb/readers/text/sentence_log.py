"""The sentences of a log, sorted by kind: decoded in pieces, and counted where they are not used."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import numpy as np

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark, unused
from imuwb.readers.gps_time import WEEK, unix_of_gps
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.column_names import columns
from imuwb.readers.text.sentence_lines import Line
from imuwb.readers.text.sentence_rows import Row, SentenceRows, device_of, exact
from imuwb.readers.text.shapes.recognition import ends_of
from imuwb.readers.text.shapes.sentence import DESCRIBED, Sentence, sentences
from imuwb.readers.text.shapes.shape import Meaning, Shape, shapes
from imuwb.units import SECOND

BAD_CHECK = Note("bad_checksum", "sentences with a wrong checksum left out")
SHORT = Note("odd_sentence", "sentences with another number of cells, or with impossible numbers, left out")
ROWS = 20_000  #: sentences that are decoded at once
#: FlySight's sentences about the file itself
_ABOUT = {DESCRIBED, "$UNIT", "$FLYS", "$VAR", "$DATA", "$TIME"}


class SentenceLog:
    """The sentences so far that are not decoded yet, and what was not used."""

    def __init__(self, path: Path, options: ReadOptions) -> None:
        """Begin a log."""
        self._path, self._options, self._known = path, options, sentences()
        self._by_tag: dict[str, Sentence] = dict(self._known.by_tag)
        self._rows: dict[tuple[str, str], SentenceRows] = {}
        self._waiting: dict[tuple[str, str], list[Row]] = defaultdict(list)
        self._unknown, self._faults = Counter[str](), Counter[tuple[str, Note]]()
        self._streams: dict[str, str] = {}  # tag -> name of its first stream
        self._offset: int | None = None
        self._imus = set[str]()  # names of the IMUs in the first lines

    def describe(self, head: Iterable[Line]) -> None:
        """Learn the sentences that the file itself describes, and the start of their clock."""
        names, units = dict[str, tuple[str, ...]](), dict[str, tuple[str, ...]]()
        tags = set[str]()
        for line in head:
            tags.add(line.tag)
            if line.tag == DESCRIBED and line.cells:
                names[line.cells[0]] = line.cells[1:]
            elif line.tag == "$UNIT" and line.cells:
                units[line.cells[0]] = line.cells[1:]
            elif line.tag == "$TIME" and names and self._offset is None:
                self._offset = _offset(line.cells)
        for tag, cells in names.items():
            sentence = _described(tag, cells, units.get(tag, ()))
            if sentence is not None:
                self._by_tag[f"${tag}"] = sentence
        self._imus = {self._by_tag[tag].stream for tag in tags if tag in self._by_tag and self._by_tag[tag].is_imu}

    def take(self, line: Line) -> None:
        """Take a sentence."""
        sentence = self._by_tag.get(line.tag)
        if sentence is None:
            self._unknown.update([line.tag] if line.tag not in _ABOUT else [])
            return
        if not line.sound or not sentence.fits(line.cells):
            self._faults[line.tag, BAD_CHECK if not line.sound else SHORT] += 1
            return
        if any(line.cells[cell].upper() != text for cell, text in sentence.only.items()):
            self._unknown[line.tag] += 1
            return
        key = line.tag, device_of(sentence, line)
        self._waiting[key].append(Row(line.cells, line.stamp))

    def full(self, bytes_read: int) -> Iterator[Batch]:
        """Yield the streams of the kinds of which many sentences wait."""
        for key in [key for key, waiting in self._waiting.items() if len(waiting) >= ROWS]:
            yield from self._decoded(key, bytes_read)

    def rest(self, bytes_read: int) -> Iterator[Batch]:
        """Yield the streams of all sentences that wait."""
        for key in list(self._waiting):
            yield from self._decoded(key, bytes_read)

    def _decoded(self, key: tuple[str, str], bytes_read: int) -> Iterator[Batch]:
        rows = self._waiting.pop(key)
        tag, device = key
        if key not in self._rows:
            sentence = self._by_tag[tag]
            name = "" if sentence.is_imu and len(self._imus) == 1 else sentence.stream
            self._rows[key] = SentenceRows(self._path, sentence, self._options, name, device, self._offset)
        for batch in self._rows[key].batches(rows, bytes_read):
            self._streams.setdefault(tag, batch.stream)
            yield batch

    def remarks(self) -> Iterator[Remark]:
        """Yield what was read, and what was left out.

        Raises:
            UnreadableLogError: nothing was read.
        """
        if not self._streams:
            why = next(
                (w for tag, w in self._known.refused.items() if tag in self._unknown), "none has an IMU or a fix"
            )
            raise UnreadableLogError(f"{self._path}: no sentence can be used ({_counted(self._unknown)}): {why}")
        for name in dict.fromkeys(self._by_tag[tag].shape.name for tag in self._streams):
            yield Remark(Note("shape", f"read as {name}"))
        for (tag, fault), count in self._faults.items():
            yield Remark(fault, self._streams.get(tag, tag), count)
        yield from self._unused()

    def _unused(self) -> Iterator[Remark]:
        for tag, count in self._unknown.items():
            if tag in self._known.refused:
                yield unused([f"{tag} ({count})"], self._known.refused[tag])
            elif tag in self._by_tag:
                yield unused([f"{tag} ({count})"], f"no {', '.join(self._by_tag[tag].only.values())}")
        others = Counter(
            {tag: count for tag, count in self._unknown.items() if tag not in {*self._known.refused, *self._by_tag}}
        )
        if others:
            yield unused(_counted(others).split(", "), "sentences that imuwb does not know")


def _counted(tags: Mapping[str, int]) -> str:
    return ", ".join(f"{tag} ({count})" for tag, count in tags.items()) or "there is none"


def _offset(cells: tuple[str, ...]) -> int | None:
    """Return ns since 1970 of the zero of FlySight's clock, by ``$TIME,time,tow,week``."""
    if len(cells) < 3:  # noqa: PLR2004 - three cells
        return None
    clock, tow, week = exact(cells[0], 9), exact(cells[1], 9), exact(cells[2], 0)
    if clock is None or tow is None or week is None or not (0 <= tow <= WEEK * SECOND and 0 < week < 10_000):  # noqa: PLR2004
        return None
    unix = unix_of_gps(np.array([week], np.int64), np.array([tow // 1_000_000], np.int64))
    return int(unix[0]) + tow % 1_000_000 - clock


def _described(tag: str, names: tuple[str, ...], units: tuple[str, ...]) -> Sentence | None:
    """Return the sentence that a file describes; None if it has no known quantity but its time."""
    measures = [*units, *[""] * (len(names) - len(units))]
    stated = tuple(f"{name} [{measure}]" if measure else name for name, measure in zip(names, measures, strict=False))
    row: list[Meaning | None] = [None] * len(names)
    for column in columns(stated, {}):
        row[column.index] = Meaning(column.quantity, column.axis, column.unit.name if column.unit else "", 1)
    receiver = next(shape for shape in shapes() if shape.name == "FlySight GNSS")
    if {"lat", "lon"} <= {name.lower() for name in names}:
        row = [
            next((receiver.columns[end] for end, _, _ in ends_of(n) if end in receiver.columns), None) for n in names
        ]
    known = {meaning.quantity for meaning in row if meaning is not None}
    if not known - {"time", "week"}:
        return None
    return Sentence(Shape("FlySight", "the file's own $COL and $UNIT", row=tuple(row), epoch="boot"), (f"${tag}",))
