"""Reads a file of any known format as a Log, a stream of pieces, or a summary."""

import os
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import cast

from imuwb import registry
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.log import Log, Provenance
from imuwb.notes import Note
from imuwb.progress import Progress
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch, Limits, Reader, Remark
from imuwb.readers.bytes import budget, source
from imuwb.readers.bytes.address import Place
from imuwb.readers.bytes.budget import Budget
from imuwb.readers.bytes.remote import RemoteLog
from imuwb.readers.bytes.source import Source
from imuwb.readers.log_texts import shown, shown_summary
from imuwb.readers.part_reading import read_part
from imuwb.readers.read_options import TIME_SOURCES, ReadOptions
from imuwb.readers.unread import unread_binary, unread_text
from imuwb.selection import Part
from imuwb.summary import LogSummary, summarize

#: Readers are asked in the order of their names, with these exceptions: MCAP is first; after the formats with a magic number come
#: those that are known by checksums and by possible numbers, and text is last. Only the readers that are asked are imported.
ORDER = {"mcap": -1, "ubx": 1, "nmea": 2, "kf_gins": 3, "sbet": 3, "tlog": 4, "csv": 5}
TEXT = "csv"  #: format of the reader that takes any text with digits
OF_ALL = ("rate", "even", "memory")  #: options that apply to the logs of every reader
#: bytes; a part of a larger file has the fingerprint of the file's ends
HASHED = 1 << 28


def reader_of(place: str | Place | RemoteLog) -> Reader:
    """Return the reader whose format the file's leading bytes show; of a folder, the reader of logs that are folders.

    Raises:
        UnreadableLogError: the file is missing, empty, or of no known format, or no reader knows the folder.
    """
    with source.accessed(place) as path:
        return _reader_of(path)


def _reader_of(path: Source) -> Reader:
    points = registry.installed(registry.READERS)
    names = sorted(points, key=lambda name: ORDER.get(name, 0))
    readers = (reader for name in names if (reader := cast("Reader | None", registry.load(points[name]))) is not None)
    if isinstance(path, Path) and path.is_dir():
        return _reader_of_folder(path, readers)
    source.check(path)
    head = source.head(path)
    for reader in readers:
        if reader.probe(head):
            if reader.format == TEXT and (told := unread_text(head)) is not None:
                raise UnreadableLogError(f"{path}: {told}")
            return reader
    if not head:
        raise UnreadableLogError(
            f"{path}: a packed file whose first bytes cannot be unpacked; it is cut or damaged: copy it again"
        )
    if (told := unread_binary(head)) is not None:
        raise UnreadableLogError(f"{path}: {told}")
    raise UnreadableLogError(
        f"{path}: no known log format begins with {head[:8]!r}; the known formats are {', '.join(points)}"
    )


def _reader_of_folder(folder: Path, readers: Iterable[Reader]) -> Reader:
    for reader in readers:
        known = getattr(reader, "probe_folder", None)
        if known is not None and known(folder):
            return reader
    raise UnreadableLogError(
        f"{folder}: this is a directory, and no log that consists of several files; name a file in it"
    )


def stream(place: str | Place | RemoteLog, options: ReadOptions | None = None) -> Iterator[Batch | Remark]:
    """Yield a log piece by piece in the file's order; memory is bounded by the size of a piece.

    Raises:
        UnreadableLogError: the file cannot be read.
        UsageError: the file needs an option, such as its rate or its units.
    """
    with ExitStack() as closing:
        path = closing.enter_context(source.accessed(place))
        return _closed_after(_parts(_reader_of(path), path, options or ReadOptions()), closing.pop_all())


def _closed_after(parts: Iterator[Batch | Remark], closing: ExitStack) -> Iterator[Batch | Remark]:
    with closing:
        yield from parts


