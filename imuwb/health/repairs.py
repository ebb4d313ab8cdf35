"""The repairs by the reader as faults, with their consequences."""

from collections.abc import Iterable, Iterator

from imuwb.health.fault import Fault, Severity
from imuwb.log import Effect, Repair

MUCH = 0.01  #: share of a stream; if more of it was repaired, the severity is higher
#: effect -> severity of few repairs, severity of many, consequence
_MEANING: dict[Effect, tuple[Severity, Severity, str]] = {
    "lost": ("warning", "fault", "the rows that were left out are missing: results span the gaps"),
    "time": ("warning", "warning", "these times are not the sensor's own: do not trust intervals, rates and delays near one step"),
    "order": ("note", "warning", "nothing is lost; a program that reads the file row by row must sort the rows too"),
    "value": ("warning", "fault", "the sensor did not measure these values"),
}  # fmt: skip


def repair_faults(name: str, repairs: Iterable[Repair], rows: int) -> Iterator[Fault]:
    """Yield a fault for each repair of a stream with ``rows`` rows."""
    for repair in repairs:
        few, many, consequence = _MEANING[repair.effect]
        severity = many if repair.count > MUCH * rows else few
        yield Fault(name, "repair", repair.what, severity, repair.count, consequence=consequence)
