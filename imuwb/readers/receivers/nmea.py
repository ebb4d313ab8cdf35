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
#: kinds of sentences that receivers send besides those with positions
STANDARD = frozenset((
    b"GSA", b"GSV", b"GLL", b"VTG", b"GST", b"ZDA", b"GRS", b"GBS", b"DTM", b"TXT", b"VLW", b"THS", b"HDT", b"ROT", b"MSS", b"MSK", b"RLM",
))  # fmt: skip
CHECK = b"*"  #: stands before a checksum; some loggers write none
LEAST = 0.25  #: share of the first bytes that must be sentences; a log of an IMU may hold some of a receiver's, too


def probe(head: bytes) -> bool:
    """Return whether sentences with a correct checksum are a good part of the file's first bytes."""
    if b"$" not in head:
        return False
    from imuwb.readers.receivers.nmea_sentences import Sentences  # noqa: PLC0415 - other files need no decoder of sentences

    sentences = Sentences(checked=CHECK in head)
    sentences.take(head, 0, last=True)
    if not sentences.counts or len(head) - sentences.other < LEAST * len(head):
        return False
    # Sentences of unknown kinds may be another instrument's.
    return sentences.has_positions or all(kind[:1] == b"P" or kind in STANDARD for kind in sentences.counts)


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
        names = ", ".join(f"{kind.decode()} ({count})" for kind, count in sentences.counts.items()) or "nothing"
        raise UnreadableLogError(
            f"{path}: none of its NMEA sentences states a position: there is no whole GGA, GNS or RMC, but {names}"
        )
    if not checked:
        yield Remark(
            Note("unchecked", "the NMEA sentences have no checksums, so damage shows only where a cell is no number")
        )
    yield from map(Remark, notes)
    yield from streamed(sentences, bytes_read)
    if sentences.other:
        yield Remark(Note("no_frame", f"{sentences.other} bytes that belong to no NMEA sentence, not used"))
