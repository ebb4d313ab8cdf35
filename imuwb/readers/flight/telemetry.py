"""The messages of a telemetry log by system, component and number, and what is wrong with its frames."""

from collections import defaultdict
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Integers
from imuwb.log import Nanoseconds
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.gather import gather
from imuwb.readers.flight.mavlink_fields import LAYOUTS, decoded
from imuwb.readers.flight.mavlink_frames import scan

Values = Mapping[str, NDArray[Any]]
Key = tuple[int, int, int]
Rows = tuple[Integers, Nanoseconds, dict[str, NDArray[Any]]]

#: µs of the years 2000 and 2100; a time outside is damage
EARLIEST, LATEST = 946_684_800_000_000, 4_102_444_800_000_000
MICRO = 1000  #: ns


def has_frame(head: bytes) -> bool:
    """Return whether the first bytes of a file have a frame whose checksum is correct, after a possible time."""
    buffer = np.frombuffer(head, np.uint8)
    recorded = gather(buffer, scan(buffer, last=False).record, ">u8")
    return bool(((recorded > EARLIEST) & (recorded < LATEST)).any())


class Telemetry:
    """A telemetry log, read to its end."""

    def __init__(self, path: Path) -> None:
        """Read the file."""
        self.frames = self.failed = self.unknown = self.skipped = self.impossible = self.bytes_read = 0
        self.notes: list[str] = []  #: notes on the packed file
        self.counts: dict[int, int] = defaultdict(int)  #: sound frames by the number of their message
        self._pieces: dict[Key, list[Rows]] = defaultdict(list)  #: block by block
        with source.open_unpacked(path) as file:
            rest, offset = b"", 0
            for block, last in source.blocks(file, self.notes):
                data = rest + block
                end = self._take(data, offset, last=last)
                self.bytes_read = source.position(file)
                rest, offset = data[end:], offset + end

    def rows(self) -> dict[Key, Rows]:
        """Return the rows of each message; the rows are not kept, so this can be called once."""
        return {key: _joined(self._pieces.pop(key)) for key in sorted(self._pieces)}

    @property
    def has_rows(self) -> bool:
        """Whether any message of a kind that is used was found."""
        return bool(self._pieces)

    def faults(self) -> Iterator[Note]:
        """Yield what is wrong with the frames."""
        counts = {
            "checksum_failed": (self.failed, "frames whose checksum is wrong, not used"),
            "unknown_message": (self.unknown, "frames of messages in no public dialect, not used"),
            "no_frame": (self.skipped, "bytes that belong to no frame"),
            "impossible_time": (self.impossible, "frames with an impossible time of the recorder, not used"),
        }
        yield from (Note(name, f"{count} {text}") for name, (count, text) in counts.items() if count)

    def _take(self, data: bytes, offset: int, *, last: bool) -> int:
        """Keep the rows of a block; return where the next block begins."""
        buffer = np.frombuffer(data, np.uint8)
        frames = scan(buffer, last=last)
        self.frames += frames.number.size
        self.failed += frames.failed
        self.unknown += frames.unknown
        self.skipped += frames.skipped + (buffer.size - frames.end if last else 0)
        recorded = gather(buffer, frames.record, ">u8")
        possible = (recorded > EARLIEST) & (recorded < LATEST)
        self.impossible += int(np.count_nonzero(~possible))
        counts = np.bincount(frames.number)  # a sound frame is of a known message, whose number is below 65536
        for number in np.flatnonzero(counts):
            self.counts[int(number)] += int(counts[number])
        key = (frames.system << 40) | (frames.component << 32) | frames.number
        wanted = np.flatnonzero(possible & np.isin(frames.number, list(LAYOUTS)))
        keys = key[wanted]
        for message in np.unique(keys):
            rows = wanted[keys == message]
            number = int(frames.number[rows[0]])
            values = decoded(LAYOUTS[number], buffer, frames.payload[rows], frames.length[rows])
            piece = offset + frames.record[rows], recorded[rows].astype(np.int64) * MICRO, values
            self._pieces[int(frames.system[rows[0]]), int(frames.component[rows[0]]), number].append(piece)
        return frames.end


def _joined(pieces: list[Rows]) -> Rows:
    place, recorded, values = zip(*pieces, strict=True)
    columns = {name: np.concatenate([piece[name] for piece in values]) for name in values[0]}
    return np.concatenate(place), np.concatenate(recorded), columns
