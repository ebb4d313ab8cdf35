"""Findings and families in words: sizes, dates, commands."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime

from imuwb.fleet.report.groups import Group
from imuwb.fleet.report.result import OUTSIDE, Finding, FleetReport, end_in_si, in_si
from imuwb.identification.family import Judged
from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import coefficient_cell, duration_text, estimate_text

DAY, WEEKS, MONTHS = 86400.0, 21.0, 90.0  #: s; days up to which times are in days and in weeks
SMALL = 0.0995  #: ratio less 1, below which a per cent has a decimal


@dataclass(frozen=True, slots=True)
class Row:
    """The findings of one kind of one sensor, in coefficients of one letter."""

    findings: tuple[Finding, ...]  #: the worst first

    @property
    def worst(self) -> Finding:
        """Return the worst of them."""
        return self.findings[0]


def rows_of(report: FleetReport) -> tuple[Row, ...]:
    """Return the findings by sensor, kind, and coefficient: those of several axes together; the worst first."""
    together: dict[tuple[str, ...], list[Finding]] = {}
    for one in report.findings:
        group = report.groups[one.group]
        key = (one.sensor, one.kind, group.type, group.source, group.axis.partition("_")[0], group.coefficient)
        together.setdefault(key, []).append(one)
    return tuple(Row(tuple(own)) for own in together.values())


def named(report: FleetReport, findings: Sequence[Finding]) -> str:
    """Return the coefficients of findings of one sensor: "gyro x, y, z N"."""
    groups = [report.groups[one.group] for one in findings]
    axes = sorted({group.axis for group in groups})
    if len(axes) < 2:  # noqa: PLR2004 - one has a name of its own
        return what(groups[0])
    return f"{axes[0].partition('_')[0]} {', '.join(axis.rpartition('_')[2] for axis in axes)} {groups[0].coefficient}"


def what(group: Group) -> str:
    """Return the name of what is compared; of outages with the filter."""
    return group.name if group.axis else f"{group.coefficient}, {group.source}"


def size_text(group: Group, size: Estimate) -> str:
    """Return how large a difference is: a ratio in per cent, or times above two; else in the unit."""
    if not group.observations.logarithmic:
        return estimate_text(size, group.display.name, group.display.factor)
    value, lower, upper = (end_in_si(group, x) for x in (size.value, size.lower, size.upper))
    if size.lower == -math.inf:
        return f"below {100 * value:.2g} % of the family's mean"
    if value >= 2:  # noqa: PLR2004 - from here on times are easier to read
        return f"{value:.3g} times [{lower:.3g}, {upper:.3g}]"
    digits = 1 if abs(value - 1) < SMALL else 0
    texts = [f"{100 * (x - 1):+.{digits}f}" for x in (value, lower, upper)]
    return f"{texts[0]} % [{texts[1]}, {texts[2]}]"


def when_text(report: FleetReport, finding: Finding) -> str:
    """Return over which time or at which date a change is; empty for a sensor outside."""
    times = [log.start for key in finding.logs if (log := report.logs.get(key)) is not None and log.start is not None]
    if finding.kind == OUTSIDE or not times:
        return ""
    first, last = min(times), max(times)
    if finding.kind == "drifts":
        return f"in {span_text((last - first) / 1e9)}"
    return f"after {date_text(first)}" if finding.kind == "steps" else f"on {date_text(first)}"


def span_text(seconds: float) -> str:
    """Return a long time as people say it: 12 days, 7 weeks, 4 months."""
    days = seconds / DAY
    if days < 2:  # noqa: PLR2004 - hours are more exact
        return duration_text(seconds)
    if days < WEEKS:
        return f"{days:.0f} days"
    return f"{days / 7:.0f} weeks" if days < MONTHS else f"{days / 30.44:.0f} months"


def date_text(time: int | None) -> str:
    """Return the date of a time, ns since 1970."""
    return "no date" if time is None else f"{datetime.fromtimestamp(time / 1e9, tz=UTC):%Y-%m-%d}"


def cell(group: Group, estimate: Estimate) -> str:
    """Return an estimate on the scale of a group in the unit that people read, with the unit."""
    if group.observations.logarithmic:
        return with_unit(coefficient_cell(in_si(group, estimate), group.display), group)
    return estimate_text(estimate, group.display.name, group.display.factor)


def beyond(group: Group, judged: Judged) -> str:
    """Return beyond which values a sensor is out of family."""
    low, high = (end_in_si(group, end) / group.display.factor for end in judged.sensor_limits)
    ends = [
        f"{word} {end:.3g}"
        for word, end, there in (("below", low, judged.sensor_limits[0]), ("above", high, judged.sensor_limits[1]))
        if math.isfinite(there)
    ]
    return with_unit(" or ".join(ends), group) if ends else "—"


def with_unit(text: str, group: Group) -> str:
    """Return a text with the unit in which people read a group."""
    return text if group.display.name == "1" else f"{text} {group.display.name}"


def spread_text(group: Group, spread: Coefficient) -> str:
    """Return a standard deviation on the scale of a group: in per cent, or in the unit."""
    if not math.isfinite(spread.upper):
        return "—"
    factor, unit = (0.01, "%") if group.observations.logarithmic else (group.display.factor, group.display.name)
    if spread.value is None:
        return f"< {_short(spread.upper / factor)} {unit}"
    value, lower, upper = (_short((end or 0.0) / factor) for end in (spread.value, spread.lower, spread.upper))
    return f"{value} {unit} [{lower}, {upper}]"


def _short(value: float) -> str:
    """Return a number with two significant digits, a large one as a whole number."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"  # noqa: PLR2004 - two digits before the point


def slope_text(group: Group, judged: Judged) -> str:
    """Return the dependence on temperature from log to log; a dash where it is not known."""
    if judged.slope is None:
        return "—"
    factor, unit = (
        (0.01, "%/°C") if group.observations.logarithmic else (group.display.factor, f"{group.display.name}/°C")
    )
    text = estimate_text(judged.slope.per_degree, unit, factor)
    return f"{text}; values are at {judged.slope.reference:.0f} °C" if judged.slope.used else f"{text}, not sure"


def probability_text(value: float) -> str:
    """Return a small probability."""
    return f"{value:.1g}" if value >= 1e-12 else "< 1e-12"  # noqa: PLR2004 - less is of no use
