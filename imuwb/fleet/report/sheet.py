"""The family and each sensor against a data sheet, with the limits and verdicts of ``imuwb model check``."""

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.fleet.report.groups import Group
from imuwb.fleet.report.result import FleetReport, in_si, member_mean
from imuwb.identification.family import Judged
from imuwb.statistics import Coefficient
from imuwb.stochastic.model_check import Limit, Verdict, verdict

FAMILY = "the family"
WORST_FIRST = ("beyond", "not sure", "not known", "within")


@dataclass(frozen=True, slots=True)
class SheetVerdict:
    """One limit for one sensor, or for the mean of the family."""

    type: str
    sensor: str  #: or ``FAMILY``
    verdict: Verdict


def against(report: FleetReport, limits: Sequence[Limit]) -> tuple[SheetVerdict, ...]:
    """Return a verdict on the family and on each sensor for each limit, the worst first."""
    found: list[SheetVerdict] = []
    judged = {id(group): own for group, own in zip(report.groups, report.judged, strict=True)}
    for limit in limits:
        there = [g for g in (*report.groups, *report.silent) if (g.axis, g.coefficient) == (limit.axis, limit.letter)]
        stated = [
            SheetVerdict(group.type, who, verdict(limit, value))
            for group in there
            for who, value in _stated(group, judged.get(id(group)), report.level)
        ]
        found += stated or [SheetVerdict("", FAMILY, verdict(limit, Coefficient(None, None, math.inf)))]
    return tuple(sorted(found, key=lambda one: (WORST_FIRST.index(one.verdict.outcome), -_excess(one.verdict))))


def outcomes(verdicts: Sequence[SheetVerdict]) -> Counter[str]:
    """Return how many verdicts there are of each kind."""
    return Counter(one.verdict.outcome for one in verdicts)


def _stated(group: Group, judged: Judged | None, level: float) -> Iterator[tuple[str, Coefficient]]:
    """Yield the family and each sensor with its value, and the limits of sensors without any; of a group that is not judged, the largest value of each."""
    if judged is not None:
        yield FAMILY, in_si(group, judged.mean)
        for place, number in enumerate(judged.sensors.sensor):
            yield group.sensors[number], in_si(group, member_mean(judged, place, level))
    else:
        for number, sensor in enumerate(group.sensors):
            rows = np.flatnonzero(group.observations.sensor == number)
            if rows.size:
                at = rows[group.upper[rows].argmax()]
                value, lower, upper = (float(end[at]) for end in (group.value, group.lower, group.upper))
                yield sensor, Coefficient(value, lower, upper, group.unit)
    for sensor, limit in group.limits.items():
        yield sensor, Coefficient(None, None, limit, group.unit)


def _excess(one: Verdict) -> float:
    upper = one.coefficient.upper
    return upper / one.limit.at_most if one.limit.at_most > 0 else upper