def _parts(
    reader: Reader, path: Source, options: ReadOptions, progress: Progress | None = None, limits: Limits | None = None
) -> Iterator[Batch | Remark]:
    uses = getattr(reader, "uses", [f.name for f in fields(ReadOptions)])
    if options.time_source not in TIME_SOURCES and "columns" not in uses:
        raise UsageError(
            f"time_source is {options.time_source!r}; for a {reader.format} log it must be {' or '.join(TIME_SOURCES)}"
        )
    unused = options.unused((*uses, *OF_ALL))
    if unused:
        names = ", ".join(f"--{name.replace('_', '-')}" for name in unused)
        yield Remark(Note("options_unused", f"{names} not used: a {reader.format} log states this itself"))
    size = source.size(path)
    sought = getattr(reader, "part", None) if limits is not None else None
    with source.named(path):
        file = _readable(reader, path, progress)
        rows = partial(reader.stream, file, options) if sought is None else partial(sought, file, options, limits)
        for part in budget.within(_budget(path, options), rows):
            if progress is not None and isinstance(part, Batch):
                progress(part.bytes_read, size)
            yield shown(part)
    if isinstance(path, RemoteLog):
        yield from map(Remark, path.notes)


def _budget(path: Source, options: ReadOptions) -> Budget:
    """Return how much memory the reading of a log may take."""
    return Budget(str(path), source.size(path), options.memory)


def _readable(reader: Reader, path: Source, progress: Progress | None = None) -> Path:
    """Return what a reader reads: the log, or a copy on disk of a remote log whose reader needs a file."""
    if isinstance(path, RemoteLog) and not (path.ranged and getattr(reader, "ranged", False)):
        beside = getattr(reader, "beside", None)
        return path.copied(beside(path.name) if beside is not None else (), progress)
    return cast("Path", path)  # a reader of ranges knows remote logs


def read(
    place: str | Place | RemoteLog,
    options: ReadOptions | None = None,
    progress: Progress | None = None,
    part: Part | None = None,
) -> Log:
    """Return the whole log, or a part of it.

    The streams of a part are those that ``select`` returns of the whole log, but memory follows the part, and so does time where the
    file has an index or can be searched by time.

    Args:
        place: a file of any known format, or its address; its leading bytes decide which format.
        options: what the file does not state itself, such as rate, columns, and units.
        progress: called from time to time with (bytes read, bytes of the file).
        part: the part between two times, or of one IMU; None: the whole log.

    Raises:
        UnreadableLogError: the file cannot be read, or contradicts its stated units.
        UsageError: the file needs an option, such as its rate or its units; or the part's times are none.
        MissingDataError: the log has no such part.
    """
    part = None if part == Part() else part
    with source.accessed(place) as path, ThreadPoolExecutor(1) as pool:
        reader = _reader_of(path)
        # To hash all of a large file takes longer than to find a part of it.
        hashed = source.fingerprint if part is None or source.size(path) <= HASHED else source.ends_fingerprint
        # A file is hashed beside the reading; the bytes of a remote log come only once, so their hash is known after it.
        fingerprint = pool.submit(hashed, path) if isinstance(path, Path) else None
        options = options or ReadOptions()
        opened = partial(_parts, reader, path, options, progress)
        file = Provenance(_text(path), reader.format, "", source.size(path))
        made = partial(assemble, provenance=file, rate=options.rate, even=options.even, budget=_budget(path, options))
        log = made(opened()) if part is None else read_part(opened, made, part, counted=options.rate is not None)
        digest = fingerprint.result() if fingerprint is not None else source.fingerprint(path)
        return replace(log, provenance=replace(log.provenance, hash=digest or source.ends_fingerprint(path)))


def describe(place: str | Place | RemoteLog, options: ReadOptions | None = None) -> LogSummary:
    """Return a summary of a log, from the file's index where it has one, else by reading the log.

    An index states neither gaps nor repairs; a note of the summary says so. ``summarize(read(path))`` always reads.

    Raises:
        UnreadableLogError: the file cannot be read.
        UsageError: the file needs an option, such as its rate or its units.
    """
    with source.accessed(place) as path:
        summary = indexed(path, options)
        return summary if summary is not None else summarize(read(path, options))


def indexed(place: str | Place | RemoteLog, options: ReadOptions | None = None) -> LogSummary | None:
    """Return the summary that a log's index states; None for a log without an index. Errors as in ``describe``."""
    with source.accessed(place) as path:
        reader = _reader_of(path)
        from_index = getattr(reader, "describe", None)
        if from_index is None:
            return None
        options = options or ReadOptions()
        summary = partial(from_index, _readable(reader, path), options)
        stated = cast("LogSummary | None", budget.under(_budget(path, options), summary))
        return None if stated is None else shown_summary(stated)


def _text(path: Source) -> str:
    """Return a path as text that documents can hold: bytes of a name that are no UTF-8 are replaced."""
    return os.fsencode(str(path)).decode("utf-8", "replace")
