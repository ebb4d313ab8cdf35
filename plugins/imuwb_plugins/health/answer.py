"""The answer of the health analysis: what is wrong, the worst first, and which streams can be used."""

from collections.abc import Iterator, Sequence

from imuwb.analysis import Answer, Step
from imuwb.health import Health, StreamHealth, fault_texts
from imuwb.names import listed
from imuwb.texts import duration_text, number_text

STREAMS, FAULTS = 5, 5  #: rows, and sentences
NAME = 44  #: columns of the names in a row
WORST_FIRST = ("not usable as it is", "usable, with warnings", "too short to judge", "good")
STILL, MOVING = 60.0, 120.0  #: s; shortest record at rest that shows N, and shortest drive that can be replayed
NOISE = Step("imuwb noise {log}", "how noisy it is at rest")
OUTAGE = Step("imuwb outage {log} --error-model MODEL.toml", "how far it drifts without GNSS")
GNSS = Step("imuwb outage IMU.mcap --gnss {log} --error-model MODEL.toml", "with the log of an IMU")
CONTENT = Step("imuwb info {log} --full", "its streams: no IMU can be used as it is")
SPECTRUM = Step("imuwb psd {log}", "how it vibrates; too short for noise at rest")


def answer(result: Health) -> Answer:
    """Return the worst faults, and the verdict of each stream; streams that are alike share a row."""
    rows = list(_rows(result.streams))
    if (more := len(rows) - STREAMS) > 0:
        rows = [*rows[:STREAMS], (f"{more} more: --full", "", "")]
    serious = [fault for fault in result.faults if fault.severity != "note"]
    notes = [fault for fault in result.faults if fault.severity == "note" and fault.start is not None]
    even = f"For {duration_text(result.even)} it moves evenly, which only a receiver or an odometer shows."
    sentences = [
        *(fault_texts(serious, FAULTS) if serious else ["Nothing is wrong with it."]),
        *fault_texts(notes, 1),
        *([even] if result.even else []),
    ]
    return Answer(_about(result), ("stream", "rate", "verdict"), tuple(rows), tuple(sentences), (_step(result),))


def _rows(streams: Sequence[StreamHealth]) -> Iterator[tuple[str, str, str]]:
    """Yield a row for the streams of one verdict and nearly one rate, the worst verdict first."""
    groups: dict[tuple[str, str], list[StreamHealth]] = {}
    for stream in sorted(streams, key=lambda stream: WORST_FIRST.index(stream.verdict)):
        rate = f"{stream.usual_rate:.1e}" if stream.usual_rate else ""
        groups.setdefault((stream.verdict, rate), []).append(stream)
    for (verdict, _), own in groups.items():
        sensors = dict.fromkeys(s.name.removesuffix(" gyros").removesuffix(" accelerometers") for s in own)
        bodies = [name for name in sensors if name.removesuffix(" thermometer") not in sensors or "thermo" not in name]
        usual = own[0].usual_rate
        yield listed(bodies, NAME), f"{number_text(usual)} Hz" if usual else "in batches", verdict


def _step(result: Health) -> Step:
    if result.segments_of is None:
        return GNSS
    verdicts = {stream.verdict for stream in result.streams if stream.name.startswith(result.segments_of)}
    if verdicts == {WORST_FIRST[0]}:
        return CONTENT
    if max(float(stream.time.max(initial=0.0)) for stream in result.streams) < STILL:
        return SPECTRUM
    if not result.segments or result.still >= max(STILL, result.moving):
        return NOISE
    return OUTAGE if result.moving >= MOVING else SPECTRUM


def _about(result: Health) -> str:
    counts = {word: sum(fault.severity == word for fault in result.faults) for word in ("fault", "warning")}
    parts = [f"{n} {word}{'s' * (n != 1)}" for word, n in counts.items() if n]
    motion = (("still", result.still), ("moving", result.moving))
    known = [f"{word} {duration_text(seconds)}" for word, seconds in motion if seconds]
    return ", ".join((" and ".join(parts) or "no fault", *known))
