"""The result of the judgement of a fleet: findings, the worst first, families, and logs that gave nothing."""

from __future__ import annotations

import math
import shlex
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from imuwb.errors import MissingDataError
from imuwb.fleet.owned import Owned, owned
from imuwb.fleet.report.groups import (
    DOUBTFUL,
    LIMIT_ONLY,
    NO_INTERVAL,
    OTHER_LEVEL,
    UNKNOWN_SENSOR,
    Group,
    sensor_groups,
)
from imuwb.fleet.report.outages import outage_groups
from imuwb.fleet.run_state import RunState, State
from imuwb.fleet.schemas import DONE, DUPLICATE, SUSPICIOUS
from imuwb.identification.family import Judged, Judgement, judge, tails_together
from imuwb.log import AXES
from imuwb.statistics import Coefficient, Estimate
from imuwb.statistics.distributions import student_limit
from imuwb.texts import counted, printable

compute: Any = pc
OUTSIDE = "out of family"
KINDS = {"trend": "drifts", "step": "steps", "log": "one log differs"}  #: of changes, in words
MOST_EXPONENT = 700.0  #: of e, in a number of 64 bits
_OTHERS = "an analysis of coefficients does, such as imuwb fleet noise"  #: that state intervals
MANY = 1e6  #: degrees of freedom of a normal variable
ORDER = "NBKQR"  #: of coefficients


@dataclass(frozen=True, slots=True)
class Finding:
    """One sensor and one coefficient."""

    sensor: str
    kind: str  #: ``OUTSIDE``, or one of ``KINDS``
    group: int  #: place of the group in the result
    number: int  #: of the sensor in the group
    score: float  #: standard normal value that is as improbable
    probability: float  #: that chance makes any finding of this kind: over the family, or over the fleet
    size: Estimate  #: on the scale of the group: a logarithm, or SI
    logs: tuple[str, ...]  #: keys: of a trend the first and the last, of a step those around it; else one


@dataclass(frozen=True, slots=True)
class LogRow:
    """A log, as a person finds it again."""

    key: str
    path: str
    start: int | None  #: ns since 1970
    temperature: float | None  #: °C


@dataclass(frozen=True, slots=True)
class Worthless:
    """A log that gave no result, or none that is trusted."""

    path: str
    sensor: str
    kind: str
    message: str


@dataclass(frozen=True, eq=False, slots=True)
class FleetReport:
    """What the tables of a fleet say."""

    analysis: str
    command: str  #: that made the tables
    options: str  #: of the analysis, where they differ from the defaults
    error: float  #: probability that chance makes any finding
    level: float  #: of the intervals
    logs: Mapping[str, LogRow]  #: key -> log
    state: State  #: of the run
    planned: int  #: logs of the run
    count: int  #: logs in the tables; fewer than those of the run until it has ended
    owned: Owned  #: whose they are
    sensors: int  #: that have a value or a limit
    groups: tuple[Group, ...]
    judged: tuple[Judged, ...]
    silent: tuple[Group, ...]  #: groups that are not judged: their logs give limits, or one value
    findings: tuple[Finding, ...]  #: the worst first
    worthless: tuple[Worthless, ...]

    @property
    def copies(self) -> int:
        """Return the number of logs that are copies of others."""
        return sum(one.kind == DUPLICATE for one in self.worthless)

    @property
    def quarantined(self) -> int:
        """Return the number of logs in quarantine; a copy of a log that counts is none."""
        return len({one.path for one in self.worthless if one.kind not in (SUSPICIOUS, DUPLICATE)})

    @property
    def quarantined_share(self) -> float:
        """Return the share of the logs in the tables that are in quarantine."""
        return self.quarantined / self.count if self.count else 0.0

    @property
    def unfinished(self) -> str:
        """Return how far a run came that has not ended, as a clause; empty: it has ended."""
        return _unfinished(self.state, self.count, self.planned)

    @property
    def kinds(self) -> Counter[str]:
        """Return how many logs there are of each kind of fault."""
        return Counter(
            kind for _, kind in sorted({(one.path, one.kind) for one in self.worthless}) if kind != DUPLICATE
        )

    @property
    def tails(self) -> float | None:
        """Return the probability that chance makes the tails of normal sensors so heavy; None: it cannot be told."""
        return tails_together([one.tails for one in self.judged if one.tails is not None])

    def see(self, key: str) -> str:
        """Return the command that makes the recording of a log."""
        log = self.logs.get(key)
        path = log.path if log else key
        return f"imuwb {self.analysis} {_word(path)} {self.options}".rstrip()


def _unfinished(state: State, count: int, planned: int) -> str:
    """Return how far a run came that has not ended, as a clause; empty: it has ended."""
    if state == "ended":
        return ""
    what = "is interrupted" if state == "interrupted" else "is under way, or was killed"
    return f"the run {what}: {count} of {planned} logs are in the tables"


