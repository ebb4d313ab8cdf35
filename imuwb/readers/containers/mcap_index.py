"""The summary of an MCAP file from its index: streams, counts and times, without reading the messages."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from mcap.reader import make_reader

from imuwb.errors import ImuwbError
from imuwb.notes import Note
from imuwb.readers.bytes import source
from imuwb.readers.bytes.source import Source
from imuwb.readers.bytes.unpack import LARGEST
from imuwb.readers.containers.decoders import CannotDecodeError, decoder_of
from imuwb.readers.containers.mcap_extras import READ, above_sea_level, attachment_text, extras_notes, metadata
from imuwb.readers.containers.mcap_records import HEADER, MESSAGE, PREFIX, unpacked_chunk, unpacked_front
from imuwb.readers.containers.messages import Channel, Messages, Schema
from imuwb.readers.containers.recording_folder import Parts
from imuwb.readers.containers.ros_definitions import Definitions
from imuwb.readers.containers.topic import UNIX, origin_of, recognise
from imuwb.readers.containers.unused_topics import Unused, unused_topics
from imuwb.readers.read_options import ReadOptions
from imuwb.ros import OURS, TRUTH
from imuwb.summary import LogSummary, StreamSummary
from imuwb.units import SECOND

if TYPE_CHECKING:
    from mcap.records import ChunkIndex, MetadataIndex
    from mcap.summary import Summary

FRONT = 1 << 16  #: bytes of a chunk that are read first
_NOTHING = np.zeros(0, np.int64)
_NO_MESSAGES = Messages(_NOTHING.astype(np.uint8), _NOTHING, _NOTHING, _NOTHING, _NOTHING, _NOTHING, 0)


def describe(path: Source, options: ReadOptions) -> LogSummary | None:
    """Return the summary from the index; None without an index.

    The times are those of the recorder; their resolution is a chunk. Only the messages show gaps and repairs.
    """
    with source.opened(path) as file:
        try:
            reader = make_reader(file)
            summary = reader.get_summary()
            if summary is None or summary.statistics is None or not summary.chunk_indexes:
                return None
            records = [metadata_at(file, index) for index in summary.metadata_indexes if index.name in (OURS, TRUTH)]
            above = set[str]().union(*map(above_sea_level, records))
            truth = next((entries for name, entries in records if name == TRUTH), {})
            extras = [f"metadata {index.name}" for index in summary.metadata_indexes if index.name not in READ]
            extras += [attachment_text(a.name, a.media_type, a.data_size) for a in summary.attachment_indexes]
            unused: list[Unused] = []
            definitions = Definitions(options.messages)
            streams = tuple(_streams(file, summary, _Known(above, definitions, options.frame), unused))
        except ImuwbError:  # the transfer of a remote log ended
            raise
        except Exception:  # noqa: BLE001 - a damaged index may raise anything in the library
            return None  # the reader of the messages reports the damage, and uses the whole messages
    text = (
        "from the file's index: the times are when messages were recorded, and a topic is one stream, although its messages may be of several "
        "sensors; --scan tells these apart, and finds gaps and repairs"
    )
    notes = [Note("from_index", text), *extras_notes(extras)]
    notes += [Note("unused", remark.text) for remark in unused_topics(unused)]
    return LogSummary(str(path), "mcap", "", streams, tuple(notes), truth)


def stated(path: Source) -> dict[str, str]:
    """Return the metadata records that the index names, {"NAME.KEY": text}; empty without an index."""
    with source.opened(path) as file:
        try:
            summary = make_reader(file).get_summary()
            records = [metadata_at(file, index) for index in summary.metadata_indexes] if summary is not None else []
        except ImuwbError:  # the transfer of a remote log ended
            raise
        except Exception:  # noqa: BLE001 - a damaged index may raise anything in the library
            return {}
    return {f"{name}.{key}": text for name, entries in records for key, text in entries.items()}


def describe_parts(folder: Path, parts: Parts, options: ReadOptions) -> LogSummary | None:
    """Return the summary of a recording's parts from their indexes; None if a part has no index."""
    summaries = [describe(file, options) for file in parts.files]
    known = [summary for summary in summaries if summary is not None]
    if len(known) < len(summaries):
        return None
    streams: dict[tuple[str, str], StreamSummary] = {}
    for stream in (stream for summary in known for stream in summary.streams):
        key = stream.name, stream.kind
        streams[key] = _joined(streams[key], stream) if key in streams else stream
    notes = [note for summary in known for note in summary.notes]
    truth = {name: value for summary in known for name, value in summary.truth.items()}
    return LogSummary(
        str(folder), "mcap", "", tuple(streams.values()), tuple(dict.fromkeys((*parts.notes, *notes))), truth
    )


