"""From a file to a Log. The leading bytes decide the format, never the suffix."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, cast

from imuwb import registry
from imuwb.errors import UnreadableLogError
from imuwb.joining import joined
from imuwb.log import Log, Provenance
from imuwb.readers.assembly.assemble import assemble
from imuwb.readers.batch import Batch, ReadOptions, Remark
from imuwb.readers.bytes import source
from imuwb.selection import select
from imuwb.summary import LogSummary, summarize

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from imuwb.readers.batch import Reader

__all__ = [
    "Batch",
    "LogSummary",
    "ReadOptions",
    "Remark",
    "describe",
    "joined",
    "read",
    "select",
    "stream",
    "summarize",
]


#: Formats that are not asked in the order of their names. Telemetry begins with no magic, and text is what is left when no
#: binary format is found; the format asked first is the only reader that its logs need to load.
ORDER = {"mcap": -1, "tlog": 1, "csv": 2}


def reader_of(path: str | Path) -> Reader:
    """Return the reader whose format the file's leading bytes show.

    Raises:
        UnreadableLogError: no such file, an empty one, a directory, or no known format.
    """
    path = Path(path)
    source.check(path)
    head = source.head(path)
    points = registry.installed(registry.READERS)
    for name in sorted(points, key=lambda name: ORDER.get(name, 0)):
        reader = cast("Reader | None", registry.load(points[name]))
        if reader is not None and reader.probe(head):
            return reader
    if not head:
        message = f"{path}: a gzip file of which nothing unpacks; it is cut or damaged"
        raise UnreadableLogError(message)
    known = ", ".join(points)
    message = f"{path}: begins with {head[:8]!r}, which no known log format does (known: {known})"
    raise UnreadableLogError(message)


def stream(path: str | Path, options: ReadOptions | None = None) -> Iterator[Batch | Remark]:
    """Yield a log piece by piece, as it stands in the file, with memory bounded by a piece."""
    return _parts(reader_of(path), Path(path), options or ReadOptions())


def _parts(reader: Reader, path: Path, options: ReadOptions) -> Iterator[Batch | Remark]:
    unused = options.unused(getattr(reader, "uses", [f.name for f in fields(ReadOptions)]))
    if unused:
        named = ", ".join(f"--{name.replace('_', '-')}" for name in unused)
        yield Remark(f"not used: {named}: a {reader.format} log states its own")
    yield from reader.stream(path, options)


def read(
    path: str | Path,
    options: ReadOptions | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Log:
    """Return the whole log.

    Args:
        path: a file of any known format; the leading bytes decide which.
        options: what the file does not say itself (rate, columns, units, which time stamp).
        progress: called with (bytes read, bytes in the file) now and then.

    Raises:
        UnreadableLogError: the file cannot be read, or contradicts the units said of it.
        UsageError: something must be said of the file first (its rate, its units).
    """
    path = Path(path)
    reader = reader_of(path)
    size = path.stat().st_size
    with ThreadPoolExecutor(1) as pool:
        hashed = pool.submit(source.fingerprint, path)
        parts = _reporting(_parts(reader, path, options or ReadOptions()), size, progress)
        provenance = Provenance(str(path), reader.format, "", size)
        log = assemble(parts, provenance)
        return Log(
            Provenance(str(path), reader.format, hashed.result(), size),
            log.imus, log.gnss, log.speeds, log.references, log.notes, log.zero,
        )  # fmt: skip


def describe(path: str | Path, options: ReadOptions | None = None) -> LogSummary:
    """Return what a log holds, as cheaply as its format allows.

    From an index where the file has one (then without gaps and repairs, and a note says so); else the log
    is read. ``summarize(read(path))`` always reads.
    """
    cheap = getattr(reader_of(path), "describe", None)
    found = cast("LogSummary | None", cheap(Path(path))) if cheap is not None else None
    return found if found is not None else summarize(read(path, options))


def _reporting(
    parts: Iterator[Batch | Remark], size: int, progress: Callable[[int, int], None] | None
) -> Iterator[Batch | Remark]:
    for part in parts:
        if progress is not None and isinstance(part, Batch):
            progress(part.bytes_read, size)
        yield part