def _word(path: str) -> str:
    r"""Return a path as a word of a command that can be shown: bytes that cannot be are ``$'\x1b'``, as the shells bash and zsh read them."""
    if printable(path) == path:
        return shlex.quote(path)
    letters = (
        c if printable(c) == c and c not in "'\\" else "".join(f"\\x{byte:02x}" for byte in c.encode()) for c in path
    )
    return f"$'{''.join(letters)}'"


def fleet_report(
    state: RunState,
    tables: Mapping[str, pa.Table],
    *,
    error: float = 0.01,
    level: float = 0.95,
    doubtful: bool = False,
    sheet: bool = False,
    options: str = "",
) -> FleetReport:
    """Return what the tables of a fleet say.

    Args:
        state: of the run.
        tables: name -> table, as ``imuwb.fleet.schemas`` states them.
        error: probability that chance makes any finding in a fleet without any such sensor.
        level: of the intervals.
        doubtful: whether values count that a remark puts in doubt.
        sheet: whether a data sheet is given, which limits of logs can keep; then a report without any family is made of them.
        options: of the analysis, where they differ from the defaults, as words of a command.

    Raises:
        MissingDataError: no sensor has a value, or there is no limit for the data sheet.
    """
    every = (*sensor_groups(tables["sensors"], doubtful=doubtful), *outage_groups(tables["outages"]))
    every = sorted(every, key=_place)
    groups = tuple(group for group in every if group.is_judged)
    if not groups and not (sheet and any(group.limits or group.sensors for group in every)):
        count = tables["logs"].num_rows
        unfinished = _unfinished(state.state, count, state.logs)
        goes_on = f"{unfinished}; the same imuwb fleet command goes on" if unfinished else ""
        why = _nothing(every, state, tables) if count or not unfinished else ""
        raise MissingDataError("; ".join(filter(None, (goes_on, why))))
    judged: tuple[Judged, ...] = ()
    findings: list[Finding] = []
    if groups:
        judgement = judge(
            {str(i): group.observations for i, group in enumerate(groups)}, error, level,
            {str(i): group.limited for i, group in enumerate(groups)},
        )  # fmt: skip
        judged = tuple(judgement.families[str(i)] for i in range(len(groups)))
        findings = sorted(_findings(groups, judgement), key=lambda one: -abs(one.score))
    logs = _logs(tables["logs"])
    names = {name for group in groups if group.axis for name in group.named} or {
        name for group in groups for name in group.named
    }
    whose = owned(zip(tables["logs"]["vehicle"].to_pylist(), tables["logs"]["serial"].to_pylist(), strict=True))
    worthless = (*_quarantine(tables["quarantine"]), *(() if doubtful else _doubtful(tables["sensors"], logs)))
    return FleetReport(
        state.analysis, state.command, options, error, level, logs, state.state, state.logs, tables["logs"].num_rows, whose, len(names), groups, judged, tuple(group for group in every if not group.is_judged), tuple(findings),
        worthless,
    )  # fmt: skip


def _place(group: Group) -> tuple[object, ...]:
    """Return the place of a group: gyros before accelerometers, the random walk first."""
    axis = AXES.index(group.axis) if group.axis in AXES else len(AXES)
    letter = ORDER.find(group.coefficient) if len(group.coefficient) == 1 else len(ORDER)
    return group.type, group.source, letter, axis, group.coefficient


def _nothing(groups: Sequence[Group], state: RunState, tables: Mapping[str, pa.Table]) -> str:
    """Return why there is nothing to judge, and what can be done."""
    logs = tables["logs"]
    counts: Counter[str] = sum((Counter(group.left_out) for group in groups), Counter())
    counts += Counter({LIMIT_ONLY: sum(group.limited.upper.size for group in groups)})
    reasons = "; ".join(f"{reason}: {counted(count, 'row')}" for reason, count in counts.most_common())
    sheet = ", and --check FILE.toml compares the limits with a data sheet" if any(one.limits for one in groups) else ""
    remedies = {
        UNKNOWN_SENSOR: "imuwb fleet takes --group, --identities or --metadata to know the sensors",
        DOUBTFUL: "--with-doubtful counts values that a remark puts in doubt",
        LIMIT_ONLY: f"longer logs show more{sheet}",
        NO_INTERVAL: _OTHERS,
        OTHER_LEVEL: "run all logs with one --level",
    }
    if counts:
        return "; ".join(
            [f"no value can be judged ({reasons})", *(text for reason, text in remedies.items() if counts[reason])]
        )
    if rows := sum(group.observations.y.size for group in groups):
        return f"each coefficient has one value only ({rows} in all); a fleet needs several logs, of several sensors"
    none = f"none of the {logs.num_rows} logs has a value with an interval"
    if DONE not in logs["state"].to_pylist():
        return f"{none}: all are in quarantine, and quarantine.parquet has the reason of each"
    if tables["sensors"].num_rows:
        return f"{none} that an error model takes: {state.analysis} marks no value of its findings as the headline"
    return f"{none}: {state.analysis} states none; {_OTHERS}"


