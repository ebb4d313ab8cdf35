"""Channels, schemas, and messages in a buffer: what MCAP, bag and db3 have in common."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from imuwb.arrays import Bytes, Integers
from imuwb.notes import Note
from imuwb.readers.bytes.ahead import ahead
from imuwb.readers.bytes.source import Source

BAG_MAGIC = b"#ROSBAG V2.0\n"
AHEAD = 2  #: pieces that are unpacked while another is decoded


@dataclass(frozen=True, slots=True)
class Schema:
    """The definition of a channel's messages."""

    name: str
    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic of one publisher."""

    topic: str
    message_encoding: str
    schema_id: int


@dataclass(frozen=True, eq=False, slots=True)
class Messages:
    """The messages of all channels in one buffer."""

    buffer: Bytes
    channel: NDArray[np.integer[Any]]  #: (n,)
    log_time: Integers  #: (n,) ns, when the message was recorded
    publish_time: Integers  #: (n,) ns, when the message was sent
    start: Integers  #: (n,) offset of the payload in the buffer
    length: Integers  #: (n,) bytes of the payload
    bytes_read: int  #: position in the file


class _Ending(Protocol):
    @property
    def end(self) -> int: ...


Records = TypeVar("Records", bound=_Ending)


@dataclass(frozen=True, eq=False, slots=True)
class Piece(Generic[Records]):
    """A block of the file, or an unpacked chunk."""

    buffer: Bytes
    records: Records
    bytes_read: int  #: position of its end in the file
    notes: tuple[Note, ...] = ()  #: notes on the faults of the piece


def size_of(piece: Piece[Any]) -> int:
    """Return the bytes of a piece."""
    return piece.buffer.nbytes


class Container(ABC):
    """A file of messages, read from its beginning to its end; schemas and channels are added on the way."""

    def __init__(self) -> None:
        """Nothing is read yet."""
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self.notes: list[Note] = []  #: notes on the faults of the part that is read
        self.truth: dict[str, str] = {}  #: parameters of a simulated log, by metadata that imuwb wrote
        self.above_sea: set[str] = set()  #: topics whose heights are above mean sea level, as far as the file states it

    @abstractmethod
    def messages(self) -> Iterator[Messages]:
        """Yield the messages, buffer by buffer."""


class RecordFile(Container, Generic[Records]):
    """A container whose messages are records of bytes, in chunks or not."""

    def __init__(self, log: Source) -> None:
        """Set the file, or the remote log; nothing is read yet."""
        super().__init__()
        self.log = log

    def messages(self) -> Iterator[Messages]:
        """Yield the messages of each chunk, or, in a file without chunks, of each block."""
        for piece in ahead(self._pieces(), AHEAD, size_of):
            self.notes.extend(piece.notes)
            yield from self._messages(piece)
            del piece  # a large one is gone before the next is unpacked

    @abstractmethod
    def _pieces(self) -> Iterator[Piece[Records]]: ...

    @abstractmethod
    def _messages(self, piece: Piece[Records]) -> Iterator[Messages]: ...

    @abstractmethod
    def _walk(self, buffer: Bytes) -> Records: ...

    def _piece(self, content: bytes | memoryview, end: int, *notes: Note) -> Piece[Records]:
        buffer = np.frombuffer(content, np.uint8)
        return Piece(buffer, self._walk(buffer), end, notes)

    def _chunk(self, unpacked: Callable[[], bytes | memoryview], offset: int, end: int) -> Piece[Records]:
        """Return the content of a chunk; nothing, and a note, if it is damaged."""
        try:
            piece = self._piece(unpacked(), end)
        except ValueError as error:
            return self._piece(b"", end, Note("chunk_left_out", f"chunk at byte {offset} left out: {error}"))
        rest = piece.buffer.size - piece.records.end
        text = f"chunk at byte {offset}: its last {rest} bytes do not form a record"
        return replace(piece, notes=(Note("chunk_end", text),)) if rest else piece
