"""Several logs of one sensor: do their coefficients differ, and how much does the bias change from turn-on to turn-on?

Hassaballa, 5: three runs, figures 6 to 8.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.analysis import Curve, Figure, Table
from imuwb.colors import AXIS_COLORS
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.coefficient import interval
from imuwb.log import SECOND
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.statistics.distributions import (
    chi_square_limits,
    chi_square_quantile,
    chi_square_tail,
    normal_limit,
    normal_quantile,
)
from imuwb.texts import coefficient_text
from imuwb.units import coefficient_units

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from imuwb.analysis import Finding, Review
    from imuwb.log import Floats, Log

DIFFERENT = 0.01  #: probability, over all coefficients, below which the logs are said to differ
FEWEST = 2  #: values to compare
LEAST = 0.1  #: of a value, where a bar that reaches down to 0 ends on a logarithmic axis


@dataclass(frozen=True, slots=True)
class Compared:
    """One coefficient of one axis in all logs. SI."""

    logs: tuple[Coefficient, ...]  #: of each log
    mean: Coefficient  #: root mean square, by duration
    statistic: float | None  #: chi-square of the differences of squares
    probability: float | None  #: of differences as large by chance


@dataclass(frozen=True, slots=True)
class TurnOn:
    """How the mean of an axis changes from log to log. SI."""

    means: tuple[float, ...]  #: of each log
    #: standard deviation from log to log; a limit where the means scatter no more than the noise within the logs explains
    sigma: Coefficient


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
        axis: {
            letter: _compared(axis, letter, [h[axis][letter] for h in headlines], _durations(logs, axis), level)
            for letter in "QNBK"
        }
        for axis in common
    }
    turn_on = {
        axis: _turn_on(axis, [_mean(log, axis, h[axis]) for log, h in zip(logs, headlines, strict=True)], level)
        for axis in common
    }
    names = tuple(log.provenance.path.replace("\\", "/").rpartition("/")[2] for log in logs)
    return Repeatability(level, names, coefficients, turn_on, _differ(coefficients))


def _durations(logs: Sequence[Log], axis: str) -> Floats:
    times = [log.imu().axes()[axis][0] for log in logs]
    return np.array([float(time[-1] - time[0]) / SECOND for time in times])


def _compared(axis: str, letter: str, found: Sequence[Coefficient], duration: Floats, level: float) -> Compared:
    """Compare the squares: they scatter about evenly around the truth also where a log shows nothing, and has a limit alone."""
    unit = coefficient_units(axis, letter)[0].name
    logs = tuple(c.in_unit(unit) for c in found)
    known = [_square(c, level) for c in found]
    sure = [(square, sigma, t) for (square, sigma), t in zip(known, duration, strict=True) if 0 < sigma < np.inf]
    if len(sure) < FEWEST:  # what one log alone says stands
        alone = next((c for c in logs if np.isfinite(c.upper)), UNKNOWN.in_unit(unit))
        return Compared(logs, alone, None, None)
    squares, sigmas, weight = np.array(sure).T
    best = float(squares @ sigmas**-2 / np.sum(sigmas**-2))
    statistic = float(np.sum(((squares - best) / sigmas) ** 2))
    probability = float(chi_square_tail(statistic, squares.size - 1))
    # Weights by an estimate's own error would prefer the small ones, whose errors are small with them.
    weight = weight / weight.sum()
    square, sigma = float(weight @ squares), float(np.sqrt(weight**2 @ sigmas**2))
    if square <= 0:
        limit = (normal_quantile(level) * sigma) ** 0.5
        return Compared(logs, Coefficient(None, None, limit, unit), statistic, probability)
    mean = Coefficient(square**0.5, *interval(square, sigma, level), unit)
    return Compared(logs, mean, statistic, probability)


def _square(c: Coefficient, level: float) -> tuple[float, float]:
    """Return an estimate's square and its standard error, as its interval or limit tells; infinite where neither does."""
    if not np.isfinite(c.upper):
        return 0.0, float("inf")
    if c.value is None:
        return 0.0, c.upper**2 / normal_quantile(level)
    if not c.lower:
        return c.value**2, (c.upper**2 - c.value**2) / normal_limit(level)
    return c.value**2, (c.upper**2 - c.lower**2) / (2 * normal_limit(level))


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


def _mean(log: Log, axis: str, coefficients: Mapping[str, Coefficient]) -> tuple[float, float]:
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
        return TurnOn(means, Coefficient(None, None, max(limit, noise) ** 0.5, unit))
    return TurnOn(means, Coefficient(max(square - noise, lower) ** 0.5, lower**0.5, upper**0.5, unit))


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
            cells = (coefficient_text(one, unit) for one in c.logs)
            test = (
                "—"
                if c.probability is None
                else f"p = {c.probability:.2g}" + (" DIFFER" if f"{axis} {letter}" in found.differ else "")
            )
            rows.append((axis, letter, *cells, coefficient_text(c.mean, unit), test))
    caption = (
        "All logs: root mean square by duration; a log that shows nothing counts with its limit. Test: chi-square of the squares "
        "against their mean."
    )
    review.table(
        Table("Repeatability", ("axis", "term", *found.names, "all logs", "equal?"), tuple(rows), caption, wide=True)
    )
    for figure in _figures(found):
        review.figure(figure)
    turns: list[tuple[str, ...]] = []
    for axis, t in found.turn_on.items():
        unit = coefficient_units(axis, "rate")[1]
        means = (f"{unit.from_si(m):.6g} {unit.name}" for m in t.means)
        turns.append((axis, *means, coefficient_text(t.sigma, unit)))
    caption = "Mean of each log, and how the means scatter beyond the noise within the logs: the turn-on bias's sigma, which goes into the model; < is a limit. An accelerometer must not have been moved."
    review.table(Table("Turn-on bias", ("axis", *found.names, "sigma"), tuple(turns), caption))


def _figures(found: Repeatability) -> Iterator[Figure]:
    """Yield N and B of each axis from log to log, with their intervals; a limit is the end of a bar alone."""
    for sensor, title in (("gyro", "Gyroscopes"), ("accel", "Accelerometers")):
        axes = [axis for axis in found.coefficients if axis.startswith(sensor)]
        for letter, name in (("N", "random walk N"), ("B", "bias instability B")):
            curves = tuple(_curve(found, axis, letter, i) for i, axis in enumerate(axes))
            if any(np.isfinite(curve.y).any() for curve in curves):
                unit = coefficient_units(axes[0], letter)[1].name
                logs = ", ".join(f"{i}: {name}" for i, name in enumerate(found.names, 1))
                yield Figure(
                    f"{title}: {name} from log to log", f"log [1]; {logs}", f"{name} [{unit}]", curves, x_scale="linear",
                    x_limits=(0.5, len(found.names) + 0.5),
                )  # fmt: skip


def _curve(found: Repeatability, axis: str, letter: str, place: int) -> Curve:
    compared, unit = found.coefficients[axis][letter], coefficient_units(axis, letter)[1]

    def shown(values: Sequence[float | None]) -> Floats:
        return np.array([np.nan if v is None else unit.from_si(v) for v in values])

    x = np.arange(1.0, len(found.names) + 1) + 0.08 * (place - 1)  # side by side
    y = shown([c.value for c in compared.logs])
    return Curve(
        axis.replace("_", " "),
        x,
        y,
        AXIS_COLORS[axis[-1]],
        np.fmax(shown([c.lower for c in compared.logs]), y * LEAST),
        shown([c.upper for c in compared.logs]),
    )
