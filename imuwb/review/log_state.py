"""What a reader of any answer must know of the logs: which IMU it is of, where a file ends early, and the worst fault."""

from collections.abc import Sequence

from imuwb.health import check
from imuwb.log import Log
from imuwb.notes import Note

#: ids of the notes of readers on a file that is not whole
NOT_WHOLE = ("cut", "packed_cut", "packed_damaged", "damaged", "checksum_failed", "interrupted")


def log_state(logs: Sequence[Log]) -> tuple[str, ...]:
    """Return at most three sentences: which of several IMUs is analysed, a file that is not whole, and the worst of the faults."""
    chosen = [note for log in logs for note in log.notes if isinstance(note, Note) and note.id == "imus"]
    broken = [note for log in logs for note in log.notes if isinstance(note, Note) and note.id in NOT_WHOLE]
    sentences = [f"{chosen[0]}."] if chosen else []
    sentences += [f"The file: {broken[0]}."] if broken else []
    faults = [fault for log in logs for fault in check(log, samples=False).faults if fault.severity == "fault"]
    if faults:
        worst, count = faults[0], len(faults)
        some = "a fault" if count == 1 else f"{count} faults; the worst"
        sentences.append(f"The log has {some}: {worst.stream}: {worst.what}.")
    return tuple(sentences)
