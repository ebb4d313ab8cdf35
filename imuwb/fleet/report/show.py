"""Draws the report of a fleet: a tab for findings, one for each of the worst, families, outages, data sheet and logs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from imuwb.analysis import Curve, Figure, Mark, Review, Table
from imuwb.arrays import Booleans, Floats, Integers
from imuwb.colors import BLUE, GREY, ORANGE, PALE, RED
from imuwb.fleet.report.answer import believed, by_text
from imuwb.fleet.report.groups import Group
from imuwb.fleet.report.outages import DRIFT, RATIO
from imuwb.fleet.report.result import OUTSIDE, FleetReport, end_in_si, in_si, member_mean
from imuwb.fleet.report.sheet import FAMILY, SheetVerdict
from imuwb.fleet.report.words import (
    Row,
    beyond,
    cell,
    date_text,
    named,
    probability_text,
    rows_of,
    slope_text,
    spread_text,
    what,
    with_unit,
)
from imuwb.identification.family import Judged
from imuwb.statistics import Estimate
from imuwb.texts import coefficient_text, name_of
from imuwb.units import coefficient_units

TABS = 10  #: tabs of findings
MARKED = 8  #: sensors that a figure names
ROWS = 300  #: of a long table
POINTS = 2000  #: sensors or logs of a figure, besides those with a finding
LIMITS = 60  #: of sensors that are shown
_SHEET = ("of", "limit", "value", "verdict")
DAY = 86400.0  #: s
WIDEST = 200.0  #: natural logarithm that is drawn: an interval of one degree of freedom may be wider
MARGIN = 0.08  #: of the range of a figure
MIDDLE = (0.01, 0.99)  #: quantiles of the logs that a figure shows at least


def draw(report: FleetReport, review: Review, verdicts: Sequence[SheetVerdict] = ()) -> None:
    """Show the report of a fleet."""
    rows = rows_of(report)
    if report.groups:
        review.tab("Findings")
        review.figure(sensors_figure(report, next((row.worst.group for row in rows if row.worst.kind == OUTSIDE), 0)))
    if rows:
        review.table(_findings(report, rows))
    for row in rows[:TABS]:
        _one(report, row, review)
    if report.groups:
        _families(report, review)
    if any(group.coefficient in (DRIFT, RATIO) for group in report.groups):
        review.tab("Outages")
        _outages(report, review)
    if verdicts:
        review.tab("Data sheet")
        for table in sheet_tables(verdicts):
            review.table(table)
    if report.worthless:
        review.tab("Worthless logs")
        for table in worthless_tables(report):
            review.table(table)


def sensors_figure(report: FleetReport, place: int, group: str = "") -> Figure:
    """Return the sensors of a group in the order of their means, with the range of the family."""
    own, judged = report.groups[place], report.judged[place]
    order = np.argsort(judged.sensors.mean)
    x = np.arange(1.0, order.size + 1)
    members = [member_mean(judged, int(i), report.level) for i in order]
    ends = (_shown(own, np.array([getattr(m, name) for m in members])) for name in ("value", "lower", "upper"))
    value, lower, upper = ends
    out = np.isin(judged.sensors.sensor[order], [one.sensor for one in judged.outside])
    changed = np.isin(judged.sensors.sensor[order], [one.sensor for one in judged.changes]) & ~out
    edge = np.array([0.0, order.size + 1.0])
    curves = [
        _band(f"{100 * report.level:g} % of the family's sensors", own, judged.sensor_range, edge),
        *(
            Curve(label, x[rows], value[rows], color, lower[rows], upper[rows], style="points")
            for label, rows, color in (
                ("the others", _thinned(~out & ~changed), GREY), ("changing", np.flatnonzero(changed), BLUE),
                ("out of family", np.flatnonzero(out), RED),
            )
            if rows.size
        ),
    ]  # fmt: skip
    marks = tuple(
        Mark(
            float(x[i]), float(value[i]), name_of(own.sensors[judged.sensors.sensor[order[i]]]), RED if out[i] else BLUE,
            cell(own, members[i]),
        )
        for i in sorted(np.flatnonzero(out | changed), key=lambda i: -abs(members[i].value - judged.mean.value))[:MARKED]
    )  # fmt: skip
    who = "sensor" if own.axis else "vehicle"
    title = f"{own.type}: {what(own)} of each {who}"
    shown = np.concatenate([lower, upper, curves[0].y])
    beyond_these = _near(_shown(own, np.array(judged.sensor_limits)), shown)
    curves += [
        Curve("" if i else "out of family beyond", edge, np.full(2, end), RED, style="fit")
        for i, end in enumerate(beyond_these)
    ]
    limits = _limits(np.concatenate([shown, beyond_these]))
    return Figure(
        title, f"{who}s in order of their mean [1]", f"{own.coefficient} [{own.display.name}]", tuple(curves), marks, "linear", "linear",
        x_limits=(0.0, order.size + 1.0), y_limits=limits, group=group,
    )  # fmt: skip


def _one(report: FleetReport, row: Row, review: Review) -> None:
    """Show one sensor over time, and its logs with the commands that show them."""
    one = row.worst
    review.tab(name_of(f"{one.sensor} {one.kind}"))
    review.figure(over_time(report, one.group, one.number))
    group, judged = report.groups[one.group], report.judged[one.group]
    review.note(
        f"{one.sensor}: {one.kind}, {named(report, row.findings)}: {by_text(report, one)}; probability by chance {probability_text(one.probability)}."
    )
    review.table(_logs(report, group, judged, one.number))


def over_time(report: FleetReport, place: int, number: int) -> Figure:
    """Return the values of all logs over time with the range of the family, and values and limits of one sensor in front."""
    group, judged = report.groups[place], report.judged[place]
    time = judged.rows.time
    dated = bool(np.isfinite(time).any())
    start = float(np.nanmin(time)) if dated else 0.0
    x = (time - start) / DAY if dated else np.arange(1.0, time.size + 1)
    own, order = judged.rows.sensor == number, np.argsort(x, kind="stable")
    mine, others = order[own[order]], _thinned(~own)
    limited = (group.limited.sensor == number) & np.isfinite(group.limited_time) & dated
    limit_at = (group.limited_time[limited] - start) / DAY
    edge = np.array([np.nanmin([*x, *limit_at]), np.nanmax([*x, *limit_at])])
    margin = MARGIN * max(edge[1] - edge[0], 1.0)
    edge = edge + np.array([-margin, margin])
    factor = group.display.factor
    sensor = group.named[number]
    limit = np.exp(group.limited.upper[limited]) / factor
    inside = np.quantile(group.value / factor, MIDDLE)
    extent = _shown(group, np.array([judged.log_range.lower, judged.log_range.upper]))
    limits = _limits(np.concatenate([group.lower[mine] / factor, group.upper[mine] / factor, extent, inside, limit]))
    curves = [
        _band(f"{100 * report.level:g} % of the family's logs", group, judged.log_range, edge),
        Curve("all other sensors", x[others], group.value[others] / factor, GREY, style="points"),
    ]
    if mine.size:
        curves.append(
            Curve(
                sensor, x[mine], group.value[mine] / factor, RED, group.lower[mine] / factor, group.upper[mine] / factor
            )
        )
    if limit.size:
        curves.append(
            Curve(f"limits of {sensor}", limit_at, limit, ORANGE, np.full(limit.size, limits[0]), limit, style="points")
        )
    axis = f"days since {date_text(int(start * 1e9))} [d]" if dated else "logs, none of which has a date [1]"
    return Figure(
        f"{sensor}: {what(group)} from log to log", axis, f"{group.coefficient} [{group.display.name}]", tuple(curves), (), "linear", "linear",
        x_limits=(float(edge[0]), float(edge[1])), y_limits=limits,
    )  # fmt: skip


def _thinned(rows: Booleans) -> Integers:
    """Return rows, evenly fewer of them if there are more than a figure shows."""
    places = np.flatnonzero(rows)
    return places[:: max(1, -(-places.size // POINTS))]


def _band(label: str, group: Group, extent: Estimate, edge: Floats) -> Curve:
    value, lower, upper = (_shown(group, np.full(2, end)) for end in (extent.value, extent.lower, extent.upper))
    return Curve(label, edge, value, PALE, lower, upper, style="band")


def _shown(group: Group, values: Floats) -> Floats:
    """Return values on the scale of a group in the unit that people read."""
    return (
        np.exp(np.clip(values, -WIDEST, WIDEST)) if group.observations.logarithmic else values
    ) / group.display.factor


def _near(ends: Floats, values: Floats) -> Floats:
    """Return the ends that a figure of values has room for."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    return ends[(ends >= low - (high - low)) & (ends <= high + (high - low))]


