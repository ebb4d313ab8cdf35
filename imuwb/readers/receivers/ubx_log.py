"""The messages of a u-blox log by kind, the text between them, and what is wrong with its frames."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.gather import columns, gather
from imuwb.readers.receivers.nmea_sentences import Sentences
from imuwb.readers.receivers.ubx_frames import Frames, gaps, scan
from imuwb.readers.receivers.ubx_messages import LAYOUTS, MEASURED, SENSORS, name_of

Values = Mapping[str, NDArray[Any]]
TAG_VALID = 8  #: flag of ESF-MEAS: the last four bytes are a second time tag


class UbxLog:
    """A u-blox log, read to its end."""

    def __init__(self, path: source.Source) -> None:
        """Read the file."""
        self.failed = self.short = self.frames = self.bytes_read = 0
        self.counts = Counter[int]()  #: messages of each kind
        self.notes: list[str] = []  #: notes on the packed file
        self.sentences = Sentences()  #: NMEA between the frames
        self._pieces: dict[int, list[dict[str, NDArray[Any]]]] = defaultdict(list)
        with source.open_unpacked(path) as file:
            rest, offset = b"", 0
            for block, last in source.blocks(file, self.notes):
                data = rest + block
                end = self._take(data, offset, last=last)
                self.bytes_read = source.position(file)
                rest, offset = data[end:], offset + end

    def rows(self, kind: int) -> Values | None:
        """Return the fields of all messages of a kind, with their ``place`` in the file; None without one."""
        pieces = self._pieces.get(kind)
        if not pieces:
            return None
        return {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}

    def faults(self) -> Iterator[Note]:
        """Yield what is wrong with the frames."""
        counts = {
            "checksum_failed": (self.failed, "frames whose checksum is wrong, not used"),
            "short_message": (self.short, "messages that are shorter than their fields, not used"),
            "no_frame": (self.sentences.other, "bytes that belong to no UBX frame and no NMEA sentence"),
        }
        yield from (Note(name, f"{count} {text}") for name, (count, text) in counts.items() if count)

    def unused(self) -> list[str]:
        """Return the names of messages that have no field which is used, with their numbers."""
        known = {*LAYOUTS, *SENSORS}
        return [f"{name_of(kind)} ({count})" for kind, count in sorted(self.counts.items()) if kind not in known]

    def _take(self, data: bytes, offset: int, *, last: bool) -> int:
        """Keep the rows of a block; return where the next block begins."""
        buffer = np.frombuffer(data, np.uint8)
        frames = scan(buffer, last=last)
        self.failed += frames.failed
        self.frames += frames.start.size
        kinds, numbers = np.unique(frames.kind, return_counts=True)
        self.counts.update(dict(zip(kinds.tolist(), numbers.tolist(), strict=True)))
        for kind in (*LAYOUTS, *SENSORS):
            mine = np.flatnonzero(frames.kind == kind)
            needed = LAYOUTS[kind].length if kind in LAYOUTS else sum(SENSORS[kind])
            whole = mine[frames.length[mine] >= needed]
            self.short += mine.size - whole.size
            if whole.size:
                at = frames.payload[whole]
                values = (
                    columns(LAYOUTS[kind].fields, buffer, at)
                    if kind in LAYOUTS
                    else _measurements(kind, buffer, at, frames.length[whole], offset)
                )
                self._pieces[kind].append({"place": at + offset, **values} if kind in LAYOUTS else values)
        return self._take_text(data, frames, offset, last=last)

    def _take_text(self, data: bytes, frames: Frames, offset: int, *, last: bool) -> int:
        """Keep the sentences between the frames; return where the next block begins."""
        for begin, end in gaps(frames):
            open_end = end == frames.end and not last
            done = self.sentences.take(data[begin:end], offset + begin, last=not open_end)
            if open_end:
                return begin + done
        return frames.end


def _measurements(kind: int, buffer: Bytes, at: Integers, length: Integers, offset: int) -> dict[str, NDArray[Any]]:
    """Return the measurements of a sensor's messages: the message's place, tag, type, and a number of 24 bits with a sign."""
    head, size = SENSORS[kind]
    words = (length - head) // size
    source_of = np.zeros(at.size, np.uint16)
    if kind == MEASURED:
        flags = gather(buffer, at + 4, "<u2")
        words = words - ((flags & TAG_VALID) > 0)
        source_of = gather(buffer, at + 6, "<u2")
    message = np.repeat(np.arange(at.size), words)
    place = at[message] + head + size * (np.arange(message.size) - np.repeat(np.cumsum(words) - words, words))
    word = gather(buffer, place, "<u4")
    tag = gather(buffer, at, "<u4")[message] if kind == MEASURED else gather(buffer, place + 4, "<u4")
    # A day has tens of millions of measurements, so each field has its own small type.
    return {
        "place": at[message] + offset, "source": source_of[message], "tag": tag,
        "type": ((word >> 24) & (0x3F if kind == MEASURED else 0xFF)).astype(np.uint8),
        "number": (word << 8).astype(np.uint32).view(np.int32) >> 8,
    }  # fmt: skip
