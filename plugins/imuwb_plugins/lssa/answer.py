"""The answer of the least-squares spectrum: which lines are surely there."""

from dataclasses import replace

from imuwb.analysis import Answer, Step
from imuwb.statistics import Estimate
from imuwb.texts import number_text
from imuwb.units import UNITS
from imuwb_plugins.lssa.result import LssaAxis, PeakResult, Result
from imuwb_plugins.lssa.show import figure

_UNITS = {"gyro": UNITS["deg/s"], "accel": UNITS["mg"]}
MOST = 7  #: rows
SAME = 0.01  #: relative difference of frequencies that count as one
NOISE = Step("imuwb noise {log}", "takes these lines off by itself")


def answer(result: Result) -> Answer:
    """Return the lines that are claimed, the strongest of each axis first."""
    rows: list[tuple[str, ...]] = []
    silent: list[str] = []
    for axis, r in result.axes.items():
        lines = [line for line in r.peaks if line.claimed]
        if not lines:
            silent.append(axis.replace("_", " "))
        rows += [_row(axis, line, len(lines) - 1) for line in lines[:1]]
    doubted = [
        (axis, line)
        for axis, r in result.axes.items()
        for line in r.peaks
        if line.significant and not line.in_both_halves
    ]
    sentences = [
        f"Sure: in both halves of the record, and by chance in less than {100 * (1 - result.level):g} of 100 records."
    ]
    if silent:
        sentences.append(f"No line on {', '.join(silent)}.")
    if doubted:
        axis, line = doubted[0]
        text = f"{axis.replace('_', ' ')} has a peak at {_frequency(line)} in one half only: it is no line of the whole record."
        sentences.append(text)
    if (common := _common(result)) is not None:
        sentences.append(f"{common} shows on several axes: most likely the place moves, not the sensor.")
    strongest = _strongest(result)
    return Answer(
        _about(result), ("", "line", "amplitude", "", "and"), tuple(rows[:MOST]), tuple(sentences if rows else sentences[1:]), (NOISE,),
        f"{100 * result.confidence:g} % intervals", None if strongest is None else figure(strongest, result), _numbers(result),
    )  # fmt: skip


def _strongest(result: Result) -> str | None:
    """Return the axis whose first line has the largest share of the residual; None: there is no line."""
    first = {axis: lines[0].percent for axis, r in result.axes.items() if (lines := _claimed(r))}
    return max(first, key=first.__getitem__, default=None)


def _numbers(result: Result) -> dict[str, Estimate]:
    """Return frequency and amplitude of the first line of each axis."""
    numbers: dict[str, Estimate] = {}
    for axis, r in result.axes.items():
        for line in _claimed(r)[:1]:
            name, unit = axis.replace("_", " "), _UNITS[axis.partition("_")[0]]
            numbers[f"{name} line"] = replace(line.frequency, unit="Hz")
            numbers[f"{name} amplitude"] = line.amplitude.scaled(1 / unit.factor, unit.name)
    return numbers


def _about(result: Result) -> str:
    known = [r for r in result.axes.values() if r.why_none is None]
    if not known:
        return next(r.why_none or "" for r in result.axes.values())
    return f"lines from {number_text(known[0].lowest)} to {number_text(known[0].searched)} Hz"


def _row(axis: str, line: PeakResult, others: int) -> tuple[str, ...]:
    unit = _UNITS[axis.partition("_")[0]]
    a = line.amplitude.scaled(1 / unit.factor, unit.name)
    amplitude = f"{number_text(a.value)} {unit.name} [{number_text(a.lower)}, {number_text(a.upper)}]"
    steady = "sure" if line.steady else "sure, drifts"
    more = f"{others} more line{'s' if others > 1 else ''}" if others else ""
    return axis.replace("_", " "), _frequency(line), amplitude, steady, more


def _frequency(line: PeakResult) -> str:
    return f"{line.frequency.value:.4g} Hz"


def _common(result: Result) -> str | None:
    """Return a frequency that shows on three axes or more."""
    first = [line for r in result.axes.values() for line in _claimed(r)[:1]]
    for line in first:
        near = [x for x in first if abs(x.frequency.value / line.frequency.value - 1) < SAME]
        if len(near) >= 3:  # noqa: PLR2004 - a place moves about three axes
            return _frequency(line)
    return None


def _claimed(r: LssaAxis) -> list[PeakResult]:
    return [line for line in r.peaks if line.claimed]
