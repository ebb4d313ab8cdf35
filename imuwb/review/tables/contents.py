"""What a log contains, for people: what can be used, and its streams in few rows and columns."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from imuwb.analysis import Table
from imuwb.log import SECOND, GnssStream, Kind, Log
from imuwb.review.tables.streams import HASH_LETTERS, HEADINGS, row_of
from imuwb.summary import LogSummary, StreamSummary
from imuwb.texts import names_text

#: kind of stream -> what people call it; other kinds alone are no log of motion
USABLE: dict[Kind, str] = {
    "imu": "IMU", "gnss": "receiver", "speed": "speed", "reference": "trajectory", "pose": "poses",
    "orientation": "orientation", "temperature": "thermometer",
}  # fmt: skip
ALONE: tuple[Kind, ...] = ("imu", "gnss", "speed", "reference", "pose")
TOGETHER = 60  #: s; streams that start within this time have one start


def can_be_used(summary: LogSummary) -> bool:
    """Return whether a log has a stream that a command can use; an orientation or a thermometer alone is none."""
    return any(stream.kind in ALONE for stream in summary.streams)


def usable_table(summary: LogSummary, log: Log | None) -> Table:
    """Return a table of what can be used, by kind.

    Args:
        summary: of the log.
        log: the log; None if only its index was read, which does not show what a receiver states.
    """
    states = {} if log is None else {gnss.name: _stated(gnss) for gnss in log.gnss}
    rows: list[tuple[str, str]] = []
    for kind, label in USABLE.items():
        streams = [stream for stream in summary.streams if stream.kind == kind]
        groups: dict[tuple[str, str], list[str]] = {}
        for stream in streams:
            rate = "one row" if stream.rate_hz is None else f"{stream.rate_hz:.4g} Hz"
            groups.setdefault((rate, states.get(stream.name, "")), []).append(stream.name)
        if groups:
            about = (f"{names_text(names)} ({rate}{told})" for (rate, told), names in groups.items())
            rows.append((label, "; ".join(about)))
    return Table("Can be used", ("what", "streams"), tuple(rows))


def _stated(gnss: GnssStream) -> str:
    """Return what a receiver states, and what it does not."""
    has = _states(gnss)
    known = ", ".join(("position", *(name for name, there in has.items() if there)))
    missing = ", ".join(f"no {name}" for name in not_stated(gnss))
    return f": {known}" + (f"; {missing}" if missing else "")


def not_stated(gnss: GnssStream) -> tuple[str, ...]:
    """Return what a receiver does not state: velocity, position sigmas, velocity sigmas."""
    return tuple(name for name, there in _states(gnss).items() if not there)


def _states(gnss: GnssStream) -> dict[str, bool]:
    values = {
        "velocity": gnss.velocity, "position sigmas": gnss.position_sigma, "velocity sigmas": gnss.velocity_sigma
    }  # fmt: skip
    has = {name: value is not None and bool(np.isfinite(value).any()) for name, value in values.items()}
    if not has["velocity"]:  # no sigma of a velocity is missed without one
        del has["velocity sigmas"]
    return has


def contents_table(summary: LogSummary) -> Table:
    """Return a table of a log's streams: those that are alike share a row, and columns without content are left out."""
    rows = [row_of(stream) for stream in _with_thermometers(summary.streams)]
    starts = [stream.start_ns for stream in summary.streams]
    together = not starts or max(starts) - min(starts) <= TOGETHER * SECOND
    start = HEADINGS.index("start")
    first = min(summary.streams, key=lambda stream: stream.start_ns, default=None)
    begins = "" if first is None or not together else f"; starts at {row_of(first)[start]}"
    kept = [
        i
        for i, heading in enumerate(HEADINGS)
        if not (i == start and together)
        and not (heading in ("gaps", "repairs") and all(row[i] == "none" for row in rows))
    ]
    hash_text = f", {summary.hash[:HASH_LETTERS]}…" if summary.hash else ""
    return Table(
        "Streams", tuple(HEADINGS[i] for i in kept), tuple(_merged([tuple(row[i] for i in kept) for row in rows])),
        f"{summary.path} ({summary.format}{hash_text}{begins})",
    )  # fmt: skip


def _with_thermometers(streams: Iterable[StreamSummary]) -> Iterator[StreamSummary]:
    """Yield streams; a thermometer with the name, the rows and the clock of the IMU before it is part of that IMU."""
    last: StreamSummary | None = None
    for stream in streams:
        if (
            last is not None
            and (last.kind, stream.kind, last.name) == ("imu", "temperature", stream.name)
            and (last.count, last.start_ns, last.end_ns) == (stream.count, stream.start_ns, stream.end_ns)
        ):
            last = replace(last, units=f"{last.units}, {stream.units}")
            continue
        if last is not None:
            yield last
        last = stream
    if last is not None:
        yield last


def _merged(rows: Sequence[tuple[str, ...]]) -> Iterator[tuple[str, ...]]:
    """Yield rows; those that differ in the name alone are one row with all names."""
    names: dict[tuple[str, ...], list[str]] = {}
    for name, *rest in rows:
        names.setdefault(tuple(rest), []).append(name)
    for rest, own in names.items():
        yield names_text(own), *rest
