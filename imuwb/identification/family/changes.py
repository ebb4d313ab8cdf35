"""What changes from log to log of one sensor: a trend, a step at some time, or a single log that differs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.identification.family.maximum import COARSE, largest_tail
from imuwb.identification.family.observations import Observations
from imuwb.identification.family.scores import Errors, freedom, score
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import normal_tails, student_limit

Kind = Literal["trend", "step", "log"]
FEWEST_FOR_TREND = 3  #: logs; of two, a trend and a step are one contrast
BETTER = 4.0  #: by which the square of a step's score must exceed that of the trend: the place of a step is chosen
FEWEST_OTHERS = 3  #: logs from which one log is said to differ; beside fewer, it is a step


@dataclass(frozen=True, slots=True)
class Change:
    """The most improbable change of one sensor, on the scale of its family."""

    sensor: int
    kind: Kind
    score: float  #: standard normal value that is as improbable
    probability: float  #: that chance makes the largest change of this sensor so large
    size: Estimate  #: of a trend over all logs; of a step; of a log against the sensor's others
    rows: tuple[
        int, int
    ]  #: of a trend the first and last log, of a step the logs before and after it, of a log that log twice


@dataclass(frozen=True, eq=False, slots=True)
class _Logs:
    """The m logs of each of g sensors, in the order of time."""

    rows: Integers  #: (g, m) in the family
    time: Floats  #: (g, m) s from the first
    y: Floats
    a: Floats  #: (g, m) inverse variances
    half: Floats  #: (g, m) half of the degrees of freedom

    @property
    def splits(self) -> Booleans:
        """Return between which logs time passes, (g, m - 1)."""
        return np.diff(self.time, axis=1) > 0


@dataclass(frozen=True, eq=False, slots=True)
class _Contrasts:
    """Contrasts of the logs of g sensors: k of each."""

    size: Floats  #: (g, k)
    variance: Floats  #: (g, k)
    shared: Floats  #: (g, k) sum of the squared weights, by which the variance from log to log counts
    there: Booleans  #: (g, k) whether the sensor has this contrast


def changes(rows: Observations, within: float, error: float, level: float, tested: Booleans) -> list[Change]:
    """Return the most improbable change of each sensor that has logs of two or more times.

    Each sensor has one maximum statistic: over the trend, over all splits of its logs in time, and over its single logs.

    Args:
        rows: of the family.
        within: variance from log to log.
        error: sampling variance of ``within``.
        level: of the intervals of the sizes.
        tested: (n,) rows that are tested; the others are not looked at.
    """
    places = np.flatnonzero(tested & np.isfinite(rows.time))
    places = places[np.lexsort((rows.time[places], rows.sensor[places]))]
    _, first, count = np.unique(rows.sensor[places], return_index=True, return_counts=True)
    found: list[Change] = []
    for logs in np.unique(count[count > 1]):
        table = places[first[count == logs][:, None] + np.arange(logs)]
        table = table[rows.time[table[:, -1]] > rows.time[table[:, 0]]]
        if table.size:
            time = rows.time[table] - rows.time[table[:, :1]]
            own = _Logs(table, time, rows.y[table], 1 / (rows.variance[table] + within), rows.half[table])
            found += _largest(own, rows.sensor[table[:, 0]], error, level)
    return sorted(found, key=lambda change: change.sensor)


def _largest(logs: _Logs, sensors: Integers, error: float, level: float) -> list[Change]:
    """Return the largest change of each sensor."""
    parts: dict[Kind, _Contrasts] = {"step": _splits(logs), "trend": _trend(logs), "log": _single(logs)}
    kinds: list[tuple[Kind, int]] = [
        (kind, place) for kind, part in parts.items() for place in range(part.size.shape[1])
    ]
    whole = _Contrasts(*(
        np.concatenate([getattr(part, name) for part in parts.values()], axis=1)
        for name in ("size", "variance", "shared", "there")
    ))  # fmt: skip
    size = np.where(whole.there, whole.size, 0.0)
    scores = score(size, whole.variance, whole.shared**2 * error, lambda far: _errors(logs, kinds, *np.nonzero(far)))
    freedoms = freedom(whole.variance, whole.shared**2 * error)
    found: list[Change] = []
    trend, others = parts["step"].size.shape[1], parts["log"].size.shape[1]
    for i, largest in enumerate(np.abs(scores).argmax(axis=1)):
        limit = abs(float(scores[i, largest]))
        chance = _chance(logs, i, limit, int(whole.there[i].sum()) - others) + others * float(normal_tails(limit))
        like = kinds[largest][0] == "step" and float(scores[i, trend]) ** 2 > limit**2 - BETTER
        best = trend if like else int(largest)
        value, size, sigma = float(scores[i, best]), float(whole.size[i, best]), float(whole.variance[i, best]) ** 0.5
        reach = sigma * student_limit(level, float(freedoms[i, best]))
        kind, sign, pair = _named(logs, *kinds[best])
        ends = size * sign - reach, size * sign + reach
        change = Change(int(sensors[i]), kind, sign * value, min(chance, 1.0), Estimate(size * sign, *ends, sigma),
                        (int(logs.rows[i, pair[0]]), int(logs.rows[i, pair[1]])))  # fmt: skip
        found.append(change)
    return found


def _errors(logs: _Logs, kinds: Sequence[tuple[Kind, int]], sensors: Integers, places: Integers) -> Errors:
    """Return the errors of the logs in some contrasts: each of a sensor, and at a place of ``kinds``."""
    kind, at = (
        np.array([name for name, _ in kinds])[places][:, None],
        np.array([one for _, one in kinds])[places][:, None],
    )
    a, log = logs.a[sensors], np.arange(logs.a.shape[1])
    own = np.where(kind == "log", log == at + 1, log > at)
    after, before = (part / part.sum(axis=1, keepdims=True) for part in (a * own, a * ~own))
    weight = np.where(kind == "trend", _along(logs)[sensors], after - before)
    return Errors(weight.ravel(), logs.half[sensors].ravel(), np.repeat(np.arange(sensors.size), log.size))


def _named(logs: _Logs, kind: Kind, place: int) -> tuple[Kind, int, tuple[int, int]]:
    """Return a contrast as a change: its kind, its sign, and its logs; a split that leaves one log on a side is that log."""
    last = logs.rows.shape[1] - 1
    if kind == "trend":
        return kind, 1, (0, last)
    if kind == "log":
        return kind, 1, (place + 1, place + 1)
    if last >= FEWEST_OTHERS and place == 0:
        return "log", -1, (0, 0)
    if last >= FEWEST_OTHERS and place == last - 1:
        return "log", 1, (last, last)
    return kind, 1, (place, place + 1)


def _chance(logs: _Logs, place: int, limit: float, count: int) -> float:
    """Return the probability that the trend or a split of one sensor exceeds a limit by chance."""
    if count * float(normal_tails(limit)) > COARSE:
        return 1.0
    a, at = logs.a[place], np.flatnonzero(logs.splits[place])
    whole, w = float(a.sum()), np.cumsum(a)[at]
    tree = np.sqrt(w[:-1] * (whole - w[1:]) / (w[1:] * (whole - w[:-1])))
    if count > at.size:  # the trend hangs on the split that is most like it
        away = logs.time[place] - np.average(logs.time[place], weights=a)
        along = np.cumsum(a * away)[at] * np.sqrt((1 / w + 1 / (whole - w)) / float(a @ away**2))
        tree = np.append(tree, np.abs(along).max())
    return largest_tail(limit, count, tree)


def _splits(logs: _Logs) -> _Contrasts:
    """Return the mean after each split in time less that before it."""

    def parts(values: Floats) -> tuple[Floats, Floats]:
        before = np.cumsum(values, axis=1)[:, :-1]
        return before, values.sum(axis=1, keepdims=True) - before

    a = logs.a
    (w, u), (wy, uy), (ws, us) = map(parts, (a, a * logs.y, a**2))
    return _Contrasts(uy / u - wy / w, 1 / w + 1 / u, ws / w**2 + us / u**2, logs.splits)


def _trend(logs: _Logs) -> _Contrasts:
    """Return the change of the least-squares line over all logs."""
    weight = _along(logs)
    size, variance, shared = (
        part.sum(axis=1, keepdims=True) for part in (weight * logs.y, weight**2 / logs.a, weight**2)
    )
    return _Contrasts(size, variance, shared, logs.splits.sum(axis=1, keepdims=True) >= FEWEST_FOR_TREND - 1)


def _along(logs: _Logs) -> Floats:
    """Return the weights of the logs in the change of a line, (g, m)."""
    a = logs.a
    mean = (a * logs.time).sum(axis=1, keepdims=True) / a.sum(axis=1, keepdims=True)
    away = (logs.time - mean) / logs.time[:, -1:]
    return a * away / (a * away**2).sum(axis=1, keepdims=True)


def _single(logs: _Logs) -> _Contrasts:
    """Return each log but the first and the last, which are splits too, less the mean of all others."""
    a = logs.a

    def others(values: Floats) -> Floats:
        return (values.sum(axis=1, keepdims=True) - values)[:, 1:-1]

    u, own = others(a), logs.y[:, 1:-1]
    return _Contrasts(
        own - others(a * logs.y) / u,
        1 / a[:, 1:-1] + 1 / u,
        1 + others(a**2) / u**2,
        np.ones(own.shape, dtype=bool),
    )
