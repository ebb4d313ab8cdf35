"""The answer of the report of a fleet: findings, the worst first, the family, and the logs that are worthless."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence

from imuwb.analysis import Answer, Step
from imuwb.fleet.report.groups import LIMIT_ONLY
from imuwb.fleet.report.outages import DRIFT, RATIO
from imuwb.fleet.report.result import KINDS, OUTSIDE, Finding, FleetReport, in_si
from imuwb.fleet.report.sheet import FAMILY, SheetVerdict, outcomes
from imuwb.fleet.report.words import beyond, cell, named, rows_of, size_text, spread_text, what, when_text
from imuwb.fleet.schemas import DUPLICATE
from imuwb.identification.family import Judged
from imuwb.identification.family.members import FEWEST
from imuwb.names import distinct
from imuwb.statistics import Coefficient, Estimate
from imuwb.texts import counted

MOST = 6  #: findings in the answer
NAME = 14  #: columns of the name of a sensor
CONTRADICTING = "the limit is far below the values of the same sensor"
FEW = 12  #: sensors; in a smaller family only a sensor far outside is found, and the answer says how far


def answer(report: FleetReport, verdicts: Sequence[SheetVerdict] = ()) -> Answer:
    """Return the answer; ``verdicts`` are those of a data sheet, if one is given."""
    shown = rows_of(report)[:MOST]
    names = distinct([row.worst.sensor for row in shown], NAME) if shown else ()
    rows = tuple(
        (name, row.worst.kind, named(report, row.findings), by_text(report, row.worst))
        for name, row in zip(names, shown, strict=True)
    )
    steps = tuple(Step(report.see(row.worst.logs[-1]), f"{row.worst.sensor}: its log") for row in shown[:1])
    of = f" of {report.planned}" if report.unfinished else ""
    about = f"{report.count}{of} log{'s' if report.count > 1 or of else ''} of {report.owned.text}, {report.analysis}"
    return Answer(
        about, ("sensor", "finding", "of", "by"), rows, tuple(_sentences(report, verdicts)), steps,
        f"{100 * report.level:g} % intervals", numbers=_numbers(report),
    )  # fmt: skip


def by_text(report: FleetReport, finding: Finding) -> str:
    """Return how large a finding is, and when: "+8.1 % [7.2, 9.0] in 4 months"."""
    size = size_text(report.groups[finding.group], finding.size)
    return " ".join(filter(None, (size, when_text(report, finding))))


def _sentences(report: FleetReport, verdicts: Sequence[SheetVerdict]) -> Iterator[str]:
    if report.unfinished:
        yield f"{report.unfinished[0].upper()}{report.unfinished[1:]}."
    if report.groups:
        yield _counted(report)
    else:
        yield "No family is judged, and no sensor can be out of it: the logs give limits only, or one value."
    if report.owned.moved:
        yield report.owned.moved_text
    yield from _checked(verdicts)
    yield from _worthless(report)
    yield from _family(report)
    yield from _outages(report)
    if (tails := report.tails) is not None and tails <= report.error:
        told = [(j.tails, what(g)) for g, j in zip(report.groups, report.judged, strict=True) if j.tails is not None]
        yield (
            f"Without the findings, sensors differ in {min(told)[1]} with heavier tails than normal ones: a sensor out of family may be in "
            "such a tail, and one that is not found may be out of family."
        )
    warm = [what(g) for g, j in zip(report.groups, report.judged, strict=True) if j.slope is not None and j.slope.used]
    if warm:
        yield f"Temperature changes {', '.join(warm[:4])}{' and more' if len(warm) > 4 else ''}: values are compared at one temperature."  # noqa: PLR2004
    silent = [one.coefficient for one in report.silent if one.limited.upper.size or one.left_out.get(LIMIT_ONLY)]
    if silent:
        names = ", ".join(f"{name} of {count} axes" if count > 1 else name for name, count in Counter(silent).items())
        yield f"Not judged, because too few logs give a value: {names}."
    if limits := sum(one.limited for one in report.judged):
        values = sum(int(one.kept.sum()) for one in report.judged)
        yield f"{limits} of {values + limits} values are limits; they count as limits in the family."
    left = Counter[str]()
    for group in report.groups:
        left.update(group.left_out)
    left[CONTRADICTING] += sum(one.contradicting for one in report.judged)
    left = +left
    if left:
        reasons = "; ".join(f"{counted(count, 'value')}, {reason}" for reason, count in left.most_common())
        yield f"Not counted: {reasons}."


def _counted(report: FleetReport) -> str:
    """Return how many sensors have findings, and how sure this is."""
    out, changed, vehicles = found_sensors(report)
    heavy = report.tails is not None and report.tails <= report.error
    sure = f"chance alone finds one in {'more than ' if heavy else ''}{100 * report.error:g} % of fleets"
    few = (
        ""
        if any(map(_told, report.judged))
        else f" Which is out of family cannot be said: that needs {FEWEST} sensors of one family."
    )
    if not report.findings and few:
        return f"None changes ({sure}).{few}"
    if not report.findings:
        return f"No sensor is out of family, and none changes ({sure}).{_how_far(report)}"
    more = len(rows_of(report)) - MOST
    rest = f" {more} more rows: --full." if more > 0 else ""
    if any(one.more for one in report.judged):
        rest += " More sensors may be out of family: the search ends at three tenths of a family."
    driving = f"; vehicles with a finding in outages: {len(vehicles)}" if vehicles else ""
    return f"Out of family: {len(out)} of {report.sensors} sensors; changing from log to log: {len(changed)}{driving} ({sure}).{few}{rest}"


def _how_far(report: FleetReport) -> str:
    """Return how far outside a sensor of small families must be to be found."""
    pairs = [(group, one) for group, one in zip(report.groups, report.judged, strict=True) if _told(one)]
    pairs = [pair for pair in pairs if pair[0].observations.logarithmic] or pairs
    if not pairs or max(one.sensors.sensor.size for _, one in pairs) >= FEW:
        return ""
    group, judged = min(pairs, key=lambda pair: pair[1].sensor_limits[1] - pair[1].sensor_limits[0])
    return f" With so few sensors only a far one is found: {what(group)} {beyond(group, judged)}."


def _told(judged: Judged) -> bool:
    """Return whether a family has enough sensors to tell which is outside."""
    return any(map(math.isfinite, judged.sensor_limits))


def found_sensors(report: FleetReport) -> tuple[frozenset[str], frozenset[str], frozenset[str]]:
    """Return the sensors out of family, those that change, and the vehicles with a finding in outages."""
    own = [one for one in report.findings if report.groups[one.group].coefficient not in (DRIFT, RATIO)]
    out = frozenset(one.sensor for one in own if one.kind == OUTSIDE)
    changed = frozenset(one.sensor for one in own if one.kind in KINDS.values())
    return out, changed, frozenset(one.sensor for one in report.findings if one not in own)


def _checked(verdicts: Sequence[SheetVerdict]) -> Iterator[str]:
    if not verdicts:
        return
    counts = outcomes(verdicts)
    family = [one for one in verdicts if one.sensor == FAMILY]
    bad = {one.sensor for one in verdicts if one.sensor != FAMILY and one.verdict.outcome == "beyond"}
    listed = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
    kept = sum(one.verdict.outcome == "within" for one in family)
    keeps = f"the family keeps {kept} of {counted(len(family), 'limit')}, " if family else ""
    beyond_one = "1 sensor is" if len(bad) == 1 else f"{len(bad)} sensors are"
    yield f"Data sheet: {listed}; {keeps}{beyond_one} beyond one."


def _worthless(report: FleetReport) -> Iterator[str]:
    if report.copies:
        yield f"{counted(report.copies, 'log')} with the bytes of another: each content counts once."
    if report.kinds:
        count = len({one.path for one in report.worthless if one.kind != DUPLICATE})
        kinds = ", ".join(f"{n} {kind}" for kind, n in report.kinds.most_common())
        yield f"Worthless: {count} of {report.count} logs ({100 * count / max(report.count, 1):.2g} %): {kinds}."


def _family(report: FleetReport) -> Iterator[str]:
    """Yield the family of the coefficient with the most sensors."""
    places = [i for i, group in enumerate(report.groups) if group.coefficient not in (DRIFT, RATIO)]
    if not places:
        return
    place = max(places, key=lambda i: (len(report.groups[i].sensors), -i))
    group, own = report.groups[place], report.judged[place]
    within, between = spread_text(group, own.within), spread_text(group, own.between)
    differ = [
        f"{who} differ by {text}" for who, text in (("sensors", between), ("logs of one sensor", within)) if text != "—"
    ]
    alone = ". Each has one log, so this includes changes from log to log" if differ and within == "—" else ""
    yield (
        f"Family of {counted(len(own.sensors.sensor), 'sensor')}, {what(group)}: {cell(group, own.mean)}"
        f"{'; ' if differ else ''}{', '.join(differ)}{alone}."
    )


def _outages(report: FleetReport) -> Iterator[str]:
    """Yield how far the first filter drifts, and whether its sigma is believed over the fleet."""
    pairs = list(zip(report.groups, report.judged, strict=True))
    drift = next(((group, own) for group, own in pairs if group.coefficient == DRIFT), None)
    if drift is None:
        return
    group, own = drift
    ratio = next(
        (
            in_si(g, j.mean)
            for g, j in pairs
            if g.coefficient == RATIO and (g.type, g.source) == (group.type, group.source)
        ),
        None,
    )
    sure = "" if ratio is None else f"; its sigma is {believed(ratio)}"
    between = spread_text(group, own.between)
    differ = "" if between == "—" else f"; vehicles differ by {between}"
    yield f"Outages, {group.source}: {cell(group, own.mean)}{sure}{differ}."


def believed(ratio: Coefficient) -> str:
    """Return whether a sigma is believed, from the ratio of the errors to it."""
    value, lower = ratio.value or 0.0, ratio.lower or 0.0
    interval = f"errors over sigma {value:.3g} [{lower:.3g}, {ratio.upper:.3g}]"
    if lower <= 1 <= ratio.upper:
        return f"right ({interval})"
    return f"{value:.2g} times too small ({interval})" if value > 1 else f"{1 / value:.2g} times too large ({interval})"


def _numbers(report: FleetReport) -> dict[str, Estimate]:
    """Return the figures by which a catalog sorts reports."""
    nan = float("nan")
    out, changed, vehicles = map(len, found_sensors(report))
    counts = {
        "sensors": report.sensors,
        "out of family": out,
        "changing": changed,
        "vehicles out of family": vehicles,
        "quarantined logs": report.quarantined,
    }
    numbers = {name: Estimate(float(count), nan, nan) for name, count in counts.items()}
    for group, own in zip(report.groups, report.judged, strict=True):
        coefficient, unit = in_si(group, own.mean), group.display
        if group.axis and coefficient.value is not None:
            ends = (unit.from_si(x) for x in (coefficient.value, coefficient.lower or 0.0, coefficient.upper))
            numbers[f"{group.type} {group.name}".strip()] = Estimate(*ends, unit=unit.name)
    return numbers