def _limits(values: Floats) -> tuple[float, float]:
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    margin = MARGIN * (high - low) or abs(high) or 1.0
    return (max(low - margin, 0.0) if low >= 0 else low - margin), high + margin


def _findings(report: FleetReport, rows: Sequence[Row]) -> Table:
    cells = tuple(
        (
            row.worst.sensor, row.worst.kind, named(report, row.findings), by_text(report, row.worst),
            cell(report.groups[row.worst.group], report.judged[row.worst.group].mean), probability_text(row.worst.probability),
            report.see(row.worst.logs[-1]),
        )
        for row in rows[:ROWS]
    )  # fmt: skip
    caption = (
        f"The worst first. Where no sensor is out of family or changes, and sensors differ as normal variables do, chance makes any finding in "
        f"{100 * report.error:g} % of fleets. The last column is the command that makes the recording of the log."
    )
    return Table(
        "Findings", ("sensor", "finding", "of", "by", "family", "by chance", "see the log"), cells, caption, wide=True
    )


def _logs(report: FleetReport, group: Group, judged: Judged, number: int) -> Table:
    """Return the values and limits of one sensor in the order of time."""
    rows = np.flatnonzero(judged.rows.sensor == number)
    ends = ([group.display.from_si(float(x[row])) for x in (group.value, group.lower, group.upper)] for row in rows)
    found = [
        (group.logs[row], f"{value:.4g} [{low:.4g}, {high:.4g}]")
        for row, (value, low, high) in zip(rows, ends, strict=True)
    ]
    limits = [
        (row, group.display.from_si(float(np.exp(group.limited.upper[row]))))
        for row in np.flatnonzero(group.limited.sensor == number)
    ]
    found += [(group.limited_logs[row], f"< {limit:.4g}") for row, limit in limits]
    logs = [(report.logs.get(key), key, text) for key, text in found]
    logs.sort(key=lambda one: (one[0].start or 0) if one[0] is not None else 0)
    cells = tuple(
        (
            date_text(None if log is None else log.start), text,
            "—" if log is None or log.temperature is None else f"{log.temperature:.1f}", report.see(key),
        )
        for log, key, text in logs[:ROWS]
    )  # fmt: skip
    headings = ("date", f"{group.coefficient} [{group.display.name}]", "temperature [°C]", "see the log")
    return Table(f"Logs of {group.named[number]}", headings, cells, wide=True)


