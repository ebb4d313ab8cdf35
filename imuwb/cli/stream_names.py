"""The names of a log's streams for a shell, which waits for them: from the index, or from the begin of the log."""

from collections.abc import Iterator
from pathlib import Path

from imuwb.log import Log

LARGEST = 64 << 20  #: bytes of a log without an index; a shell waits for the answer
HEAD = "10"  #: s of a log without an index that are read


def stream_names(path: Path, kind: str) -> list[str]:
    """Return the names of the streams of a kind ("imu", "gnss", "reference"); none of a large log without an index.

    Raises:
        ImuwbError: the log cannot be read without options.
    """
    from imuwb import selection  # noqa: PLC0415 - MCAP has an index, which needs less
    from imuwb.readers import ReadOptions, read  # noqa: PLC0415
    from imuwb.readers.reading import indexed  # noqa: PLC0415

    summary = indexed(path, ReadOptions())
    if summary is not None:
        return list(dict.fromkeys(stream.name for stream in summary.streams if stream.kind == kind))
    if path.stat().st_size > LARGEST:
        return []
    return list(dict.fromkeys(_of_kind(read(path, ReadOptions(), part=selection.Part(None, "0", HEAD)), kind)))


def _of_kind(log: Log, kind: str) -> Iterator[str]:
    streams = {"imu": log.imus, "gnss": log.gnss, "reference": log.references}
    yield from (stream.name for stream in streams.get(kind, ()))
