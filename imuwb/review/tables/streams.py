"""Tables of a log's streams."""

from collections.abc import Sequence
from datetime import UTC, datetime

from imuwb.analysis import Table
from imuwb.log import SECOND
from imuwb.names import distinct
from imuwb.summary import LogSummary, StreamSummary
from imuwb.texts import counted, seconds_text

HEADINGS = (
    "stream", "kind", "rows", "rate", "duration", "start", "gaps", "units in file", "frame in file", "repairs",
)  # fmt: skip
PATH = 40  #: columns of the path of a log among several
HASH_LETTERS = 19  #: number of letters of "sha256:40323baac812..." that are shown


def streams_table(summary: LogSummary) -> Table:
    """Return a table of a log's streams: counts, rates, times, gaps and repairs."""
    rows = tuple(row_of(stream) for stream in summary.streams)
    hash_text = f", {summary.hash[:HASH_LETTERS]}…" if summary.hash else ""
    return Table("Streams", HEADINGS, rows, f"{summary.path} ({summary.format}{hash_text})")


def truth_table(summary: LogSummary) -> Table:
    """Return a table of the parameters that a simulator put into a log."""
    return Table("True parameters of the simulation", ("parameter", "value"), tuple(summary.truth.items()))


def streams_of_many(summaries: Sequence[LogSummary]) -> Table:
    """Return one table of the streams of many logs."""
    paths = distinct([summary.path for summary in summaries], PATH)
    rows = tuple(
        (path, *row_of(stream)) for path, summary in zip(paths, summaries, strict=True) for stream in summary.streams
    )
    return Table(f"Streams of {counted(len(summaries), 'log')}", ("log", *HEADINGS), rows, wide=True)


def row_of(stream: StreamSummary) -> tuple[str, ...]:
    """Return the cells of a stream, under ``HEADINGS``."""
    start = f"{stream.start_ns / SECOND:.3f} s on the {stream.epoch} clock"
    if stream.epoch == "unix":
        start = datetime.fromtimestamp(stream.start_ns / SECOND, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    longest = max((length for _, length in stream.gaps), default=0.0)
    return (
        stream.name,
        stream.kind,
        f"{stream.count:,}".replace(",", " "),
        "—" if stream.rate_hz is None else f"{stream.rate_hz:.4g} Hz",
        seconds_text((stream.end_ns - stream.start_ns) / SECOND),
        start,
        f"{len(stream.gaps)}, longest {longest:.3g} s" if stream.gaps else "none",
        stream.units,
        stream.frame or "—",
        "; ".join(f"{repair.what} ({repair.count})" for repair in stream.repairs) or "none",
    )
