"""Several logs of one sensor: do their coefficients differ, and how much does the bias change from turn-on to turn-on?

Hassaballa, 5: three runs, figures 6 to 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Table, estimate_text
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.distributions import chi_square_limits, chi_square_quantile, chi_square_tail, normal_limit
from imuwb.log import SECOND
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from imuwb.analysis import AnyCoefficient, Finding, Review
    from imuwb.log import Log

DIFFERENT = 0.01  #: probability, over all coefficients, below which the logs are said to differ
FEWEST = 2  #: values to compare


@dataclass(frozen=True, slots=True)
class Compared:
    """One coefficient of one axis in all logs. SI."""

    values: tuple[float | None, ...]
    lower: tuple[float | None, ...]
    upper: tuple[float | None, ...]
    mean: float | None  #: weighted
    mean_interval: tuple[float, float] | None
    statistic: float | None  #: chi-square of the differences of logarithms
    probability: float | None  #: of differences as large by chance
    unit: str


@dataclass(frozen=True, slots=True)
class TurnOn:
    """How the mean of an axis changes from log to log. SI."""

    means: tuple[float, ...]
    value: float | None  #: sigma; None where the means scatter no more than the noise within the logs makes them
    lower: float | None
    upper: float  #: or the limit
    unit: str


@dataclass(frozen=True, eq=False, slots=True)
class Repeatability:
    """The comparison of several logs."""

    level: float
    names: tuple[str, ...]
    coefficients: dict[str, dict[str, Compared]]  #: axis -> letter ->
    turn_on: dict[str, TurnOn]
    differ: tuple[str, ...]  #: coefficients that differ, "gyro_x N", at 1 % over all (Holm)


def compare(logs: Sequence[Log], findings: Sequence[Sequence[Finding]], level: float) -> Repeatability:
    """Return the comparison of logs of one sensor.

    Raises:
        MissingDataError: they have no axis in common.
        UsageError: a log is given twice.
    """
    hashes = [log.provenance.hash for log in logs]
    if len(set(hashes)) < len(hashes):
        message = f"{', '.join(log.provenance.path for log in logs)}: the same log is given twice; it cannot be compared with itself"
        raise UsageError(message)
    headlines = [{f.axis: f.coefficients for f in found if f.headline} for found in findings]
    common = [axis for axis in headlines[0] if all(axis in h for h in headlines)]
    if not common:
        message = f"{', '.join(log.provenance.path for log in logs)}: no axis is in all of them, so there is nothing to compare"
        raise MissingDataError(message)
    coefficients = {
        axis: {letter: _compared(axis, letter, [h[axis][letter] for h in headlines], level) for letter in "QNBK"}
        for axis in common
    }
    turn_on = {
        axis: _turn_on(axis, [_mean(log, axis, h[axis]) for log, h in zip(logs, headlines, strict=True)], level)
        for axis in common
    }
    names = tuple(log.provenance.path.replace("\\", "/").rpartition("/")[2] for log in logs)
    return Repeatability(level, names, coefficients, turn_on, _differ(coefficients))


def _compared(axis: str, letter: str, found: Sequence[AnyCoefficient], level: float) -> Compared:
    unit = coefficient_units(axis, letter)[0].name
    values, lower, upper = tuple(c.value for c in found), tuple(c.lower for c in found), tuple(c.upper for c in found)
    sure = [(c.value, c.lower, c.upper) for c in found if c.value and c.lower and c.upper]
    if len(sure) < FEWEST:
        return Compared(values, lower, upper, None, None, None, None, unit)
    # Of a size, the logarithm scatters evenly; its standard error is what the interval spans.
    z = normal_limit(level)
    logs = np.array([np.log(v) for v, _, _ in sure])
    sigma = np.array([np.log(u / low) / (2 * z) for _, low, u in sure])
    weight = 1 / sigma**2
    mean = float(weight @ logs / weight.sum())
    statistic = float(weight @ (logs - mean) ** 2)
    half = z / float(weight.sum()) ** 0.5
    ends = float(np.exp(mean - half)), float(np.exp(mean + half))
    return Compared(
        values,
        lower,
        upper,
        float(np.exp(mean)),
        ends,
        statistic,
        float(chi_square_tail(statistic, logs.size - 1)),
        unit,
    )


def _differ(coefficients: dict[str, dict[str, Compared]]) -> tuple[str, ...]:
    """Return what differs by Holm's method: the smallest probability against all, the next against all but one, ..."""
    tested = sorted(
        (c.probability, f"{axis} {letter}")
        for axis, row in coefficients.items()
        for letter, c in row.items()
        if c.probability is not None
    )
    found: list[str] = []
    for i, (probability, name) in enumerate(tested):
        if probability * (len(tested) - i) > DIFFERENT:
            break
        found.append(name)
    return tuple(found)


