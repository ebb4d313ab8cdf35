"""A part of an MCAP file by the index of its chunks; chunks without a row of the part are not read.

The index has the times of recording, from which a row's own stamp differs. So chunks are chosen with the differences that the first
chunk of each topic shows. Where these differences change by more than a second, a clock was set, and the index cannot show the part.
"""

from collections.abc import Iterator, Mapping
from functools import partial
from itertools import chain, pairwise
from typing import BinaryIO

from mcap.reader import make_reader
from mcap.records import ChunkIndex
from mcap.summary import Summary

from imuwb.readers.assembly.time_order import CLOCK_STEP
from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark, simulated
from imuwb.readers.bytes.ahead import ahead
from imuwb.readers.bytes.source import Source, opened
from imuwb.readers.bytes.unpack import LARGEST
from imuwb.readers.containers.mcap_extras import READ, above_sea_level, attachment_text, extras_notes
from imuwb.readers.containers.mcap_index import metadata_at
from imuwb.readers.containers.mcap_records import (
    CHUNK,
    DATA_END,
    MESSAGE,
    PREFIX,
    Recording,
    Records,
    unpacked_chunk,
)
from imuwb.readers.containers.messages import AHEAD, Channel, Messages, Piece, Schema, size_of
from imuwb.readers.containers.topics import Topics
from imuwb.readers.read_options import ReadOptions
from imuwb.ros import MCAP_MAGIC, OURS, TRUTH
from imuwb.units import SECOND

BEGINNING = 12 * SECOND  #: ns; all chunks of this time from the start on are read: the first rows of a part's streams
MOST_LOOSE = 10_000  #: number of records outside chunks that are looked at; a file with more is read from its beginning


def part(path: Source, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the first chunks, and of the chunks that may have rows within the limits, in the file's order.

    Raises:
        CannotSeekError: the file has no index, or its chunks are in no order of time.
    """
    recording = _Chunks(path)
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


class _Chunks(Recording):
    """The chunks of an MCAP file with an index, by their place in the file."""

    def __init__(self, log: Source) -> None:
        """Read the index.

        Raises:
            CannotSeekError: there is none, or the chunks are in no order of time.
        """
        super().__init__(log)
        self._index: list[ChunkIndex] = []
        with opened(log) as file:
            try:
                known = self._read_index(file)
            except Exception as error:  # a damaged index may raise anything in the library
                raise CannotSeekError from error
        if not known:
            raise CannotSeekError

    def _read_index(self, file: BinaryIO) -> bool:
        """Declare the channels, and return whether the index shows all messages, chunk after chunk in the order of time."""
        summary = make_reader(file).get_summary()
        if summary is None or summary.statistics is None or not summary.chunk_indexes:
            return False
        self._index = sorted(summary.chunk_indexes, key=lambda chunk: chunk.chunk_start_offset)
        self._declare_all(file, summary)
        ordered = all(b.message_start_time >= a.message_end_time - CLOCK_STEP for a, b in pairwise(self._index))
        whole = len(self._index) == summary.statistics.chunk_count and not _has_loose_messages(file, self._index)
        return whole and ordered and all(chunk.message_index_offsets for chunk in self._index)

    def _declare_all(self, file: BinaryIO, summary: Summary) -> None:
        for number, schema in summary.schemas.items():
            self.schemas[number] = Schema(schema.name, schema.encoding, schema.data)
        for number, channel in summary.channels.items():
            self.channels[number] = Channel(channel.topic, channel.message_encoding, channel.schema_id)
        for name, entries in (metadata_at(file, i) for i in summary.metadata_indexes if i.name in (OURS, TRUTH)):
            self.above_sea |= above_sea_level((name, entries))
            self.truth |= entries if name == TRUTH else {}
        extras = [f"metadata {index.name}" for index in summary.metadata_indexes if index.name not in READ]
        extras += [attachment_text(a.name, a.media_type, a.data_size) for a in summary.attachment_indexes]
        self.notes += extras_notes(extras)

    def first(self) -> list[int]:
        """Return the places of the chunks at the beginning, and of the first chunk of each channel."""
        start = min(chunk.message_start_time for chunk in self._index)
        first = {i for i, chunk in enumerate(self._index) if chunk.message_start_time <= start + BEGINNING}
        known = set[int]()
        for i, chunk in enumerate(self._index):
            if not chunk.message_index_offsets.keys() <= known:
                first.add(i)
                known |= chunk.message_index_offsets.keys()
        return sorted(first)

    def between(self, start: int, end: int, lags: Mapping[str, tuple[int, int]]) -> Iterator[int]:
        """Yield the places of the chunks with a topic whose rows may lie between two times (ns)."""
        for i, chunk in enumerate(self._index):
            topics = {self.channels[number].topic for number in chunk.message_index_offsets if number in self.channels}
            for least, largest in (lags[topic] for topic in topics if topic in lags):
                if chunk.message_end_time + largest >= start and chunk.message_start_time + least < end:
                    yield i
                    break

    def messages_of(self, places: list[int]) -> Iterator[tuple[int, list[Messages]]]:
        """Yield places of chunks, each with the chunk's messages."""
        for place, piece in zip(places, ahead(self._read(places), AHEAD, size_of), strict=True):
            self.notes.extend(piece.notes)
            yield place, list(self._messages(piece))

    def _read(self, places: list[int]) -> Iterator[Piece[Records]]:
        with opened(self.log) as file:
            for chunk in (self._index[place] for place in places):
                file.seek(chunk.chunk_start_offset)
                record = file.read(min(chunk.chunk_length, LARGEST))
                if record[:1] != bytes([CHUNK]) or len(record) < chunk.chunk_length:
                    raise CannotSeekError
                end = chunk.chunk_start_offset + chunk.chunk_length
                yield self._chunk(partial(unpacked_chunk, memoryview(record)[PREFIX:]), end - len(record) + PREFIX, end)


def _has_loose_messages(file: BinaryIO, chunks: list[ChunkIndex]) -> bool:
    """Return whether messages are, or may be, outside the chunks."""
    after = {
        chunk.chunk_start_offset: chunk.chunk_start_offset + chunk.chunk_length + chunk.message_index_length
        for chunk in chunks
    }
    at, looked = len(MCAP_MAGIC), 0
    while looked < MOST_LOOSE:
        if at in after:
            at = after[at]
            continue
        file.seek(at)
        prefix = file.read(PREFIX)
        if len(prefix) < PREFIX or prefix[0] in (MESSAGE, DATA_END):
            return prefix[:1] != bytes([DATA_END])
        at += PREFIX + int.from_bytes(prefix[1:], "little")
        looked += 1
    return True
