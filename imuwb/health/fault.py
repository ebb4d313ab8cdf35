"""A fault of a stream, or a remark on it; the repairs by the reader are faults too."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

from imuwb.log import Effect, Repair

Severity = Literal["note", "warning", "fault"]
RANK: dict[Severity, int] = {"note": 0, "warning": 1, "fault": 2}
LOST = "lost rows"  #: the kind of a repair that left out so many rows that it is a fault
MUCH = 0.01  #: share of a stream; if more of it was repaired, or as much lost, the severity is higher
HARDLY = 1e-4  #: share of a stream; where fewer rows are lost, such as a last line that is cut, this is only a note
#: effect -> severity of few repairs, severity of many, consequence
_MEANING: dict[Effect, tuple[Severity, Severity, str]] = {
    "lost": ("warning", "fault", "the rows that were left out are missing: results span the gaps"),
    "time": ("warning", "warning", "these times are not the sensor's own: do not trust intervals, rates and delays near one step"),
    "order": ("note", "warning", "nothing is lost; a program that reads the file row by row must sort the rows too"),
    "value": ("warning", "fault", "the sensor did not measure these values"),
}  # fmt: skip
#: id of a reader's note -> severity and consequence of a repair that leaves the results right, or nearly
_HARMLESS: dict[str, tuple[Severity, str]] = {
    "arrival_stamps": ("warning", "rates and noise are right; how late the stamps are beside those of a receiver is not known"),
    "coarse_stamps": ("note", "rates and noise are right"),
    "uneven_stamps": ("note", "rates and noise are right"),
    "batches": ("warning", "if the samples are even, rates and noise are wrong"),
    "stated_rate": ("note", "rates and noise are as right as the stated rate"),
    "no_height": ("warning", "use these fixes north and east only"),
    "no_fix": ("note", "before its first fix, and where it loses the satellites, a receiver has no position"),
    "repeated_row": ("note", "nothing is lost"),
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class Fault:
    """What is wrong with a stream or an axis of an IMU."""

    stream: str
    kind: str  #: name for programs, such as "gaps"; the texts may change, the kind stays
    what: str
    severity: Severity
    count: int = 1
    #: s from the log's start, of the first or the longest fault of this kind; None: everywhere, or unknown
    start: float | None = None
    length: float | None = None  #: s; length of the longest fault of this kind
    consequence: str = ""

    def __str__(self) -> str:
        """Return the fault in one line."""
        place = "" if self.start is None else f" at {self.start:.2f} s"
        return f"{self.severity}: {self.stream}: {self.what}{place}"


def repair_faults(name: str, repairs: Iterable[Repair], rows: int) -> Iterator[Fault]:
    """Yield a fault for each repair of a stream with ``rows`` rows."""
    for repair in repairs:
        name_of_note = getattr(repair.what, "id", "")
        if name_of_note in _HARMLESS:
            harm, consequence = _HARMLESS[name_of_note]
            count = 1 if repair.effect == "time" else repair.count  # all times of a stream are one clock
            yield Fault(name, name_of_note.replace("_", " "), repair.what, harm, count, consequence=consequence)
            continue
        few, many, consequence = _MEANING[repair.effect]
        lost = repair.effect == "lost"
        whole = rows + repair.count if lost else rows
        much = repair.count > MUCH * whole or (lost and repair.count == MUCH * whole)
        share = f" ({100 * repair.count / whole:.2g} % of its rows)" if lost and much else ""
        kind = LOST if lost and much else "repair"
        severity: Severity = many if much else "note" if lost and repair.count < HARDLY * whole else few
        yield Fault(name, kind, f"{repair.what}{share}", severity, repair.count, consequence=consequence)
