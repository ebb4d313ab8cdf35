"""The report of a fleet as a document, in SI."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from imuwb.fleet.report.groups import Group
from imuwb.fleet.report.result import Finding, FleetReport, end_in_si, in_si
from imuwb.fleet.report.sheet import SheetVerdict
from imuwb.identification.family import Judged
from imuwb.identification.family.judgement import Slope
from imuwb.units import coefficient_units

LN = "ln"  #: unit of the natural logarithm of a ratio: a difference of 0.1 ln is 10.5 %


def content_of(report: FleetReport, verdicts: Sequence[SheetVerdict]) -> dict[str, object]:
    """Return families, findings, verdicts and worthless logs; the unit ln is that of the natural logarithm of a ratio."""
    return {
        "analysis": report.analysis, "command": report.command, "state": report.state, "logs": report.count, "logs_of_run": report.planned, "sensors": report.sensors,
        "error": report.error, "level": report.level,
        "findings": [_finding(report, one) for one in report.findings],
        "families": [_family(group, judged) for group, judged in zip(report.groups, report.judged, strict=True)],
        "verdicts": [
            {"sensor": one.sensor, "type": one.type, "axis": one.verdict.limit.axis, "coefficient": one.verdict.limit.letter,
             "limit": one.verdict.limit.at_most, "unit": coefficient_units(one.verdict.limit.axis, one.verdict.limit.letter)[0].name, "stated": one.verdict.coefficient, "outcome": one.verdict.outcome}
            for one in verdicts
        ],
        "worthless": report.worthless,
    }  # fmt: skip


def _finding(report: FleetReport, one: Finding) -> dict[str, object]:
    group = report.groups[one.group]
    return {
        "sensor": one.sensor, "finding": one.kind, **_key(group), "probability": one.probability, "score": one.score,
        "size": replace(one.size, unit=_scale(group)),
        "relative": group.observations.logarithmic, "logs": [{"log": key, "see": report.see(key)} for key in one.logs],
    }  # fmt: skip


def _key(group: Group) -> dict[str, object]:
    return {"type": group.type, "source": group.source, "axis": group.axis, "coefficient": group.coefficient}


def _scale(group: Group) -> str:
    """Return the unit of differences on the scale of a group: that of the group, or ``ln`` for the logarithm of a ratio."""
    return LN if group.observations.logarithmic else group.unit


def _slope(group: Group, slope: Slope | None) -> Slope | None:
    return slope and replace(slope, per_degree=replace(slope.per_degree, unit=f"{_scale(group)}/°C"))


def _family(group: Group, judged: Judged) -> dict[str, object]:
    limits = [end_in_si(group, end) if math.isfinite(end) else None for end in judged.sensor_limits]
    return {
        **_key(group), "unit": group.unit, "sensors": int(judged.sensors.sensor.size), "values": int(judged.kept.sum()),
        "limited_logs": judged.limited, "limits_that_values_contradict": judged.contradicting, "more_may_be_outside": judged.more,
        "mean": in_si(group, judged.mean), "range_of_sensors": in_si(group, judged.sensor_range), "out_of_family_beyond": limits,
        "relative": group.observations.logarithmic, "between_sensors": replace(judged.between, unit=_scale(group)),
        "from_log_to_log": replace(judged.within, unit=_scale(group)),
        "per_degree": _slope(group, judged.slope), "heavy_tails": judged.tails, "not_counted": dict(group.left_out),
    }  # fmt: skip
