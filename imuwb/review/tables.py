"""Tables that every review has."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import TYPE_CHECKING

from imuwb.analysis import Table
from imuwb.log import SECOND

if TYPE_CHECKING:
    from collections.abc import Sequence

    from imuwb.summary import LogSummary, StreamSummary

HEADINGS = (
    "stream", "kind", "rows", "rate", "duration", "start", "gaps", "units in file", "frame in file", "repairs",
)  # fmt: skip


def streams_table(summary: LogSummary) -> Table:
    """Return a table of a log's streams: counts, rates, times, gaps and repairs."""
    rows = tuple(_row(stream) for stream in summary.streams)
    caption = f"{summary.path} ({summary.format}{', ' if summary.hash else ''}{summary.hash[:19]}{'…' if summary.hash else ''})"
    return Table("Streams", HEADINGS, rows, caption)


def streams_of_many(summaries: Sequence[LogSummary]) -> Table:
    """Return one table of the streams of many logs."""
    rows = tuple((summary.path, *_row(stream)) for summary in summaries for stream in summary.streams)
    return Table(f"Streams of {len(summaries)} logs", ("log", *HEADINGS), rows, wide=True)


def _row(stream: StreamSummary) -> tuple[str, ...]:
    start = f"{stream.start_ns / SECOND:.3f} s on the {stream.epoch} clock"
    if stream.epoch == "unix":
        start = datetime.fromtimestamp(stream.start_ns / SECOND, UTC).strftime("%Y-%m-%d %H:%M:%S UTC")
    longest = max((length for _, length in stream.gaps), default=0.0)
    return (
        stream.name,
        stream.kind,
        f"{stream.count:,}".replace(",", " "),
        "—" if stream.rate_hz is None else f"{stream.rate_hz:.4g} Hz",
        duration_text((stream.end_ns - stream.start_ns) / SECOND),
        start,
        f"{len(stream.gaps)}, longest {longest:.3g} s" if stream.gaps else "none",
        stream.units,
        stream.frame or "—",
        "; ".join(f"{repair.what} ({repair.count})" for repair in stream.repairs) or "none",
    )


def duration_text(seconds: float) -> str:
    """Return a duration as a person says it."""
    if seconds < 600:  # noqa: PLR2004 - ten minutes
        return f"{seconds:.4g} s"
    hours, minutes = divmod(round(seconds / 60), 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min"
