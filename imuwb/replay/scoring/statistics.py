"""Statistics of many outages that overlap: quantiles, consistency and comparisons, with intervals that allow for the overlap.

A log of a quarter of an hour has room for about fifteen outages of a minute that do not overlap, however many a sweep has.
The intervals therefore come from blocks of neighbours, which are drawn together (moving-block bootstrap, Künsch 1989).
"""

from dataclasses import dataclass
from itertools import product

import numpy as np

from imuwb.arrays import Floats, Integers
from imuwb.notes import Note
from imuwb.replay.scoring.overlap import block_length, effective_count
from imuwb.replay.scoring.pooling import logs_of
from imuwb.replay.scoring.scores import Scores
from imuwb.statistics import Estimate
from imuwb.statistics.distributions import chi_square_quantile

DRAWS = 1000  #: number of bootstrap samples
EXACT = 12  #: blocks; up to this number the sign test tries all combinations of signs
SEED = 0
FEWEST = 5  #: outages that do not overlap; fewer give no intervals and no verdict
LIMIT_95 = 5.991  #: 95 % quantile of chi-squared with two degrees of freedom
LEAST_ERROR = 1e-3  #: m, added to errors before their logarithm
DRIVEN = 1.0  #: m/s, mean speed; only faster outages have an error in per cent of the distance


@dataclass(frozen=True, slots=True)
class Consistency:
    """Whether a filter's sigma is right, at some time in the outages."""

    elapsed: float  #: s since the start of the outage
    nees_per_dof: float  #: mean; 1 if sigma is right
    lower: float  #: interval of this mean if sigma is right, for the number of outages that do not overlap
    upper: float
    coverage95: float  #: share of the outages within the filter's own 95 % ellipse
    ratio: float  #: ratio of errors to sigma: square root of ``nees_per_dof``


@dataclass(frozen=True, slots=True)
class Summary:
    """One filter in all outages of one duration. Errors are horizontal unless their name states otherwise."""

    model: str
    duration: float  #: s
    count: int
    effective_count: int  #: outages that do not overlap
    median_end: Estimate  #: m, at the end
    p68_end: Estimate  #: m, 68 % quantile at the end
    p95_end: Estimate  #: m, 95 % quantile at the end
    median_max: Estimate  #: m, median of each outage's largest error
    median_vertical: float  #: m, at the end
    median_velocity: float  #: m/s, at the end
    median_heading: float | None  #: rad, at the end; None: the reference has no heading
    median_percent: float | None  #: per cent of the distance driven, at the end; None: no outage is fast enough
    consistency: tuple[Consistency, ...]
    nis_per_dof: float  #: mean NIS over its degrees of freedom, in the filter's run over the whole log

    def __str__(self) -> str:
        """Return median, consistency and number of outages in a line."""
        last = f", NEES/2 {self.consistency[-1].nees_per_dof:.2f}" if self.consistency else ""
        return (
            f"{self.model} after {self.duration:g} s without GNSS: median {self.median_end}{last}, {self.count} outage{'s' * (self.count != 1)}, "
            f"{self.effective_count} of them do not overlap"
        )


@dataclass(frozen=True, slots=True)
class Paired:
    """Two filters in the same outages, at their ends."""

    model: str
    against: str
    duration: float  #: s
    median_difference: Estimate  #: m; negative: the first filter is better
    improvement: Estimate  #: mean of 1 - model/against (Quinchia, section 7)
    win_rate: float  #: share of the outages in which the first filter is better
    p_value: float  #: for the hypothesis of no difference, by random signs of blocks of neighbours


