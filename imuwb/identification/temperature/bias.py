"""The bias at each temperature, its uncertainty, and its hysteresis.

Flicker and random walk also change the bias of a sensor between two records. Such a change is not thermal. So means are compared
by the variance of their differences, which grows with the time between them. A slow process that is not identified counts with
its upper limit. The turn-on bias is estimated only from several logs at one temperature.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from imuwb.arrays import Floats
from imuwb.identification.likelihood.fit import TERMS
from imuwb.statistics import Coefficient, Estimate
from imuwb.statistics.distributions import normal_limit
from imuwb.stochastic import FlickerNoise, RandomWalk, Sum, WhiteNoise

EVIDENT = 2.58  #: standard errors, from which a hysteresis is more than chance
SLOW = ("B", "K")  #: processes that change the bias between records


@dataclass(frozen=True, slots=True)
class RecordMean:
    """The mean of one record."""

    celsius: float
    value: float
    middle: float  #: s, time of the record's middle
    duration: float  #: s
    rising: bool | None  #: whether the temperature came from below; None: not known
    log: int  #: number of the log


@dataclass(frozen=True, slots=True)
class Bias:
    """The bias at one temperature."""

    temperature: float  #: °C
    estimate: Estimate  #: the interval is that of its difference from the mean of all temperatures


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """The bias with rising temperature minus the bias with falling temperature, at one temperature of one log."""

    temperature: float  #: °C
    difference: Estimate


@dataclass(frozen=True, eq=False, slots=True)
class Biases:
    """The biases at k temperatures."""

    at: tuple[Bias, ...]
    differences: Floats  #: (k, k) variances of the differences between temperatures
    hysteresis: tuple[Hysteresis, ...]
    turn_on: float | None  #: standard deviation between logs at one temperature, without noise; None: not known

    def __repr__(self) -> str:
        """Return one line for each temperature."""
        return "\n".join(f"{b.temperature:.4g} °C: {b.estimate}" for b in self.at)

    def heterogeneity(self) -> float | None:
        """Return the chi-square statistic of the test that all biases are equal; None if there is no test.

        It has k - 1 degrees of freedom.
        """
        first = self.differences[0]
        covariance = (first[1:, None] + first[None, 1:] - self.differences[1:, 1:]) / 2  # of differences from the first
        away = np.array([b.estimate.value - self.at[0].estimate.value for b in self.at[1:]])
        if away.size == 0 or not linalg.eigvalsh(covariance)[0] > 0:
            return None
        return float(away @ np.linalg.solve(covariance, away))


def biases(means: Sequence[Sequence[RecordMean]], white: Sequence[float], slow: Sum, level: float = 0.95) -> Biases:
    """Return the bias at each temperature: the mean of its records' means.

    Args:
        means: records of each temperature.
        white: N at each temperature.
        slow: flicker and random walk, common to all temperatures.
        level: confidence level of the intervals.
    """
    records = [m for here in means for m in here]
    duration = float(np.median([m.duration for m in records]))
    own = np.array([n**2 / m.duration for here, n in zip(means, white, strict=True) for m in here])
    walked = np.array([[_walked(a, b, slow, duration) for b in records] for a in records])
    of_records = walked + (own[:, None] + own[None, :]) * ~np.eye(own.size, dtype=bool)
    turn_on = _turn_on_variance(means, records, of_records)
    logs = np.array([m.log for m in records])
    of_records += 2 * (turn_on or 0.0) * (logs[:, None] != logs[None, :])
    # With weights whose sum is 1, variances of differences transform as covariances do.
    share = linalg.block_diag(*(np.full((1, len(here)), 1 / len(here)) for here in means))
    mixed = share @ of_records @ share.T
    within = np.diag(mixed)
    differences = mixed - (within[:, None] + within[None, :]) / 2
    from_mean = differences.mean(axis=1) - differences.mean() / 2
    loops = [_hysteresis(here, n, slow, duration, level) for here, n in zip(means, white, strict=True)]
    hysteresis = tuple(loop for loop in loops if loop is not None)
    values = share @ (np.array([m.value for m in records]) - _half_loop(hysteresis) * _directions(records))
    celsius = share @ np.array([m.celsius for m in records])
    z = normal_limit(level)
    at = tuple(
        Bias(float(t), Estimate(float(v), float(v - z * s), float(v + z * s), float(s)))
        for t, v, s in zip(celsius, values, from_mean.clip(0) ** 0.5, strict=True)
    )
    return Biases(at, differences, hysteresis, None if turn_on is None else turn_on**0.5)


def _half_loop(hysteresis: Sequence[Hysteresis]) -> float:
    """Return half the mean hysteresis, by which a bias that was measured in one direction only is off; 0 if chance explains it."""
    if not hysteresis:
        return 0.0
    weight = np.array([(loop.difference.sigma or 0.0) ** -2 for loop in hysteresis])
    mean = float(weight @ [loop.difference.value for loop in hysteresis] / weight.sum())
    return mean / 2 if abs(mean) > EVIDENT * float(weight.sum()) ** -0.5 else 0.0


def _directions(records: Sequence[RecordMean]) -> Floats:
    """Return 1 for rising, -1 for falling and 0 for unknown directions, (n,)."""
    return np.array([0.0 if m.rising is None else 1.0 if m.rising else -1.0 for m in records])


def difference_variance(processes: Sum, duration: float, apart: float) -> float:
    """Return the variance of the difference of two means.

    Args:
        processes: their white noise, flicker and random walk.
        duration: s, of each record.
        apart: s between the middles of the records, at least ``duration``.
    """
    total = 0.0
    for term in processes.terms:
        if isinstance(term, WhiteNoise):
            total += 2 * term.N**2 / duration
        if isinstance(term, FlickerNoise):  # its generalised autocovariance -ln|t|/pi, averaged over both records
            ends = _integral(apart + duration) - 2 * _integral(apart) + _integral(apart - duration)
            total += 2 * term.B**2 / np.pi * (ends - 2 * _integral(duration)) / duration**2
        if isinstance(term, RandomWalk):
            total += term.K**2 * (apart - duration / 3)
    return float(total)


def _integral(t: float) -> float:
    """Return the second integral of ln|t|."""
    return t**2 / 2 * np.log(t) - 0.75 * t**2 if t > 0 else 0.0


def _walked(a: RecordMean, b: RecordMean, slow: Sum, duration: float) -> float:
    """Return the variance of the difference of two means by slow noise; simultaneous records count as adjacent."""
    return 0.0 if a is b else difference_variance(slow, duration, max(abs(a.middle - b.middle), duration))


def _turn_on_variance(
    means: Sequence[Sequence[RecordMean]], records: Sequence[RecordMean], differences: Floats
) -> float | None:
    """Return the variance between logs at one temperature, without noise; None if no temperature has two logs."""
    place = {id(m): i for i, m in enumerate(records)}
    excess = [
        ((a.value - b.value) ** 2 - differences[place[id(a)], place[id(b)]]) / 2
        for here in means
        for i, a in enumerate(here)
        for b in here[:i]
        if a.log != b.log
    ]
    return max(float(np.mean(excess)), 0.0) if excess else None


def _hysteresis(
    means: Sequence[RecordMean], white: float, slow: Sum, duration: float, level: float
) -> Hysteresis | None:
    """Return the hysteresis at one temperature, from the first log that has both directions; None if no log has."""
    for log in dict.fromkeys(m.log for m in means):
        up = next((m for m in means if m.log == log and m.rising is True), None)
        down = next((m for m in means if m.log == log and m.rising is False), None)
        if up is not None and down is not None:
            variance = white**2 * (1 / up.duration + 1 / down.duration) + _walked(up, down, slow, duration)
            half = normal_limit(level) * variance**0.5
            value = up.value - down.value
            difference = Estimate(value, value - half, value + half, variance**0.5)
            return Hysteresis((up.celsius + down.celsius) / 2, difference)
    return None


def size_of(here: Coefficient, everywhere: Coefficient | None) -> float:
    """Return the size of a coefficient at one temperature: identified there, else common to all, else the smallest limit."""
    for coefficient in (here, everywhere):
        if coefficient is not None and coefficient.value is not None and coefficient.lower:
            return coefficient.value
    return min(coefficient.upper for coefficient in (here, everywhere) if coefficient is not None)


def slow_processes(points: Sequence[Mapping[str, Coefficient]], common: Mapping[str, Coefficient | None]) -> Sum:
    """Return the flicker and random walk that change the bias between temperatures: root mean squares over temperatures.

    Args:
        points: coefficients at each temperature.
        common: coefficients common to all temperatures; None: not known.
    """
    squares = {
        letter: sum(size_of(p[letter], common.get(letter)) ** 2 for p in points) / len(points) for letter in SLOW
    }
    return Sum(tuple(TERMS[letter](square**0.5) for letter, square in squares.items() if square > 0))
