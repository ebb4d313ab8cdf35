"""A part of a ROS 1 bag by the index of its chunks.

Specification: http://wiki.ros.org/Bags/Format/2.0, bag header, connection and chunk info records.
"""

from collections.abc import Iterator
from functools import partial
from typing import BinaryIO

import numpy as np

from imuwb.readers.batch import Batch, CannotSeekError, Limits, Remark
from imuwb.readers.bytes import source
from imuwb.readers.bytes.source import Source
from imuwb.readers.bytes.unpack import LARGEST, unpack
from imuwb.readers.containers.bag_records import CHUNK, CONNECTION, Bag, Records, fields_of, packing_of, walk
from imuwb.readers.containers.chunk_part import Chunk, IndexedFile, part_of
from imuwb.readers.containers.messages import BAG_MAGIC, Piece
from imuwb.readers.read_options import ReadOptions
from imuwb.units import SECOND

CHUNK_INFO = 0x06
HEADER = 4096  #: bytes of the bag header, padded


def part(path: Source, options: ReadOptions, limits: Limits) -> Iterator[Batch | Remark]:
    """Yield the streams of the first chunks, and of the chunks that may have rows within the limits, in the file's order.

    Raises:
        CannotSeekError: the bag has no index, or its chunks are in no order of time.
    """
    return part_of(_Chunks(path), options, limits)


class _Chunks(Bag, IndexedFile[Records]):
    """The chunks of a bag with an index, by their place in the file."""

    def __init__(self, log: Source) -> None:
        """Read the index.

        Raises:
            CannotSeekError: there is none, or the chunks are in no order of time.
        """
        super().__init__(log)
        with source.opened(log) as file:
            try:
                self.chunks = self._read_index(file)
            except (ValueError, KeyError, IndexError) as error:  # a damaged index
                raise CannotSeekError from error
        self.check_order()

    def _read_index(self, file: BinaryIO) -> tuple[Chunk, ...]:
        """Declare the connections, and return the chunks; none without an index of all."""
        file.seek(len(BAG_MAGIC))
        width = int.from_bytes(file.read(4), "little")
        stated = fields_of(file.read(min(width, HEADER)))
        at, count = (int.from_bytes(stated[name], "little") for name in ("index_pos", "chunk_count"))
        size = source.size(self.log) - at
        if not at or not 0 < size <= LARGEST:
            return ()
        file.seek(at)
        buffer = np.frombuffer(file.read(size), np.uint8)
        records = walk(buffer)
        piece = Piece(buffer, records, at + size)
        for i in np.flatnonzero(records.opcode == CONNECTION):
            self._declare(piece, int(i))
        infos = np.flatnonzero(records.opcode == CHUNK_INFO)
        chunks = sorted((self._chunk_of(piece, int(i)) for i in infos), key=lambda chunk: chunk.offset)
        return tuple(chunks) if len(chunks) == count else ()

    def _chunk_of(self, piece: Piece[Records], i: int) -> Chunk:
        records, raw = piece.records, piece.buffer.data
        start, length = int(records.data[i]), int(records.length[i])
        stated = fields_of(bytes(raw[int(records.header[i]) : start - 4]))
        begin, end = (
            int.from_bytes(stated[name][:4], "little") * SECOND + int.from_bytes(stated[name][4:], "little")
            for name in ("start_time", "end_time")
        )
        connections = np.frombuffer(raw[start : start + length // 8 * 8], "<u4").reshape(-1, 2)[:, 0]
        return Chunk(int.from_bytes(stated["chunk_pos"], "little"), begin, end, frozenset(connections.tolist()))

    def read_chunks(self, places: list[int]) -> Iterator[Piece[Records]]:
        """Yield the content of chunks, by their places in ``chunks``."""
        with source.opened(self.log) as file:
            for chunk in (self.chunks[place] for place in places):
                file.seek(chunk.offset)
                head = file.read(min(int.from_bytes(file.read(4), "little"), HEADER))
                length = int.from_bytes(file.read(4), "little")
                if fields_of(head).get("op") != bytes([CHUNK]) or length > LARGEST:
                    raise CannotSeekError
                packed = memoryview(file.read(length))
                start = chunk.offset + 8 + len(head)
                yield self._chunk(partial(unpack, packed, *packing_of(head)), start, start + length)
