"""Statistics of many outages that overlap: quantiles, consistency, and comparisons, with intervals that know it.

A log of a quarter of an hour holds about fifteen outages of a minute that do not overlap, however many starts are swept:
intervals come from blocks of neighbours, drawn together (moving-block bootstrap, Künsch 1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from imuwb.statistics.distributions import chi_square_quantile

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.log import Floats
    from imuwb.replay.scores import Scores

DRAWS = 1000
EXACT = 12  #: blocks, up to which all signs are tried
SEED = 0
FEWEST = 5  #: outages that do not overlap, below which there are no intervals and no verdict
LIMIT_95 = 5.991  #: chi-squared of two degrees of freedom


@dataclass(frozen=True, slots=True)
class Interval:
    """A value with the ends of its interval."""

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, slots=True)
class Consistency:
    """Whether a filter's own sigma holds, at some time into the outages."""

    elapsed: float  #: s
    nees_per_dof: float  #: mean; 1 where sigma is right
    lower: float  #: of the mean, were sigma right and the outages as many as do not overlap
    upper: float
    coverage95: float  #: share of outages within the filter's own 95 % ellipse
    ratio: float  #: of the errors to sigma: the root of ``nees_per_dof``


@dataclass(frozen=True, slots=True)
class Summary:
    """One filter over all outages of a duration."""

    model: str
    duration: float  #: s
    count: int
    effective_count: int  #: that do not overlap
    median_end: Interval  #: m, horizontal error at the end
    p68_end: Interval  #: m
    p95_end: Interval  #: m
    median_max: Interval  #: m
    median_vertical: float  #: m, at the end
    median_velocity: float  #: m/s, at the end
    median_heading: float | None  #: rad, at the end; None: the reference knows no heading
    median_percent: float | None  #: of the distance driven; of outages that move
    consistency: tuple[Consistency, ...]
    nis_per_dof: float  #: of the filter's run over the whole log


@dataclass(frozen=True, slots=True)
class Paired:
    """One filter against another over the same outages, at their ends."""

    model: str
    against: str
    duration: float  #: s
    median_difference: Interval  #: m; below 0 the first is better
    improvement: Interval  #: mean of 1 - model/against, as Quinchia reckons it
    win_rate: float
    p_value: float  #: of no difference, by flipping the signs of blocks


def effective_count(start: Floats, duration: float) -> int:
    """Return how many of some outages can be chosen so that none overlaps."""
    count, free = 0, -np.inf
    for one in np.sort(start):
        if one >= free - 1e-6:
            count, free = count + 1, one + duration
    return count


def block_length(start: Floats, duration: float) -> int:
    """Return how many neighbours an outage overlaps with: the length of a block."""
    ordered = np.sort(start)
    behind = np.searchsorted(ordered, ordered + duration - 1e-6)
    return int((behind - np.arange(ordered.size)).max(initial=1))


