"""A fault of a stream, or a remark on it."""

from dataclasses import dataclass
from typing import Literal

Severity = Literal["note", "warning", "fault"]
RANK: dict[Severity, int] = {"note": 0, "warning": 1, "fault": 2}


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
