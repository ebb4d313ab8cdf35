"""What the index or the head of a log shows before it is read: its format, and, where there is an index, streams and duration."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from imuwb.errors import ImuwbError
from imuwb.fleet.listing import Listed
from imuwb.readers.bytes import source
from imuwb.readers.bytes.address import is_address, without_secrets
from imuwb.readers.reading import indexed, reader_of
from imuwb.texts import printable
from imuwb.units import SECOND

AT_A_TIME = 16  #: logs of a store whose heads are asked for


@dataclass(frozen=True, slots=True)
class Triage:
    """What is known of a log without reading it."""

    log: Listed
    format: str = ""  #: empty: not known
    topics: tuple[str, ...] = ()  #: of the IMUs; empty: not known without reading
    rate: float | None = None  #: Hz, of the first IMU
    duration: float | None = None  #: s
    fault: str = ""  #: why it is no log


def triaged(logs: Sequence[Listed]) -> Iterator[Triage]:
    """Yield what is known of each log, in their order."""
    if not any(is_address(log.place) for log in logs):
        yield from map(_triage, logs)
        return
    with ThreadPoolExecutor(AT_A_TIME) as pool:
        yield from pool.map(_triage, logs)


def _triage(log: Listed) -> Triage:
    try:
        with source.accessed(log.place) as path:
            name = reader_of(path).format
            summary = indexed(path)
    except (ImuwbError, OSError) as error:
        return Triage(log, fault=printable(without_secrets(str(error))))
    imus = [] if summary is None else [stream for stream in summary.streams if stream.kind == "imu"]
    if not imus:
        return Triage(log, name)
    first = imus[0]
    return Triage(
        log, name, tuple(printable(s.name) for s in imus), first.rate_hz, (first.end_ns - first.start_ns) / SECOND
    )
