"""What a reader of any answer must know of the logs: which IMU it is of, where a file ends early, and the worst fault."""

from collections.abc import Sequence

from imuwb.health import check
from imuwb.log import Log
from imuwb.notes import Note

#: ids of the notes of readers on a file that is not whole
NOT_WHOLE = ("cut", "packed_cut", "packed_damaged", "damaged", "checksum_failed", "interrupted")


def log_state(logs: Sequence[Log], *, faults: bool = True) -> tuple[str, ...]:
    """Return what limits an answer, a sentence each: the IMU among several, a file that is not whole, the worst fault, conditioners.

    Args:
        logs: that were analysed, after the conditioners.
        faults: whether the faults of the logs are looked for.
    """
    chosen = [note for log in logs for note in log.notes if isinstance(note, Note) and note.id == "imus"]
    broken = [note for log in logs for note in log.notes if isinstance(note, Note) and note.id in NOT_WHOLE]
    sentences = [f"{chosen[0]}."] if chosen else []
    sentences += [f"The file: {broken[0]}."] if broken else []
    found = [f for log in logs if faults for f in check(log, samples=False).faults if f.severity == "fault"]
    if found:
        worst, count = found[0], len(found)
        some = "a fault" if count == 1 else f"{count} faults; the worst"
        sentences.append(f"The log has {some}: {worst.stream}: {worst.what}.")
    if logs and (steps := logs[0].conditioning):
        sentences.append(f"The samples went through {', then '.join(step.name for step in steps)}.")
    return tuple(sentences)
