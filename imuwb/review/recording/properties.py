"""The name and the properties of a recording: what was analysed, the verdict, and the figures of the answer as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, cast

from imuwb.analysis import Answer, Finding
from imuwb.log import Log
from imuwb.texts import printable
from imuwb.units import coefficient_units

if TYPE_CHECKING:  # it imports rerun, which is slow
    from imuwb.review.recording.recorded import Value

DIGITS = 6  #: significant digits of a number: a catalog shows all that there are


def recording_name(analysis: str, logs: Sequence[Log], answer: Answer) -> str:
    """Return the name of a recording: noise · static.mcap · gyro x N 2.40 [2.38, 2.43] deg/√h."""
    more = f" and {len(logs) - 1} more" if len(logs) > 1 else ""
    parts = (analysis, f"{_file(logs[0])}{more}" if logs else "", " ".join(_cells(answer)[:2]))
    return printable(" · ".join(part for part in parts if part))


def properties(
    analysis: str, version: str, level: object, logs: Sequence[Log], answer: Answer, findings: Sequence[Finding]
) -> dict[str, Value]:
    """Return the properties of a recording; the figures of the answer are the last, each with its unit in its name.

    Args:
        analysis: name of the analysis, with its method.
        version: of imuwb.
        level: probability of the intervals; None: the analysis has no such parameter.
        logs: that were analysed.
        answer: of the analysis; its first sentence is the verdict.
        findings: of the analysis; they take the place of ``answer.numbers`` if there are none.
    """
    stated: dict[str, object] = {
        "analysis": analysis,
        "imuwb": version,
        "log": [_file(log) for log in logs],
        "hash": [log.provenance.hash for log in logs],
        "sensor": list(dict.fromkeys(log.imus[0].name for log in logs if log.imus)),
        "about": answer.about,
        "verdict": answer.sentences[0] if answer.sentences else "",
        "headline": ", ".join(_cells(answer)).replace(",", ":", 1),
        "level": level,
    }
    known = {name: _printable(value) for name, value in stated.items() if value not in (None, "", [])}
    return known | dict(_of_answer(answer) if answer.numbers else _of_findings(findings))


def _cells(answer: Answer) -> tuple[str, ...]:
    """Return the first row of an answer: its name, then each cell with its heading and, where a row states units, its unit."""
    if not answer.rows:
        return ()
    first, *cells = answer.rows[0]
    units = next((row for row in answer.rows if row and not row[0]), ())
    padded = (*units[1:], *[""] * len(cells))
    return (first, *(_cell(*parts) for parts in zip(answer.headings[1:], cells, padded, strict=False)))


def _cell(heading: str, cell: str, unit: str) -> str:
    """Return a cell with its heading; its unit is after a number, and after the heading if the cell ends in words."""
    parts = (heading, f"[{unit}]" if unit else "", cell) if cell[-1:].isalpha() else (heading, cell, unit)
    return " ".join(part for part in parts if part)


def _of_answer(answer: Answer) -> Iterator[tuple[str, Value]]:
    for name, estimate in answer.numbers.items():
        yield from _number(name, estimate.unit, estimate.value, estimate.lower, estimate.upper)


def _of_findings(findings: Sequence[Finding]) -> Iterator[tuple[str, Value]]:
    """Yield the coefficients of the headline; of an analysis without a headline, those of the first estimator of each axis."""
    estimated = [finding for finding in findings if finding.coefficients]
    chosen = [finding for finding in estimated if finding.headline] or estimated
    for finding in reversed({finding.axis: finding for finding in reversed(chosen)}.values()):
        for letter, own in finding.coefficients.items():
            unit = coefficient_units(finding.axis, letter)[1]
            ends = (math.nan if end is None else unit.from_si(end) for end in (own.value, own.lower, own.upper))
            yield from _number(f"{finding.axis.replace('_', ' ')} {letter}", unit.name, *ends)


def _number(name: str, unit: str, value: float, lower: float, upper: float) -> Iterator[tuple[str, Value]]:
    """Yield a value and its interval, or the limit of what the data do not show; each is a property with its unit in its name."""
    in_unit = f" [{unit}]" if unit else ""
    shown = not (lower == 0 and math.isfinite(upper))  # an interval from 0 is a limit, as in the panel
    if math.isfinite(value) and shown:
        yield f"{name}{in_unit}", _rounded(value)
        if math.isfinite(lower) and math.isfinite(upper):
            yield f"{name} interval{in_unit}", [_rounded(lower), _rounded(upper)]
    elif math.isfinite(upper):
        yield f"{name} limit{in_unit}", _rounded(upper)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _file(log: Log) -> str:
    return PurePath(log.provenance.path.replace("\\", "/")).name


def _printable(value: object) -> Value:
    """Return a number as it is, and texts as texts that can be shown."""
    if isinstance(value, list | tuple):
        return [printable(str(item)) for item in cast("Sequence[object]", value)]
    return value if isinstance(value, int | float) else printable(str(value))