def _logs(table: pa.Table) -> dict[str, LogRow]:
    columns = table.select(["log", "path", "start", "temperature"]).to_pydict()
    starts = table["start"].cast(pa.int64()).to_pylist()
    rows = zip(columns["log"], columns["path"], starts, columns["temperature"], strict=True)
    return {key: LogRow(key, path, start, warm) for key, path, start, warm in rows if key is not None}


def _quarantine(table: pa.Table) -> Iterator[Worthless]:
    for row in table.to_pylist():
        who = row["serial"] or row["vehicle"] or ""
        yield Worthless(row["path"], who, row["kind"], f"{row['stage']}: {row['message']}")


def _doubtful(table: pa.Table, logs: Mapping[str, LogRow]) -> Iterator[Worthless]:
    """Yield the logs of which no value is trusted."""
    taken = table.filter(compute.fill_null(table["headline"], fill_value=True))
    sound = compute.fill_null(compute.not_equal(taken["verdict"], SUSPICIOUS), fill_value=True)
    by_log = pa.table({"log": taken["log"], "sound": sound}).group_by("log").aggregate([("sound", "any")])
    keys = by_log.filter(compute.invert(by_log["sound_any"]))["log"]
    rows = taken.filter(compute.is_in(taken["log"], value_set=keys.combine_chunks()))
    for row in {
        row["log"]: row for row in reversed(rows.select(["log", "serial", "vehicle", "remarks"]).to_pylist())
    }.values():
        path = logs[row["log"]].path if row["log"] in logs else str(row["log"])
        yield Worthless(path, row["serial"] or row["vehicle"] or "", SUSPICIOUS, row["remarks"] or "")


def _findings(groups: Sequence[Group], judgement: Judgement) -> Iterator[Finding]:
    for place, group in enumerate(groups):
        own = judgement.families[str(place)]
        for one in own.outside:
            at = int(np.flatnonzero(own.sensors.sensor == one.sensor)[0])
            away = member_mean(own, at, judgement.level).shifted(-own.mean.value)
            rows = np.flatnonzero((own.rows.sensor == one.sensor) & own.kept)
            typical = rows[int(np.abs(own.rows.y[rows] - own.sensors.mean[at]).argmin())]
            yield Finding(
                group.sensors[one.sensor], OUTSIDE, place, one.sensor, one.score, one.probability, away, (group.logs[typical],)
            )  # fmt: skip
        for one in own.below:
            rows = np.flatnonzero(group.limited.sensor == one.sensor)
            lowest = rows[int(group.limited.upper[rows].argmin())]
            away = float(group.limited.upper[lowest]) - own.mean.value
            yield Finding(
                group.named[one.sensor], OUTSIDE, place, one.sensor, one.score, one.probability, Estimate(away, -math.inf, away),
                (group.limited_logs[lowest],)
            )  # fmt: skip
        for one in own.changes:
            logs = tuple(dict.fromkeys(group.logs[row] for row in one.rows))
            yield Finding(
                group.sensors[one.sensor], KINDS[one.kind], place, one.sensor, one.score, one.probability, one.size, logs
            )  # fmt: skip


def member_mean(judged: Judged, place: int, level: float) -> Estimate:
    """Return the mean of one sensor over its logs, on the scale of its group; of one that drifts or steps, as its logs scatter."""
    mean, sigma = float(judged.sensors.mean[place]), float(judged.sensors.variance[place]) ** 0.5
    freedom, sensor = MANY, judged.sensors.sensor[place]
    if any(one.sensor == sensor and one.kind != "log" for one in judged.changes):
        own = judged.rows.y[(judged.rows.sensor == sensor) & judged.kept]
        freedom, sigma = own.size - 1.0, float(own.std(ddof=1)) / own.size**0.5
    reach = student_limit(level, freedom) * sigma
    return Estimate(mean, mean - reach, mean + reach, sigma)


def in_si(group: Group, estimate: Estimate) -> Coefficient:
    """Return an estimate on the scale of a group in SI."""
    value, lower, upper = (end_in_si(group, end) for end in (estimate.value, estimate.lower, estimate.upper))
    return Coefficient(value, lower, upper, group.unit)


def end_in_si(group: Group, end: float) -> float:
    """Return a number on the scale of a group in SI; infinity where that is no number any more: far limits of a few sensors."""
    if not group.observations.logarithmic:
        return end
    return math.exp(end) if end < MOST_EXPONENT else math.inf
