"""Means by temperature, how sure they are, and whether they depend on where the temperature came from.

A sensor's bias walks while its temperature changes: what flicker and random walk make between two records is no thermal bias.
So means are judged by the variance of their differences, which grows with the time between them. A slow process that is not
identified counts with its upper limit. What a turn-on adds is told only by several logs at one temperature.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import linalg

from imuwb.statistics.distributions import normal_limit
from imuwb.stochastic import FlickerNoise, RandomWalk, WhiteNoise

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.stochastic import Sum

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Mean:
    """The mean of one record."""

    celsius: float
    value: float
    middle: float  #: s
    duration: float  #: s
    rising: bool | None
    log: int


@dataclass(frozen=True, slots=True)
class Bias:
    """The bias at one temperature."""

    celsius: float
    value: float
    sigma: float  #: of its difference from the mean of all temperatures


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """The bias after a rise of temperature less that after a fall, at the same temperature of one log."""

    celsius: float
    value: float
    lower: float
    upper: float


@dataclass(frozen=True, eq=False, slots=True)
class Biases:
    """The biases at k temperatures."""

    at: tuple[Bias, ...]
    differences: Floats  #: (k, k) variances of their differences
    hysteresis: tuple[Hysteresis, ...]
    turn_on: float | None  #: standard deviation from log to log at one temperature, beyond noise; None: unknown

    def heterogeneity(self) -> float | None:
        """Return chi-square, of k - 1 degrees of freedom, of the biases against one value; None where errors are 0."""
        first = self.differences[0]
        covariance = (first[1:, None] + first[None, 1:] - self.differences[1:, 1:]) / 2  # of differences from the first
        away = np.array([b.value - self.at[0].value for b in self.at[1:]])
        if away.size == 0 or not linalg.eigvalsh(covariance)[0] > 0:
            return None
        return float(away @ np.linalg.solve(covariance, away))


def biases(means: Sequence[Sequence[Mean]], white: Sequence[float], slow: Sum, level: float = 0.95) -> Biases:
    """Return the bias at each temperature, the mean of its records' means.

    Args:
        means: of each temperature.
        white: N of each temperature.
        slow: flicker and random walk, at all temperatures.
        level: of the intervals of hysteresis.
    """
    records = [m for here in means for m in here]
    duration = float(np.median([m.duration for m in records]))
    own = np.array([n**2 / m.duration for here, n in zip(means, white, strict=True) for m in here])
    walked = np.array([[_walked(a, b, slow, duration) for b in records] for a in records])
    of_records = walked + (own[:, None] + own[None, :]) * ~np.eye(own.size, dtype=bool)
    turn_on = _turn_on_variance(means, records, of_records)
    logs = np.array([m.log for m in records])
    of_records += 2 * (turn_on or 0.0) * (logs[:, None] != logs[None, :])
    # With weights that add up to 1, variances of differences go over as covariances do.
    share = linalg.block_diag(*(np.full((1, len(here)), 1 / len(here)) for here in means))
    mixed = share @ of_records @ share.T
    within = np.diag(mixed)
    differences = mixed - (within[:, None] + within[None, :]) / 2
    from_mean = differences.mean(axis=1) - differences.mean() / 2
    values = share @ np.array([m.value for m in records])
    celsius = share @ np.array([m.celsius for m in records])
    at = tuple(
        Bias(float(t), float(v), float(s) ** 0.5) for t, v, s in zip(celsius, values, from_mean.clip(0), strict=True)
    )
    loops = tuple(
        loop
        for here, n in zip(means, white, strict=True)
        if (loop := _loop(here, n, slow, duration, level)) is not None
    )
    return Biases(at, differences, loops, None if turn_on is None else turn_on**0.5)


def difference_variance(processes: Sum, duration: float, apart: float) -> float:
    """Return the variance of the difference of two means.

    Args:
        processes: white noise, flicker and random walk in it count.
        duration: s, of each.
        apart: s from middle to middle, at least ``duration``.
    """
    total = 0.0
    for term in processes.terms:
        if isinstance(term, WhiteNoise):
            total += 2 * term.N**2 / duration
        if isinstance(term, FlickerNoise):  # of its generalised autocovariance -ln|t|/pi, averaged over both
            ends = _integral(apart + duration) - 2 * _integral(apart) + _integral(apart - duration)
            total += 2 * term.B**2 / np.pi * (ends - 2 * _integral(duration)) / duration**2
        if isinstance(term, RandomWalk):
            total += term.K**2 * (apart - duration / 3)
    return float(total)


def _integral(t: float) -> float:
    """Return ln|t| integrated twice."""
    return t**2 / 2 * np.log(t) - 0.75 * t**2 if t > 0 else 0.0


def _walked(a: Mean, b: Mean, slow: Sum, duration: float) -> float:
    """Return what slow processes make of the difference of two records' means; records of one time count as one after the other."""
    return 0.0 if a is b else difference_variance(slow, duration, max(abs(a.middle - b.middle), duration))


def _turn_on_variance(means: Sequence[Sequence[Mean]], records: Sequence[Mean], differences: Floats) -> float | None:
    """Return by how much means of different logs at one temperature scatter beyond noise; None where there are none."""
    place = {id(m): i for i, m in enumerate(records)}
    excess = [
        ((a.value - b.value) ** 2 - differences[place[id(a)], place[id(b)]]) / 2
        for here in means
        for i, a in enumerate(here)
        for b in here[:i]
        if a.log != b.log
    ]
    return max(float(np.mean(excess)), 0.0) if excess else None


def _loop(means: Sequence[Mean], white: float, slow: Sum, duration: float, level: float) -> Hysteresis | None:
    """Return rising less falling at one temperature, within the first log that has both; None where there is none."""
    for log in dict.fromkeys(m.log for m in means):
        up = next((m for m in means if m.log == log and m.rising is True), None)
        down = next((m for m in means if m.log == log and m.rising is False), None)
        if up is not None and down is not None:
            variance = white**2 * (1 / up.duration + 1 / down.duration) + _walked(up, down, slow, duration)
            half = normal_limit(level) * variance**0.5
            value = up.value - down.value
            return Hysteresis((up.celsius + down.celsius) / 2, value, value - half, value + half)
    return None
