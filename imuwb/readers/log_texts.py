"""The words of a log as data: all names and sentences that readers give pass through here, so that no output meets what they contain.

A topic may be named with escapes of a terminal, with marks that turn the direction of a text, or with a thousand letters.
"""

from dataclasses import replace

from imuwb.log import Origin
from imuwb.notes import Note
from imuwb.readers.batch import Batch, Remark
from imuwb.summary import LogSummary
from imuwb.texts import name_of, printable, sentence_of


def shown(part: Batch | Remark) -> Batch | Remark:
    """Return a part of a log with words that can be shown."""
    if isinstance(part, Batch):
        stream, origin = name_of(part.stream), _origin(part.origin)
        if stream == part.stream and origin is part.origin:
            return part
        return replace(part, stream=stream, origin=origin)
    truth = {name_of(name): sentence_of(value) for name, value in part.truth.items()}
    return replace(part, text=_note(part.text), stream=name_of(part.stream), truth=truth)


def shown_summary(summary: LogSummary) -> LogSummary:
    """Return a summary with words that can be shown."""
    streams = tuple(
        replace(s, name=name_of(s.name), units=printable(s.units), frame=printable(s.frame)) for s in summary.streams
    )
    truth = {name_of(name): sentence_of(value) for name, value in summary.truth.items()}
    return replace(summary, streams=streams, notes=tuple(map(_note, summary.notes)), truth=truth)


def _origin(origin: Origin) -> Origin:
    units, frame = sentence_of(origin.units), sentence_of(origin.frame)
    return origin if (units, frame) == (origin.units, origin.frame) else replace(origin, units=units, frame=frame)


def _note(text: str) -> str:
    clean = sentence_of(text)
    return text if clean == text else Note(getattr(text, "id", ""), clean)