def resampled(count: int, block: int, seed: int = SEED) -> Integers:
    """Return the rows of a moving-block bootstrap, (DRAWS, count)."""
    rng = np.random.default_rng(seed)
    first = rng.integers(0, max(count - block, 0) + 1, size=(DRAWS, -(-count // block)))
    rows = (first[..., None] + np.arange(min(block, count))).reshape(DRAWS, -1)
    return rows[:, :count]


def _rows(scores: Scores, duration: float) -> tuple[Integers, int, int]:
    """Return the rows of the bootstrap, none where outages are too few; the effective count; and the length of a block.

    Each log of pooled logs is resampled alone: no block crosses logs, and each keeps its number of outages.
    """
    effective = effective_count(scores.start, duration)
    block = block_length(scores.start, duration)
    drawn = [part[0] + resampled(part.size, block, SEED + k) for k, part in enumerate(logs_of(scores.start))]
    rows = np.hstack(drawn) if drawn else resampled(0, block)
    return (rows if effective >= FEWEST else rows[:0]), effective, block


def quantile(values: Floats, share: float, rows: Integers, level: float) -> Estimate:
    """Return a quantile with its bootstrap interval, m; no interval without rows."""
    value = float(np.quantile(values, share))
    if rows.shape[0] == 0:
        return Estimate(value, float("nan"), float("nan"), unit="m")
    low, high = np.quantile(np.quantile(values[rows], share, axis=1), [(1 - level) / 2, (1 + level) / 2])
    return Estimate(value, float(low), float(high), unit="m")


def summarize(
    model: str, duration: float, scores: Scores, horizons: tuple[float, ...], nis_per_dof: float, level: float
) -> Summary | None:
    """Return the statistics of one filter; None without outages.

    Args:
        model: name of the filter.
        duration: s.
        scores: errors in the outages that are scored.
        horizons: s since the start of the outage; times at which consistency is judged.
        nis_per_dof: mean NIS over its degrees of freedom, in the filter's run over the whole log.
        level: of all intervals.
    """
    if not scores.start.size:
        return None
    rows, effective, _ = _rows(scores, duration)
    end, largest = scores.horizontal[:, -1], scores.horizontal.max(axis=1)
    driven = scores.distance[:, -1]
    far = driven > DRIVEN * duration
    heading = np.abs(scores.heading[:, -1])
    consistency = tuple(
        _consistency(scores, h, effective, level) for h in horizons if h <= duration and h <= scores.elapsed[-1]
    )
    return Summary(
        model, duration, int(scores.start.size), effective,
        quantile(end, 0.5, rows, level), quantile(end, 0.68, rows, level), quantile(end, 0.95, rows, level),
        quantile(largest, 0.5, rows, level), float(np.median(np.abs(scores.vertical[:, -1]))),
        float(np.median(scores.velocity[:, -1])), float(np.median(heading)) if np.isfinite(heading).all() else None,
        float(np.median(end[far] / driven[far]) * 100) if far.any() else None, consistency, nis_per_dof,
    )  # fmt: skip


def _consistency(scores: Scores, elapsed: float, effective: int, level: float) -> Consistency:
    nees = scores.nees[:, int(np.argmin(np.abs(scores.elapsed - elapsed)))]
    low, high = (chi_square_quantile(p, 2.0 * effective) / (2 * effective) for p in ((1 - level) / 2, (1 + level) / 2))
    mean = float(nees.mean() / 2)
    return Consistency(elapsed, mean, float(low), float(high), float((nees <= LIMIT_95).mean()), float(np.sqrt(mean)))


def compare(model: str, scores: Scores, against: str, other: Scores, duration: float, level: float) -> Paired:
    """Return the comparison of two filters in the same outages.

    Args:
        model: name of the first filter.
        scores: of the first filter.
        against: name of the second filter.
        other: scores of the second filter.
        duration: s.
        level: of all intervals.
    """
    a, b = scores.horizontal[:, -1], other.horizontal[:, -1]
    rows, _, block = _rows(scores, duration)
    share = np.where(b > 0, 1 - a / np.where(b > 0, b, 1), 0.0)
    means = share[rows].mean(axis=1)
    low, high = np.quantile(means, [(1 - level) / 2, (1 + level) / 2]) if means.size else (np.nan, np.nan)
    improvement = Estimate(float(share.mean()), float(low), float(high))
    p_value = sign_flip(np.log((a + LEAST_ERROR) / (b + LEAST_ERROR)), block, scores.start)
    return Paired(
        model, against, duration, quantile(a - b, 0.5, rows, level), improvement, float((a < b).mean()), p_value
    )


def sign_flip(differences: Floats, block: int, start: Floats | None = None) -> float:
    """Return the probability of a mean at least as large, if each block of neighbours has a random sign.

    Args:
        differences: (s,) in order of time.
        block: outages in a block.
        start: (s,) s; blocks do not cross pooled logs; None: one log.
    """
    logs = [np.arange(differences.size)] if start is None else logs_of(start)
    sums = np.array([
        part.sum() for log in logs for part in np.array_split(differences[log], max(1, log.size // block))
    ])  # fmt: skip
    blocks, observed = sums.size, abs(sums.sum())
    if blocks <= EXACT:
        signs = np.array(list(product((1.0, -1.0), repeat=blocks)))
    else:
        signs = np.random.default_rng(SEED).choice([1.0, -1.0], size=(20 * DRAWS, blocks))
        signs[0] = 1.0
    return float((np.abs(signs @ sums) >= observed * (1 - 1e-12)).mean())


@dataclass(frozen=True, eq=False, slots=True)
class DriftCurve:
    """Horizontal errors, sigma and NEES over the time without GNSS."""

    elapsed: Floats  #: (L,) s
    median: Floats  #: (L,) m
    p68: Floats  #: (L,) m, 68 % quantile
    p95: Floats  #: (L,) m, 95 % quantile
    sigma: Floats  #: (L,) m, median of the filter's own sigma
    nees_per_dof: Floats  #: (L,) mean


def drift_curve(scores: Scores) -> DriftCurve:
    """Return errors, sigma and NEES of one filter at each mark."""
    median, p68, p95 = np.quantile(scores.horizontal, [0.5, 0.68, 0.95], axis=0)
    return DriftCurve(scores.elapsed, median, p68, p95, np.median(scores.sigma, axis=0), scores.nees.mean(axis=0) / 2)


def verdict(summary: Summary) -> Note:
    """Return whether a filter's sigma can be trusted."""
    if not summary.consistency:
        return Note("no-horizon", f"{summary.model}: the outages are too short to judge its sigma")
    if summary.effective_count < FEWEST:
        count = summary.effective_count
        some = "1 outage that does not overlap is" if count == 1 else f"{count} outages that do not overlap are"
        text = f"{some} too few to judge a sigma: {FEWEST} are needed"
        return Note("few-outages", text)
    last = summary.consistency[-1]
    if last.lower <= last.nees_per_dof <= last.upper:
        text = (
            f"{summary.model}: sigma can be trusted after {last.elapsed:g} s (NEES/2 is {last.nees_per_dof:.2f}; if sigma is "
            f"right, it is {last.lower:.2f} to {last.upper:.2f})"
        )
        return Note("sigma-right", text)
    if last.nees_per_dof > last.upper:
        text = f"{summary.model}: after {last.elapsed:g} s, sigma is {last.ratio:.1f} times too small"
        return Note("sigma-small", text)
    text = f"{summary.model}: after {last.elapsed:g} s, sigma is {1 / last.ratio:.1f} times too large"
    return Note("sigma-large", text)
