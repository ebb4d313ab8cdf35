"""One word for each axis on whether to trust its coefficients, by a stated rule."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from imuwb.texts import number_text, quantity_text
from imuwb.units import UNITS
from imuwb_plugins.allan.notes import UNEXPLAINED
from imuwb_plugins.allan.result import AllanAxis, Result

YES = "yes"
_AMPLITUDES = {"gyro": UNITS["deg/s"], "accel": UNITS["mg"]}
SLIGHT = 0.2  #: relative change of the Allan deviation from part to part; a smaller one is not worth a sentence


@dataclass(frozen=True, slots=True)
class Trust:
    """Whether to trust the coefficients of an axis."""

    word: str  #: "yes", or why not
    sentence: str = ""  #: what the word means, and what to do; empty for "yes"


def trust(result: Result, axis: str) -> Trust:
    """Return the first of these that holds, else "yes".

    * "none": there is no fit.
    * "moved": the record as a whole is not one of a sensor at rest, or is spoilt (a grave doubt of ``imuwb.health``).
    * "changes": the Allan deviation of a part differs from that of the whole by more than chance, and by more than a fifth.
    * "unexplained": no sum of processes explains the Allan curve (chance makes such a misfit in less than 1 of 1000 records).
    * "shaken": periodic lines were found; the coefficients are without them.
    * "disputed": the intervals of the estimators do not overlap.
    """
    r = result.axes[axis]
    if r.why_no_fit is not None:
        return Trust("none", f"None: {r.why_no_fit}.")
    if result.doubts.grave:
        return Trust("moved", f"Moved: {_sentence(result.doubts.grave[0])}")
    return _of_axis(axis, r) or Trust(YES)


def meanings(trusts: Mapping[str, Trust]) -> Iterator[str]:
    """Yield what the words of trust mean, each word once; one sentence for a record without doubts."""
    said: dict[str, str] = {}
    for one in trusts.values():
        if one.word != YES:
            said.setdefault(one.word, one.sentence)
    yield from said.values()
    if not said:
        yield "Trust them: the record is still, its noise is steady, the estimators agree."


def _of_axis(axis: str, r: AllanAxis) -> Trust | None:
    s = r.estimates.stationarity if r.estimates else None
    if s is not None and not s.stationary and abs(s.worst_ratio - 1) > SLIGHT:
        where = f"{s.worst_ratio:.2g} times the usual Allan deviation from {s.start[s.worst_part]:.0f} s on"
        return Trust(
            "changes", f"Changes: {axis.replace('_', ' ')} has {where}; look for what changed, or leave that part out."
        )
    if r.fit is not None and r.fit.probability < UNEXPLAINED:
        text = "Unexplained: no sum of these noises has that curve; look at the figure before you use the numbers."
        return Trust("unexplained", text)
    if r.lines:
        line = max(r.lines, key=lambda line: line.amplitude.value)
        unit = _AMPLITUDES[axis.partition("_")[0]]
        size = quantity_text(unit.from_si(line.amplitude.value), unit.name)
        text = f"Shaken: a vibration at {number_text(line.frequency)} Hz, up to {size}; N, B and K are without it."
        return Trust("shaken", text)
    if r.estimates is not None and not r.estimates.agree:
        return Trust("disputed", "Disputed: the intervals of the estimators do not overlap; see --full.")
    return None


def _sentence(note: str) -> str:
    """Return a note as the end of a sentence."""
    return note if note.endswith(".") else f"{note}."