def _families(report: FleetReport, review: Review) -> None:
    """Show mean and spread of each family, and the sensors of each, small and side by side."""
    review.tab("Families")
    together = {
        place: f"{group.type} {group.axis.partition('_')[0]} {group.coefficient}"
        for place, group in enumerate(report.groups)
        if group.axis
    }
    first = {name: place for place, name in reversed(together.items())}
    for place in sorted(together, key=lambda place: (first[together[place]], place)):  # x, y and z side by side
        review.figure(sensors_figure(report, place, together[place]))
    review.table(family_table(report))


def family_table(report: FleetReport) -> Table:
    """Return mean and spread of each family."""
    rows = tuple(
        (
            group.type, what(group), str(judged.sensors.sensor.size), _logs_text(judged), cell(group, judged.mean),
            spread_text(group, judged.between), spread_text(group, judged.within), _range(group, judged), beyond(group, judged), slope_text(group, judged),
            "; ".join(f"{count} {reason}" for reason, count in group.left_out.items()) or "none",
        )
        for group, judged in zip(report.groups, report.judged, strict=True)
    )  # fmt: skip
    caption = (
        "Standard deviations by random effects (restricted likelihood), without the sensors out of family; from log to log beyond what the "
        "intervals of the logs state. < is a limit: the intervals of the logs explain the scatter. Where logs give a limit only, it counts as a "
        "limit: the coefficient of these logs is somewhere below."
    )
    headings = (
        "type", "of", "sensors", "logs", "mean [interval]", "between sensors", "from log to log",
        f"{100 * report.level:g} % of sensors", "out of family", "temperature", "not counted",
    )  # fmt: skip
    return Table("Families", headings, rows, caption, wide=True)