def _mean(log: Log, axis: str, coefficients: Mapping[str, AnyCoefficient]) -> tuple[float, float]:
    """Return the mean of an axis, and the variance that the noise within the log gives it."""
    time, values = log.imu().axes()[axis]
    duration = float(time[-1] - time[0]) / SECOND
    n, b, k = (coefficients[x].value or 0.0 for x in "NBK")
    return float(values.mean()), n**2 / duration + 2 * np.log(2) / np.pi * b**2 + k**2 * duration / 3


def _turn_on(axis: str, found: list[tuple[float, float]], level: float) -> TurnOn:
    means = tuple(mean for mean, _ in found)
    n = len(means)
    square, noise = float(np.var(means, ddof=1)), float(np.mean([variance for _, variance in found]))
    unit = coefficient_units(axis, "rate")[0].name
    lower, upper = (square * factor - noise for factor in chi_square_limits(level, n - 1))
    if lower <= 0:  # the noise within the logs explains it
        limit = (n - 1) * square / float(chi_square_quantile(1 - level, n - 1))
        return TurnOn(means, None, None, max(limit, noise) ** 0.5, unit)
    return TurnOn(means, max(square - noise, lower) ** 0.5, lower**0.5, upper**0.5, unit)


def draw(found: Repeatability, review: Review) -> None:
    """Show coefficients side by side, and the turn-on bias."""
    review.note(
        f"{len(found.names)} logs differ in {', '.join(found.differ)} (1 % over all comparisons)"
        if found.differ
        else f"{len(found.names)} logs: no coefficient differs by more than chance (1 % over all comparisons)"
    )
    rows: list[tuple[str, ...]] = []
    for axis, row in found.coefficients.items():
        for letter, c in row.items():
            unit = coefficient_units(axis, letter)[1]
            cells = (estimate_text(_One(*one), unit) for one in zip(c.values, c.lower, c.upper, strict=True))
            mean = (
                "—"
                if c.mean is None or c.mean_interval is None
                else estimate_text(_One(c.mean, *c.mean_interval), unit)
            )
            test = (
                "—"
                if c.probability is None
                else f"p = {c.probability:.2g}" + (" DIFFER" if f"{axis} {letter}" in found.differ else "")
            )
            rows.append((axis, letter, *cells, mean, test))
    caption = "Test: chi-square of the logarithms against their weighted mean; where fewer than two logs show a term, there is none."
    review.table(
        Table(
            "Repeatability", ("axis", "term", *found.names, "weighted mean", "equal?"), tuple(rows), caption, wide=True
        )
    )
    turns: list[tuple[str, ...]] = []
    for axis, t in found.turn_on.items():
        unit = coefficient_units(axis, "rate")[1]
        means = (f"{unit.from_si(m):.6g} {unit.name}" for m in t.means)
        turns.append((axis, *means, estimate_text(t, unit)))
    caption = "Mean of each log, and how the means scatter beyond the noise within the logs: the turn-on bias's sigma, which goes into the model; < is a limit. An accelerometer must not have been moved."
    review.table(Table("Turn-on bias", ("axis", *found.names, "sigma"), tuple(turns), caption))


@dataclass(frozen=True, slots=True)
class _One:
    value: float | None
    lower: float | None
    upper: float | None