def _joined(one: StreamSummary, other: StreamSummary) -> StreamSummary:
    """Return a stream of which two parts of a recording have rows."""
    start, end, count = min(one.start_ns, other.start_ns), max(one.end_ns, other.end_ns), one.count + other.count
    rate = (count - 1) / (end - start) * SECOND if end > start else None
    return replace(one, count=count, rate_hz=rate, start_ns=start, end_ns=end)


def metadata_at(file: BinaryIO, index: MetadataIndex) -> tuple[str, dict[str, str]]:
    """Return the name and the entries of the metadata at a place of the index."""
    file.seek(index.offset + PREFIX)
    return metadata(file.read(min(index.length - PREFIX, LARGEST)))


@dataclass(frozen=True, slots=True)
class _Known:
    """What is known beside the index."""

    above: set[str]  #: topics whose heights are above mean sea level
    definitions: Definitions
    frame: str | None  #: of an IMU, as the user states it


def _streams(file: BinaryIO, summary: Summary, known: _Known, unused: list[Unused]) -> Iterator[StreamSummary]:
    """Yield the streams; topics that are none are added to ``unused``."""
    for number, count in (summary.statistics.channel_message_counts if summary.statistics else {}).items():
        channel, schema = summary.channels[number], summary.schemas.get(summary.channels[number].schema_id)
        ours = None if schema is None else Schema(schema.name, schema.encoding, schema.data)
        name = ours.name if ours else ""
        chunks = [chunk for chunk in summary.chunk_indexes if number in chunk.message_index_offsets]
        if not chunks or not count:
            continue
        declared = Channel(channel.topic, channel.message_encoding, channel.schema_id)
        try:
            decoder = decoder_of(declared, ours, known.definitions)
            shown = _NO_MESSAGES if decoder.defined else _first(file, chunks[0], number)
            fields = decoder.fields(shown, np.zeros(1, np.int64))
        except CannotDecodeError as error:
            unused.append(Unused(channel.topic, name, count, str(error)))
            continue
        start, end = min(c.message_start_time for c in chunks), max(c.message_end_time for c in chunks)
        rate = (count - 1) / (end - start) * SECOND if end > start else None
        recipes, why = recognise(fields, name, channel.topic)
        if why:
            unused.append(Unused(channel.topic, name, count, why))
        for recipe in (r for r in recipes if r.kind != "orientation"):  # only the messages show whether it is set
            origin = origin_of(recipe, known.frame, above_sea=channel.topic in known.above, schema=name)
            epoch = "unix" if start > UNIX else "log"
            yield StreamSummary(
                channel.topic, recipe.kind, count, rate, start, end, epoch, (), (), origin.units, origin.frame
            )


def _first(file: BinaryIO, chunk: ChunkIndex, number: int) -> Messages:
    """Return a channel's first message in a chunk; of a large chunk only the front with the message is read."""
    size, part = min(chunk.chunk_length, LARGEST) - PREFIX, FRONT
    while True:
        file.seek(chunk.chunk_start_offset + PREFIX)
        content = file.read(min(part, size))
        found = _message(unpacked_chunk(memoryview(content)) if part >= size else unpacked_front(content), number)
        if found is not None:
            return found
        if part >= size:
            at = chunk.chunk_start_offset
            raise ValueError(f"the index states a message of channel {number} in the chunk at byte {at}; there is none")
        part *= 4


def _message(records: bytes | memoryview, number: int) -> Messages | None:
    """Return a channel's first whole message among records."""
    at = 0
    while at + PREFIX <= len(records):
        opcode, content = records[at], at + PREFIX
        at = content + int.from_bytes(records[at + 1 : content], "little")
        ours = opcode == MESSAGE and int.from_bytes(records[content : content + 2], "little") == number
        if ours and at <= len(records):
            payload, zero = np.frombuffer(records[content + HEADER : at], np.uint8), np.zeros(1, np.int64)
            return Messages(payload, zero.astype(np.uint16), zero, zero, zero, zero + payload.size, 0)
    return None
