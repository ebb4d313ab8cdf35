"""A part of a recording by the index of its chunks; chunks without a row of the part are not read.

The index has the times of recording, from which a row's own stamp differs. So chunks are chosen with the differences that the first
chunk of each topic shows. Where these differences change by more than a second, a clock was set, and the index cannot show the part.
"""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain, pairwise

from imuwb.readers.assembly.time_order import CLOCK_STEP
from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark, simulated
from imuwb.readers.bytes.ahead import ahead
from imuwb.readers.containers.messages import AHEAD, Container, Messages, Piece, RecordFile, Records, size_of
from imuwb.readers.containers.topics import Topics
from imuwb.readers.read_options import ReadOptions
from imuwb.units import SECOND

BEGINNING = 12 * SECOND  #: ns; all chunks of this time from the start on are read: the first rows of a part's streams


@dataclass(frozen=True, slots=True)
class Chunk:
    """What the index states of a chunk."""

    offset: int  #: of its record in the file, or the number of a group of rows
    start: int  #: ns, time of recording of its first message
    end: int  #: ns, of its last message
    channels: frozenset[int]  #: whose messages it has


class Indexed(Container):
    """A recording with an index of its chunks. ``chunks`` are all chunks in the order of the file, channels and schemas are declared."""

    chunks: tuple[Chunk, ...]

    @abstractmethod
    def messages_of(self, places: list[int]) -> Iterator[tuple[int, list[Messages]]]:
        """Yield places of chunks, each with the chunk's messages."""

    def check_order(self) -> None:
        """Raise CannotSeekError unless the chunks follow each other in time."""
        if not self.chunks or any(b.start < a.end - CLOCK_STEP for a, b in pairwise(self.chunks)):
            raise CannotSeekError

    def first(self) -> list[int]:
        """Return the places of the chunks at the beginning, and of the first chunk of each channel."""
        start = min(chunk.start for chunk in self.chunks)
        first = {i for i, chunk in enumerate(self.chunks) if chunk.start <= start + BEGINNING}
        known = set[int]()
        for i, chunk in enumerate(self.chunks):
            if not chunk.channels <= known:
                first.add(i)
                known |= chunk.channels
        return sorted(first)

    def between(self, start: int, end: int, lags: Mapping[str, tuple[int, int]]) -> Iterator[int]:
        """Yield the places of the chunks with a topic whose rows may lie between two times (ns)."""
        for i, chunk in enumerate(self.chunks):
            topics = {self.channels[number].topic for number in chunk.channels if number in self.channels}
            for least, largest in (lags[topic] for topic in topics if topic in lags):
                if chunk.end + largest >= start and chunk.start + least < end:
                    yield i
                    break


class IndexedFile(RecordFile[Records], Indexed):
    """Such a recording whose messages are records of bytes."""

    @abstractmethod
    def read_chunks(self, places: list[int]) -> Iterator[Piece[Records]]:
        """Yield the content of chunks, by their places in ``chunks``."""

    def messages_of(self, places: list[int]) -> Iterator[tuple[int, list[Messages]]]:
        """Yield places of chunks, each with the chunk's messages."""
        for place, piece in zip(places, ahead(self.read_chunks(places), AHEAD, size_of), strict=True):
            self.notes.extend(piece.notes)
            yield place, list(self._messages(piece))


def part_of(recording: Indexed, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the first chunks, and of the chunks that may have rows within the limits, in the file's order.

    Raises:
        CannotSeekError: the topics of the file, or its clock, do not show which chunks these are.
    """
    topics = Topics(recording, options)
    first = recording.first()
    held = {
        place: [batch for messages in found for batch in topics.batches(messages)]
        for place, found in recording.messages_of(first)
    }
    if topics.waiting:
        raise CannotSeekError
    lags = topics.lags
    start, end = limits(chain.from_iterable(held.values()))
    chosen = sorted({*held, *recording.between(start, end, lags)})
    rest = recording.messages_of([place for place in chosen if place not in held])
    for place in chosen:
        if place in held:
            yield from held.pop(place)
        else:
            for messages in next(rest)[1]:
                yield from topics.batches(messages)
    if any(not _near(lags.get(topic), lag) for topic, lag in topics.lags.items()):
        raise CannotSeekError
    yield from topics.rest()
    yield from map(Remark, recording.notes)
    yield from topics.remarks()
    if recording.truth:
        yield simulated(recording.truth)


def _near(before: tuple[int, int] | None, after: tuple[int, int]) -> bool:
    """Return whether the differences between stamps and the times of recording stayed the same."""
    return before is not None and before[0] - after[0] <= CLOCK_STEP and after[1] - before[1] <= CLOCK_STEP
