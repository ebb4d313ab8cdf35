"""The answer of the health analysis: which streams can be used, and what is wrong, the worst first."""

from imuwb.analysis import Answer, Step
from imuwb.health import Fault, Health
from imuwb.texts import duration_text, number_text, seconds_text

STREAMS, FAULTS = 5, 5  #: rows of each
SIGNS = {"fault": "!!", "warning": "!", "note": ""}
NOISE = Step("imuwb noise {log}", "how noisy it is at rest")
OUTAGE = Step("imuwb outage {log} --error-model MODEL.toml", "how far it drifts without GNSS")


def answer(result: Health) -> Answer:
    """Return the verdict of each stream and the worst faults."""
    rows = [("", s.name, _rate(s.usual_rate), s.verdict) for s in result.streams[:STREAMS]]
    if (more := len(result.streams) - STREAMS) > 0:
        rows.append(("", f"{more} more streams", "", ""))
    serious = [fault for fault in result.faults if fault.severity != "note"]
    sentences = [_sentence(fault) for fault in serious[:FAULTS]] or ["Nothing is wrong with it."]
    if (more := len(serious) - FAULTS) > 0:
        sentences.append(f"{more} more faults and warnings: --full shows all.")
    moves = result.segments_of is not None and result.moving > result.still
    return Answer(
        _about(result), ("", "stream", "rate", "verdict"), tuple(rows), tuple(sentences), (OUTAGE if moves else NOISE,)
    )


def _rate(usual: float) -> str:
    return f"{number_text(usual)} Hz" if usual else "in batches"


def _about(result: Health) -> str:
    faults = sum(fault.severity == "fault" for fault in result.faults)
    warnings = sum(fault.severity == "warning" for fault in result.faults)
    parts = [f"{n} {word}{'s' if n != 1 else ''}" for n, word in ((faults, "fault"), (warnings, "warning")) if n]
    motion = (
        f", still for {duration_text(result.still)}, moving for {duration_text(result.moving)}"
        if result.segments
        else ""
    )
    if result.even:
        motion += f" ({duration_text(result.even)} of it even motion)"
    return (" and ".join(parts) or "no fault") + motion


def _sentence(fault: Fault) -> str:
    where = "" if fault.start is None else f" at {seconds_text(fault.start)}"
    often = f", {fault.count} times" if fault.count > 1 else ""
    why = f": {fault.consequence}" if fault.consequence else ""
    return f"{SIGNS[fault.severity]} {fault.stream}: {fault.what}{where}{often}{why}."