def _logs_text(judged: Judged) -> str:
    values = str(int(judged.kept.sum()))
    return f"{values} and {judged.limited} limits" if judged.limited else values


def _range(group: Group, judged: Judged) -> str:
    low, high = (
        end_in_si(group, end) / group.display.factor for end in (judged.sensor_range.lower, judged.sensor_range.upper)
    )
    return with_unit(f"{low:.3g} to {high:.3g}", group)


def _outages(report: FleetReport, review: Review) -> None:
    for place, group in enumerate(report.groups):
        if group.coefficient in (DRIFT, RATIO):
            review.figure(sensors_figure(report, place, group.coefficient))
    for table in outage_tables(report):
        review.table(table)


def outage_tables(report: FleetReport) -> tuple[Table, ...]:
    """Return the vehicles of each filter, those that drift most first, and whether sigma is believed."""
    tables: list[Table] = []
    for group, judged in zip(report.groups, report.judged, strict=True):
        if group.coefficient not in (DRIFT, RATIO):
            continue
        out = {one.sensor for one in judged.outside}
        rows: list[tuple[str, ...]] = []
        for at in np.argsort(-judged.sensors.mean)[:ROWS]:
            number = int(judged.sensors.sensor[at])
            mean = member_mean(judged, int(at), report.level)
            verdict = believed(in_si(group, mean)) if group.coefficient == RATIO else ""
            place = "out of family" if number in out else "in the family"
            rows.append((group.sensors[number], str(int(judged.sensors.logs[at])), cell(group, mean), verdict or place))
        last = "sigma is" if group.coefficient == RATIO else "verdict"
        tables.append(
            Table(
                f"{group.coefficient.capitalize()}: {group.source}",
                ("vehicle", "logs", "mean [interval]", last),
                tuple(rows),
            )
        )
    return tuple(tables)


def sheet_tables(verdicts: Sequence[SheetVerdict]) -> tuple[Table, ...]:
    """Return the verdicts on the family, and those on sensors, the worst first."""
    family = [one for one in verdicts if one.sensor == FAMILY]
    sensors = [one for one in verdicts if one.sensor != FAMILY]
    more = f" The first {LIMITS} of {len(sensors)} limits; --json has all." if len(sensors) > LIMITS else ""
    caption = "within: the whole interval is below the limit; beyond: it is above; not sure: it contains the limit."
    return (
        Table(
            "The family against the data sheet",
            ("type", *_SHEET),
            tuple((one.type, *_sheet_row(one)) for one in family),
            caption,
        ),
        Table(
            "Sensors",
            ("sensor", *_SHEET),
            tuple((one.sensor, *_sheet_row(one)) for one in sensors[:LIMITS]),
            f"The worst first.{more}",
        ),
    )


def _sheet_row(one: SheetVerdict) -> tuple[str, ...]:
    limit = one.verdict.limit
    display = coefficient_units(limit.axis, limit.letter)[1]
    stated = f"{display.from_si(limit.at_most):.4g} {display.name}"
    return (
        f"{limit.axis.replace('_', ' ')} {limit.letter}",
        stated,
        coefficient_text(one.verdict.coefficient, display),
        one.verdict.outcome,
    )


def worthless_tables(report: FleetReport) -> tuple[Table, ...]:
    """Return how many logs there are of each kind of fault, and the logs."""
    kinds = tuple(
        (kind, str(count), f"{100 * count / max(report.count, 1):.2g} %") for kind, count in report.kinds.most_common()
    )
    rows = tuple((one.path, one.sensor or "—", one.kind, one.message) for one in report.worthless[:ROWS])
    more = (
        f"The first {ROWS} of {len(report.worthless)}; all are in quarantine.parquet."
        if len(report.worthless) > ROWS
        else ""
    )
    return (
        Table("Worthless logs by kind", ("kind", "logs", "of all logs"), kinds),
        Table("Worthless logs", ("log", "sensor", "kind", "why"), rows, more, wide=True),
    )
