"""The comparison of several logs of one sensor: coefficients that differ, and the bias from turn-on to turn-on.

Hassaballa, 5: three runs, figures 6 to 8.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.analysis import Finding
from imuwb.arrays import Floats
from imuwb.errors import MissingDataError, UsageError
from imuwb.identification.coefficient import interval
from imuwb.log import SECOND, Log
from imuwb.statistics import UNKNOWN, Coefficient
from imuwb.statistics.distributions import (
    chi_square_limits,
    chi_square_quantile,
    chi_square_tail,
    normal_limit,
    normal_quantile,
)
from imuwb.units import coefficient_units

DIFFERENT = 0.01  #: probability, over all coefficients, below which the logs differ
FEWEST = 2  #: fewest logs with an interval or a limit of a coefficient, for a comparison
LETTERS = "QNBK"


@dataclass(frozen=True, slots=True)
class Compared:
    """One coefficient of one axis in all logs. SI."""

    logs: tuple[Coefficient, ...]  #: the coefficient in each log
    mean: Coefficient  #: root mean square, weighted by duration
    statistic: float | None  #: chi-square of the differences of squares
    probability: float | None  #: probability that chance makes differences as large


@dataclass(frozen=True, slots=True)
class TurnOn:
    """The mean of an axis from log to log. SI."""

    means: tuple[float, ...]  #: mean of each log
    #: standard deviation from log to log; a limit if the noise within the logs explains the scatter of the means
    sigma: Coefficient


@dataclass(frozen=True, eq=False, slots=True, repr=False)
class Repeatability:
    """The comparison of several logs."""

    level: float
    names: tuple[str, ...]
    coefficients: dict[str, dict[str, Compared]]  #: axis -> letter -> comparison
    turn_on: dict[str, TurnOn]
    differ: tuple[str, ...]  #: coefficients that differ, such as "gyro_x N", at 1 % over all coefficients (Holm)

    def __repr__(self) -> str:
        """Return what differs, and the turn-on bias of each axis."""
        differ = f"differ in {', '.join(self.differ)}" if self.differ else "do not differ"
        biases = ", ".join(f"{axis} {t.sigma}" for axis, t in self.turn_on.items())
        return f"{len(self.names)} logs {differ}; turn-on bias: {biases}"


def compare(logs: Sequence[Log], findings: Sequence[Sequence[Finding]], level: float) -> Repeatability:
    """Return the comparison of logs of one sensor.

    Raises:
        MissingDataError: the logs have no axis in common.
        UsageError: a log is given twice.
    """
    hashes = [log.provenance.hash for log in logs]
    if len(set(hashes)) < len(hashes):
        raise UsageError(
            f"{', '.join(log.provenance.path for log in logs)}: one log is given twice; give each log once"
        )
    headlines = [{f.axis: f.coefficients for f in own if f.headline} for own in findings]
    common = [axis for axis in headlines[0] if all(axis in h for h in headlines)]
    if not common:
        raise MissingDataError(
            f"{', '.join(log.provenance.path for log in logs)}: no axis is in all logs, so nothing can be compared; give logs of one sensor"
        )
    coefficients = {
        axis: {
            letter: _compared(axis, letter, [h[axis][letter] for h in headlines], _durations(logs, axis), level)
            for letter in LETTERS
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


def _compared(axis: str, letter: str, estimates: Sequence[Coefficient], duration: Floats, level: float) -> Compared:
    """Compare the squares, whose errors are about symmetric even where a log does not show the term and has only a limit."""
    unit = coefficient_units(axis, letter)[0].name
    logs = tuple(c.in_unit(unit) for c in estimates)
    known = [_square(c, level) for c in estimates]
    sure = [(square, sigma, t) for (square, sigma), t in zip(known, duration, strict=True) if 0 < sigma < np.inf]
    if len(sure) < FEWEST:  # one log alone is not compared
        alone = next((c for c in logs if np.isfinite(c.upper)), UNKNOWN.in_unit(unit))
        return Compared(logs, alone, None, None)
    squares, sigmas, weight = np.array(sure).T
    best = float(squares @ sigmas**-2 / np.sum(sigmas**-2))
    statistic = float(np.sum(((squares - best) / sigmas) ** 2))
    probability = float(chi_square_tail(statistic, squares.size - 1))
    # Weights by the estimated errors would favour small estimates, whose errors are small too.
    weight = weight / weight.sum()
    square, sigma = float(weight @ squares), float(np.sqrt(weight**2 @ sigmas**2))
    if square <= 0:
        limit = (normal_quantile(level) * sigma) ** 0.5
        return Compared(logs, Coefficient(None, None, limit, unit), statistic, probability)
    mean = Coefficient(square**0.5, *interval(square, sigma, level), unit)
    return Compared(logs, mean, statistic, probability)


def _square(c: Coefficient, level: float) -> tuple[float, float]:
    """Return an estimate's square, and the standard error from its interval or limit; infinite without either."""
    if not np.isfinite(c.upper):
        return 0.0, float("inf")
    if c.value is None:
        return 0.0, c.upper**2 / normal_quantile(level)
    if not c.lower:
        return c.value**2, (c.upper**2 - c.value**2) / normal_limit(level)
    return c.value**2, (c.upper**2 - c.lower**2) / (2 * normal_limit(level))


def _differ(coefficients: dict[str, dict[str, Compared]]) -> tuple[str, ...]:
    """Return the coefficients that differ, by Holm's method: the smallest of n probabilities times n, the next times n - 1, ..."""
    tested = sorted(
        (c.probability, f"{axis} {letter}")
        for axis, row in coefficients.items()
        for letter, c in row.items()
        if c.probability is not None
    )
    differ: list[str] = []
    for i, (probability, name) in enumerate(tested):
        if probability * (len(tested) - i) > DIFFERENT:
            break
        differ.append(name)
    return tuple(differ)


def _mean(log: Log, axis: str, coefficients: Mapping[str, Coefficient]) -> tuple[float, float]:
    """Return the mean of an axis, and its variance from the noise within the log.

    The mean over a time T of white noise has the variance N²/T, that of a random walk from 0 has K² T/3.
    """
    time, values = log.imu().axes()[axis]
    duration = float(time[-1] - time[0]) / SECOND
    n, b, k = (coefficients[x].value or 0.0 for x in "NBK")
    return float(values.mean()), n**2 / duration + 2 * np.log(2) / np.pi * b**2 + k**2 * duration / 3


def _turn_on(axis: str, logs: list[tuple[float, float]], level: float) -> TurnOn:
    means = tuple(mean for mean, _ in logs)
    n = len(means)
    square, noise = float(np.var(means, ddof=1)), float(np.mean([variance for _, variance in logs]))
    unit = coefficient_units(axis, "rate")[0].name
    lower, upper = (square * factor - noise for factor in chi_square_limits(level, n - 1))
    if lower <= 0:  # the noise within the logs explains the scatter
        limit = (n - 1) * square / float(chi_square_quantile(1 - level, n - 1))
        return TurnOn(means, Coefficient(None, None, max(limit, noise) ** 0.5, unit))
    return TurnOn(means, Coefficient(max(square - noise, lower) ** 0.5, lower**0.5, upper**0.5, unit))
