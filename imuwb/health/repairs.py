"""What a reader mended, and what follows from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from imuwb.health.fault import Fault

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from imuwb.health.fault import Severity
    from imuwb.log import Effect, Repair

MUCH = 0.01  #: share of a stream that was mended, above which it is worse
#: effect -> severity of a little, severity of much, what follows
_MEANING: dict[Effect, tuple[Severity, Severity, str]] = {
    "lost": ("warning", "fault", "what was left out is missing: results span the holes"),
    "time": ("warning", "warning", "these times are not the sensor's own: intervals, rates and delays near one step are not to be trusted"),
    "order": ("note", "warning", "nothing is lost; whoever reads the file row by row must sort it too"),
    "value": ("warning", "fault", "these values are none of the sensor's"),
}  # fmt: skip


def repair_faults(name: str, repairs: Iterable[Repair], rows: int) -> Iterator[Fault]:
    """Yield what was mended of a stream of so many rows."""
    for repair in repairs:
        little, much, follows = _MEANING[repair.effect]
        severity = much if repair.count > MUCH * rows else little
        yield Fault(name, repair.what, severity, repair.count, consequence=follows)