def resampled(count: int, block: int) -> NDArray[np.int64]:
    """Return rows of a moving-block bootstrap, (DRAWS, count)."""
    rng = np.random.default_rng(SEED)
    blocks = -(-count // block)
    first = rng.integers(0, max(count - block, 0) + 1, size=(DRAWS, blocks))
    rows = (first[..., None] + np.arange(min(block, count))).reshape(DRAWS, -1)
    return rows[:, :count]


def quantile(values: Floats, share: float, rows: NDArray[np.int64], level: float) -> Interval:
    """Return a quantile with its bootstrap interval."""
    if rows.shape[0] == 0:
        return Interval(float(np.quantile(values, share)), float("nan"), float("nan"))
    drawn = np.quantile(values[rows], share, axis=1)
    low, high = np.quantile(drawn, [(1 - level) / 2, (1 + level) / 2])
    return Interval(float(np.quantile(values, share)), float(low), float(high))


def summarize(
    model: str, duration: float, found: Scores, horizons: tuple[float, ...], nis_per_dof: float, level: float
) -> Summary | None:
    """Return the statistics of one filter; None where no outage was scored.

    Args:
        model: its name.
        duration: s.
        found: its scores, of outages that were all scored.
        horizons: s into the outages, at which consistency is judged.
        nis_per_dof: of its run.
        level: of all intervals.
    """
    if not found.start.size:
        return None
    effective = effective_count(found.start, duration)
    rows = resampled(found.start.size, block_length(found.start, duration))
    if effective < FEWEST:
        rows = rows[:0]  # so few tell no interval
    end, largest = found.horizontal[:, -1], found.horizontal.max(axis=1)
    driven = found.distance[:, -1]
    far = driven > duration  # more than a metre a second
    heading = np.abs(found.heading[:, -1])
    consistent = tuple(
        _consistency(found, h, effective, level) for h in horizons if h <= duration and h <= found.elapsed[-1]
    )
    return Summary(
        model, duration, int(found.start.size), effective,
        quantile(end, 0.5, rows, level), quantile(end, 0.68, rows, level), quantile(end, 0.95, rows, level),
        quantile(largest, 0.5, rows, level), float(np.median(np.abs(found.vertical[:, -1]))),
        float(np.median(found.velocity[:, -1])), float(np.median(heading)) if np.isfinite(heading).all() else None,
        float(np.median(end[far] / driven[far]) * 100) if far.any() else None, consistent, nis_per_dof,
    )  # fmt: skip


def _consistency(found: Scores, elapsed: float, effective: int, level: float) -> Consistency:
    at = int(np.argmin(np.abs(found.elapsed - elapsed)))
    nees = found.nees[:, at]
    low, high = (chi_square_quantile(p, 2.0 * effective) / (2 * effective) for p in ((1 - level) / 2, (1 + level) / 2))
    mean = float(nees.mean() / 2)
    return Consistency(elapsed, mean, float(low), float(high), float((nees <= LIMIT_95).mean()), float(np.sqrt(mean)))


def compare(model: str, one: Scores, against: str, other: Scores, duration: float, level: float) -> Paired:
    """Return one filter against another over the same outages."""
    a, b = one.horizontal[:, -1], other.horizontal[:, -1]
    block = block_length(one.start, duration)
    rows = resampled(a.size, block)
    if effective_count(one.start, duration) < FEWEST:
        rows = rows[:0]
    share = np.where(b > 0, 1 - a / np.where(b > 0, b, 1), 0.0)
    means = share[rows].mean(axis=1)
    low, high = np.quantile(means, [(1 - level) / 2, (1 + level) / 2]) if means.size else (np.nan, np.nan)
    return Paired(
        model, against, duration, quantile(a - b, 0.5, rows, level),
        Interval(float(share.mean()), float(low), float(high)), float((a < b).mean()), sign_flip(np.log((a + 1e-3) / (b + 1e-3)), block),
    )  # fmt: skip


def sign_flip(differences: Floats, block: int) -> float:
    """Return how probable a mean as large is if the sign of each block of neighbours is a matter of chance."""
    blocks = max(1, differences.size // block)
    sums = np.array([part.sum() for part in np.array_split(differences, blocks)])
    observed = abs(sums.sum())
    if blocks <= EXACT:
        signs = np.array(list(product((1.0, -1.0), repeat=blocks)))
    else:
        signs = np.random.default_rng(SEED).choice([1.0, -1.0], size=(20 * DRAWS, blocks))
        signs[0] = 1.0
    return float((np.abs(signs @ sums) >= observed * (1 - 1e-12)).mean())


def drift_curve(found: Scores) -> dict[str, Floats]:
    """Return the median, 68 and 95 % quantiles of the horizontal error at each second, m."""
    low, middle, high = np.quantile(found.horizontal, [0.5, 0.68, 0.95], axis=0)
    return {"median": low, "p68": middle, "p95": high}


def verdict(summary: Summary) -> str:
    """Return in words whether a filter's sigma can be believed."""
    if not summary.consistency:
        return f"{summary.model}: no outage long enough to judge its sigma"
    last = summary.consistency[-1]
    if summary.effective_count < FEWEST:
        return f"outages that do not overlap are too few to judge a sigma: {summary.effective_count}"
    if last.lower <= last.nees_per_dof <= last.upper:
        return (
            f"{summary.model}: sigma can be believed after {last.elapsed:g} s "
            f"(NEES/2 {last.nees_per_dof:.2f} within {last.lower:.2f} to {last.upper:.2f})"
        )
    small = last.nees_per_dof > last.upper
    times = last.ratio if small else 1 / last.ratio
    return f"{summary.model}: sigma is {times:.1f} times too {'small' if small else 'large'} after {last.elapsed:g} s"
