"""The answer of ``imuwb info``: what a log can be used for, and what is wrong with it, the worst first."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from imuwb.analysis import Answer, Step
from imuwb.health import Fault, fault_texts
from imuwb.log import SECOND, Log
from imuwb.names import listed
from imuwb.notes import Note
from imuwb.review.answers.log_state import NOT_WHOLE
from imuwb.review.tables.contents import USABLE, not_stated
from imuwb.summary import LogSummary, StreamSummary
from imuwb.texts import duration_text, number_text

ROWS, FAULTS, NAME = 7, 4, 32  #: rows and faults of the answer; columns of the names in a row
SLOW = 5.0  #: Hz; vehicles and vibrations are faster than an IMU of this rate
BATCHES = 0.5  #: share of the time of a stream; where more is missing, it is recorded in batches
ORDINARY = ("unused", "utc_by_receiver", "utc_by_message")  #: ids of notes that most logs of their format have
NO_BREAK = "\N{NO-BREAK SPACE}"  #: between the digits of a large number
NOTHING = "—"  #: use of a stream that is of none


@dataclass(frozen=True, slots=True)
class Use:
    """What one stream can be used for."""

    use: str
    name: str
    rate: str
    rows: str
    remark: str


def log_answer(
    summary: LogSummary, log: Log | None, faults: Sequence[Fault] | None, steps: Sequence[Step] = ()
) -> Answer:
    """Return what a log can be used for, and what is wrong with it.

    Args:
        summary: of the log.
        log: the log; None if only its index was read.
        faults: of the log, the worst first; None: it was not examined.
        steps: what can be done next.
    """
    stated = {} if log is None else {gnss.name: not_stated(gnss) for gnss in log.gnss}
    uses = [_use(stream, stated.get(stream.name, ())) for stream in _whole(summary.streams)]
    rows = list(_rows(sorted(uses, key=lambda use: use.use == NOTHING)))
    if (more := len(rows) - ROWS) > 0:
        rows = [*rows[:ROWS], ("", f"{more} more: --full", "", "", "")]
    sentences = (*_broken(summary), *_faults(faults, summary), *_read_as(summary), *_others(summary))
    return Answer(
        _about(summary), ("use for", "stream", "rate", "rows", "remark"), tuple(rows), sentences, tuple(steps)
    )


def _about(summary: LogSummary) -> str:
    """Return format, length and start: ulog, 6.5 s from 2021-04-21 06:30:58 UTC."""
    if not summary.streams:
        return f"{summary.format}, nothing can be used"
    first = min(summary.streams, key=lambda stream: stream.start_ns)
    end = max(stream.end_ns for stream in summary.streams)
    start = ""
    if first.epoch == "unix":
        start = datetime.fromtimestamp(first.start_ns / SECOND, UTC).strftime(" from %Y-%m-%d %H:%M:%S UTC")
    return f"{summary.format}, {duration_text((end - first.start_ns) / SECOND)}{start}"


def _whole(streams: Iterable[StreamSummary]) -> Iterator[StreamSummary]:
    """Yield streams by kind, in the order of their weight; the thermometer of an IMU is no stream of its own."""
    streams = list(streams)
    imus = {stream.name.partition(" (")[0] for stream in streams if stream.kind == "imu"}
    for kind in USABLE:
        yield from (s for s in streams if s.kind == kind and not (kind == "temperature" and s.name in imus))


def _use(stream: StreamSummary, missing: Sequence[str]) -> Use:
    seconds = (stream.end_ns - stream.start_ns) / SECOND
    lost = sum(length for _, length in stream.gaps)
    rate = "one row" if stream.rate_hz is None else f"{number_text(stream.rate_hz)} Hz"
    use = {"imu": "noise, drift", "gnss": "fixes", "pose": "poses"}.get(stream.kind, USABLE[stream.kind])
    remark = f"no {', '.join(dict.fromkeys(word.split()[-1] for word in missing))}" if missing else ""
    name = stream.name
    if stream.kind == "imu":
        name, _, _ = name.partition(" (")  # a gyro and an accelerometer of two clocks
        if stream.rate_hz is None or stream.rate_hz < SLOW:
            use, remark = NOTHING, "too slow"
        elif lost > BATCHES * seconds:
            use, remark = "vibration", f"in batches, {100 * lost / seconds:.0f} % missing"
    if not remark and stream.gaps:
        longest = max(length for _, length in stream.gaps)
        remark = f"{len(stream.gaps)} gap{'s' * (len(stream.gaps) > 1)}, {longest:.2g} s"
    if stream.kind == "reference" and "," in stream.frame:
        remark = stream.frame.partition(", ")[2].removeprefix("estimated by ")
    return Use(use, name, rate, f"{stream.count:,}".replace(",", " "), remark)


def _rows(uses: Iterable[Use]) -> Iterator[tuple[str, ...]]:
    """Yield a row for the streams that are alike: of one use and nearly one rate."""
    groups: dict[tuple[str, ...], list[Use]] = {}
    for use in uses:
        about = re.sub(r"[\d.]+", "", use.remark)
        groups.setdefault((use.use, _rough(use.rate), about), []).append(use)
    for (what, _, _), own in groups.items():
        yield what, listed((use.name for use in own), NAME), own[0].rate, own[0].rows, own[0].remark


def _rough(rate: str) -> str:
    value, _, unit = rate.partition(" ")
    return f"{float(value.replace(NO_BREAK, '')):.1g} {unit}" if unit == "Hz" else rate


def _broken(summary: LogSummary) -> Iterator[str]:
    """Yield what the reader says of a file that is not whole, and of options that had no effect."""
    for note in summary.notes:
        if _is_said(note):
            yield f"! {note}." if note.startswith("--") else f"! The file: {note}."


def _is_said(note: str) -> bool:
    return note.startswith("--") or (isinstance(note, Note) and note.id in NOT_WHOLE)


def _faults(faults: Sequence[Fault] | None, summary: LogSummary) -> Iterator[str]:
    if faults is None:
        yield "Only its index was read: --scan reads every message, and looks for faults."
        return
    if not summary.streams:
        yield "No stream of it can be used, so none was examined for faults."
        return
    serious = [fault for fault in faults if fault.severity != "note"]
    found = list(fault_texts(serious, FAULTS))
    yield from found or ["No fault in its clocks and gaps; its samples were not examined."]


def _read_as(summary: LogSummary) -> Iterator[str]:
    """Yield the units, the frame and the clock of the IMU, which a reader can take wrongly."""
    imu = next((stream for stream in summary.streams if stream.kind == "imu"), None)
    if imu is not None:
        clock = {"unix": "UTC", "boot": "since power-up", "log": "its own"}[imu.epoch]
        yield f"Read as {imu.units}, {imu.frame or 'a frame of its own'}; its clock is {clock}."


def _others(summary: LogSummary) -> Iterator[str]:
    if summary.truth:
        yield "It is simulated: --full shows the true parameters."
    notes = [note for note in summary.notes if not _is_said(note)]
    if notes:
        first = min(notes, key=lambda note: ("--" not in note, isinstance(note, Note) and note.id in ORDINARY))
        count = f"{len(notes)} notes, all with --full; the first" if len(notes) > 1 else "Note"
        yield f"{count}: {first}."
