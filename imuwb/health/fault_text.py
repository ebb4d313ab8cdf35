"""Faults in sentences: those of one kind together, the worst of them named."""

from collections.abc import Iterator, Sequence

from imuwb.health.fault import Fault
from imuwb.names import listed
from imuwb.texts import number_text

SIGNS = {"fault": "!!", "warning": "!", "note": ""}  #: before a sentence
NAMES = 60  #: columns of the names of streams


def fault_texts(faults: Sequence[Fault], most: int) -> Iterator[str]:
    """Yield the faults as sentences, in their order; those of one kind share a sentence. The last sentence counts the others."""
    groups: dict[tuple[str, str], list[Fault]] = {}
    for fault in faults:
        groups.setdefault((fault.severity, fault.kind), []).append(fault)
    for own in list(groups.values())[:most]:
        yield fault_text(own)
    if (more := len(groups) - most) > 0:
        yield f"{more} more kinds of faults: --full shows all."


def fault_text(own: Sequence[Fault]) -> str:
    """Return faults of one kind as a sentence: streams, the worst, when, how often, what follows."""
    worst = max(own, key=lambda fault: fault.count)
    few = own[0].stream if len(own) == 1 else listed((fault.stream for fault in own), NAMES)
    alone = len({fault.what for fault in own}) == 1
    often = f", {worst.count} times" if worst.count > 1 else ""
    where = "" if worst.start is None else f" at {number_text(worst.start)} s"
    which = "" if alone else f" ({worst.stream})"
    why = f": {worst.consequence}" if worst.consequence else ""
    return f"{SIGNS[worst.severity]} {few}: {worst.what}{which}{where}{often}{why}.".lstrip()
