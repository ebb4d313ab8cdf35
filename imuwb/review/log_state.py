"""What a reader of any answer must know of the logs: where a file ends early, and the worst fault of its streams."""

from collections.abc import Sequence

from imuwb.health import check
from imuwb.log import Log
from imuwb.notes import Note

#: ids of the notes of readers on a file that is not whole
NOT_WHOLE = ("cut", "packed_cut", "packed_damaged", "damaged", "checksum_failed", "interrupted")


def log_state(logs: Sequence[Log]) -> tuple[str, ...]:
    """Return at most two sentences: a file that is not whole, and the worst of the faults."""
    broken = [note for log in logs for note in log.notes if isinstance(note, Note) and note.id in NOT_WHOLE]
    sentences = [f"The file: {broken[0]}."] if broken else []
    faults = [fault for log in logs for fault in check(log, samples=False).faults if fault.severity == "fault"]
    if faults:
        worst, count = faults[0], len(faults)
        some = "a fault" if count == 1 else f"{count} faults; the worst"
        sentences.append(f"The log has {some}: {worst.stream}: {worst.what}.")
    return tuple(sentences)
