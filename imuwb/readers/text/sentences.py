"""Logs of sentences: lines with a tag, of instruments (VectorNav, NovAtel, FlySight) and of phones (GetSensorData, GNSSLogger).

What each sentence means is data, in ``shapes/sentences.toml``. FlySight's ``$COL`` and ``$UNIT`` state it in the file.
"""

from collections.abc import Iterator
from pathlib import Path

from imuwb.readers.batch import Batch, Remark
from imuwb.readers.read_options import ReadOptions

format = "sentences"  # noqa: A001 - the contract's name
uses = ("units", "frame", "epoch")
LEAST = 3  #: known sentences that a log begins with
PROBED = 400  #: lines of the head that are looked at


def probe(head: bytes) -> bool:
    """Return whether some of the first lines are known sentences with a correct checksum."""
    if b"\0" in head or not (b"," in head or b";" in head):
        return False
    from imuwb.readers.text.sentence_lines import line_of  # noqa: PLC0415 - the files of most other readers have zero bytes
    from imuwb.readers.text.shapes.sentence import DESCRIBED, sentences  # noqa: PLC0415

    known, count = sentences(), 0
    for text in head.split(b"\n")[:PROBED]:
        line = line_of(text)
        if line is not None and line.tag == DESCRIBED:
            return True
        if line is not None and line.sound:
            sentence = known.by_tag.get(line.tag)
            count += line.tag in known.refused if sentence is None else sentence.fits(line.cells)
    return count >= LEAST


def stream(path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of the sentences.

    Raises:
        UsageError: the sentences have no time or no scale, and no option states it.
        UnreadableLogError: none of the sentences can be used.
    """
    from imuwb.readers.bytes import source  # noqa: PLC0415 - a probe needs no streams
    from imuwb.readers.text.sentence_lines import line_of  # noqa: PLC0415
    from imuwb.readers.text.sentence_log import SentenceLog  # noqa: PLC0415

    log, notes = SentenceLog(path, options), list[str]()
    head = (line for text in source.head(path).split(b"\n")[:-1] if (line := line_of(text)) is not None)
    log.describe(head)
    with source.open_unpacked(path) as file:
        for block, _ in source.lines(piece for piece, _ in source.blocks(file, notes)):
            for text in block.split(b"\n"):
                if (line := line_of(text)) is not None:
                    log.take(line)
            yield from log.full(source.position(file))
        yield from log.rest(source.position(file))
    yield from map(Remark, notes)
    yield from log.remarks()
