"""NMEA 0183 sentences of a receiver, as text, with stamps of a host before them or binary data between them."""

from collections.abc import Iterator

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes.source import Source
from imuwb.readers.read_options import ReadOptions

format = "nmea"  # noqa: A001 - the contract's name
uses: tuple[str, ...] = ()
ranged = True
CHECK = b"*"  #: stands before a checksum; some loggers write none
LEAST = 0.25  #: share of the first bytes that must be sentences; a log of an IMU may hold some of a receiver's, too


def probe(head: bytes) -> bool:
    """Return whether sentences with a correct checksum are a good part of the file's first bytes, and some state positions."""
    if b"$" not in head:
        return False
    from imuwb.readers.receivers.nmea_sentences import Sentences  # noqa: PLC0415 - other files need no decoder of sentences

    sentences = Sentences(checked=CHECK in head)
    sentences.take(head, 0, last=True)
    positions = sum(sentences.counts[kind] for kind in (b"GGA", b"RMC", b"GNS"))
    return positions > 0 and len(head) - sentences.other >= LEAST * len(head)


def stream(path: Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the fixes; the whole file is read first, for its dates.

    Raises:
        UnreadableLogError: the file has no sentence with a position.
    """
    from imuwb.readers.bytes import source  # noqa: PLC0415 - a probe needs no streams
    from imuwb.readers.receivers.nmea_sentences import Sentences  # noqa: PLC0415
    from imuwb.readers.receivers.nmea_streams import streamed  # noqa: PLC0415

    checked = CHECK in source.head(path)
    sentences, notes, bytes_read = Sentences(checked=checked), list[str](), 0
    with source.open_unpacked(path) as file:
        rest, offset = b"", 0
        for block, last in source.blocks(file, notes):
            text = rest + block
            done = sentences.take(text, offset, last=last)
            bytes_read, rest, offset = source.position(file), text[done:], offset + done
    if not sentences.has_positions:
        raise UnreadableLogError(
            f"{path}: none of its NMEA sentences states a position: there is no whole GGA, GNS or RMC"
        )
    if not checked:
        yield Remark(
            Note("unchecked", "the NMEA sentences have no checksums, so damage shows only where a cell is no number")
        )
    yield from map(Remark, notes)
    yield from streamed(sentences, bytes_read)
    if sentences.other:
        yield Remark(Note("no_frame", f"{sentences.other} bytes that belong to no NMEA sentence, not used"))
