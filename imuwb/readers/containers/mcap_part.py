"""A part of an MCAP file by the index of its chunks."""

from collections.abc import Iterator
from functools import partial
from typing import BinaryIO

from mcap.reader import make_reader
from mcap.records import ChunkIndex
from mcap.summary import Summary

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes.source import Source, opened
from imuwb.readers.bytes.unpack import LARGEST
from imuwb.readers.containers.chunk_part import Chunk, IndexedFile, part_of
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
from imuwb.readers.containers.messages import Channel, Piece, Schema
from imuwb.readers.read_options import ReadOptions
from imuwb.ros import MCAP_MAGIC, OURS, TRUTH

MOST_LOOSE = 10_000  #: number of records outside chunks that are looked at; a file with more is read from its beginning


def part(path: Source, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the first chunks, and of the chunks that may have rows within the limits, in the file's order.

    Raises:
        CannotSeekError: the file has no index, or its chunks are in no order of time.
    """
    return part_of(_Chunks(path), options, limits)


class _Chunks(Recording, IndexedFile[Records]):
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
        self.check_order()

    def _read_index(self, file: BinaryIO) -> bool:
        """Declare the channels, and return whether the index shows all messages, chunk after chunk in the order of time."""
        summary = make_reader(file).get_summary()
        if summary is None or summary.statistics is None or not summary.chunk_indexes:
            return False
        self._index = sorted(summary.chunk_indexes, key=lambda chunk: chunk.chunk_start_offset)
        self._declare_all(file, summary)
        self.chunks = tuple(
            Chunk(c.chunk_start_offset, c.message_start_time, c.message_end_time, frozenset(c.message_index_offsets))
            for c in self._index
        )
        whole = len(self._index) == summary.statistics.chunk_count and not _has_loose_messages(file, self._index)
        return whole and all(chunk.message_index_offsets for chunk in self._index)

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

    def read_chunks(self, places: list[int]) -> Iterator[Piece[Records]]:
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
