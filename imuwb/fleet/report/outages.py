"""Outages of a fleet as groups: how far each filter drifts in each vehicle, and how large its errors are against its own sigma."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from imuwb.arrays import Floats, Integers
from imuwb.fleet.report.groups import (
    LEVEL,
    UNKNOWN_SENSOR,
    Group,
    codes,
    parts,
    seconds,
)
from imuwb.identification.family import Limits, observations
from imuwb.replay.scoring.overlap import effective_count
from imuwb.statistics.distributions import chi_square_limits, normal_limit

compute: Any = pc
DRIFT, RATIO = "drift", "error over sigma"
LEAST = 1e-3  #: m, added to errors before their logarithm
FEWEST = 2  #: outages in all logs beyond one of each, for the scatter within a log


def outage_groups(table: pa.Table) -> tuple[Group, ...]:
    """Return two groups for each filter and duration: the geometric mean of the errors at the end in each log, and its errors over sigma.

    Outages of one log overlap: its mean has the variance of one outage, common to the fleet, over the number that do not overlap.

    Args:
        table: with the columns of ``imuwb.fleet.schemas.OUTAGES``.
    """
    if not table.num_rows:
        return ()
    who, names = codes(compute.coalesce(table["vehicle"], table["serial"]))
    log, keys = codes(table["log"])
    duration = compute.round(table["outage_duration"], 3).cast(pa.string())
    kinds = [codes(column) for column in (compute.fill_null(table["family"], ""), table["filter"], duration)]
    found: list[Group] = []
    for (kind, source, length), rows in parts(kinds):
        own = table.take(pa.array(rows))
        logs = _Logs(own, log[rows], who[rows], float(length))
        found += _groups(kind or "vehicles", f"{source}, {float(length):g} s", logs, names, keys)
    return tuple(found)


class _Logs:
    """The outages of one filter and one duration, log by log."""

    def __init__(self, table: pa.Table, log: Integers, who: Integers, duration: float) -> None:
        end, nees, start = (np.asarray(table[name].to_numpy(), float) for name in ("end", "nees", "outage_start"))
        sound = np.isfinite(end) & (who >= 0)
        self.unknown = int((who < 0).sum())
        self.log, place, inverse = np.unique(log[sound], return_index=True, return_inverse=True)
        self.who: Integers = who[sound][place]
        self.time: Floats = seconds(table["start"])[sound][place]
        self.temperature: Floats = np.asarray(table["temperature"].to_numpy(), float)[sound][place]
        self.effective = np.array([
            max(effective_count(start[sound][inverse == i], duration), 1) for i in range(self.log.size)
        ])  # fmt: skip
        self.error, self.nees, self.inverse = np.log(np.maximum(end[sound], 0) + LEAST), nees[sound], inverse


def _groups(kind: str, source: str, logs: _Logs, names: list[str], keys: list[str]) -> Iterator[Group]:
    count = np.bincount(logs.inverse, minlength=logs.log.size)
    if not logs.log.size:
        return
    mean = np.bincount(logs.inverse, logs.error) / count
    rest = logs.error.size - logs.log.size
    if rest >= FEWEST:
        variance = float(((logs.error - mean[logs.inverse]) ** 2).sum()) / rest
        reach = normal_limit(LEVEL) * np.sqrt(variance / logs.effective)
        value = np.exp(mean)
        yield _made(
            (kind, source, DRIFT, "m"),
            logs,
            np.ones(logs.log.size, bool),
            (value, value * np.exp(-reach), value * np.exp(reach)),
            names,
            keys,
        )
    known = np.isfinite(logs.nees)
    there = np.bincount(logs.inverse[known], minlength=logs.log.size) == count
    if there.any():
        nees = np.bincount(logs.inverse, np.where(known, logs.nees, 0.0)) / count / 2
        low, high = chi_square_limits(LEVEL, 2.0 * logs.effective)
        ratio = np.sqrt(np.maximum(nees, np.finfo(float).tiny))
        ends = (ratio, ratio * np.sqrt(low), ratio * np.sqrt(high))
        yield _made((kind, source, RATIO, "1"), logs, there & (nees > 0), ends, names, keys)


def _made(
    key: tuple[str, str, str, str], logs: _Logs, rows: np.ndarray, ends: tuple[Floats, Floats, Floats], names: list[str],
    keys: list[str],
) -> Group:  # fmt: skip
    kind, source, what, si = key
    value, lower, upper = (part[rows] for part in ends)
    used, number = np.unique(logs.who[rows], return_inverse=True)
    own = observations(
        number.astype(np.int64), value, lower, upper, level=LEVEL, time=logs.time[rows], temperature=logs.temperature[rows],
        squares=what == RATIO,
    )  # fmt: skip
    left_out = {UNKNOWN_SENSOR: logs.unknown} if logs.unknown else {}
    return Group(
        kind, source, "", what, si, tuple(names[i] for i in used), tuple(keys[i] for i in logs.log[rows]), own, value, lower, upper, Limits.none(),
        (), np.zeros(0), (), {}, left_out,
    )  # fmt: skip
