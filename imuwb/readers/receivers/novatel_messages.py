"""The messages of a binary log of NovAtel as the sentences of its ASCII logs, whose meaning is in ``text/shapes/sentences.toml``."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from imuwb.errors import UnreadableLogError
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.readers.bytes import source
from imuwb.readers.read_options import ReadOptions
from imuwb.readers.text.sentence_lines import Line, line_of
from imuwb.readers.text.sentence_log import SentenceLog
from imuwb.readers.text.shapes.sentence import sentences

PIECE = 65_536  #: bytes that the parser takes at once


def streamed(path: source.Source, options: ReadOptions) -> Iterator[Batch | Remark]:
    """Yield the streams of the messages.

    Raises:
        UnreadableLogError: novatel-edie is not installed, or no message can be used.
        UsageError: the scale of an IMU is unknown.
    """
    log, notes = SentenceLog(Path(str(path)), options), list[str]()
    parser, unknown, absurd = _parser(path), 0, 0
    with source.open_unpacked(path) as file:
        for block, _ in source.blocks(file, notes):
            for begin in range(0, len(block), PIECE):
                parser.write(block[begin : begin + PIECE])
                try:
                    for message in parser:
                        line = _line(message)
                        if line is None:
                            unknown += len(getattr(message, "data", b""))
                        else:
                            log.take(line)
                except MemoryError:  # of the library, which makes room for what a message states
                    absurd += 1
                    parser = _parser(path)
                yield from log.full(source.position(file))
        yield from log.rest(source.position(file))
    yield from map(Remark, notes)
    yield from log.remarks()
    unknown += parser.flush()
    if absurd:
        text = f"{absurd} messages state more values than they have, so each is left out with the {PIECE} bytes around it at most"
        yield Remark(Note("absurd_message", text))
    if unknown:
        yield Remark(Note("no_frame", f"{unknown} bytes that belong to no message with a correct checksum"))


def _parser(path: source.Source) -> Any:  # noqa: ANN401 - of a library without types
    try:
        import novatel_edie  # noqa: PLC0415 - an extra
        from novatel_edie import oem  # noqa: PLC0415
    except ImportError as error:
        raise UnreadableLogError(
            f'{path}: a binary log of NovAtel needs novatel-edie, which is not installed: pip install "imuwb[novatel]"; or convert the log '
            "to ASCII with NovAtel's Convert"
        ) from error
    novatel_edie.disable_internal_logging()
    parser = oem.Parser()
    parser.return_unknown_bytes = True
    return parser


def _line(message: Any) -> Line | None:  # noqa: ANN401 - of a library without types
    """Return a message as a sentence, without its cells if they are not used; None for bytes that are no message."""
    name = getattr(message, "name", None)
    if name is None:
        return None
    if f"{name}A" not in sentences().by_tag:
        return Line(f"{name}A", (), sound=True)
    return line_of(message.to_ascii().message)
