"""Differences of estimates as standard normal values.

The logarithm of an estimated square has an error with a heavy lower tail, and a sum of such errors has tails that neither a normal nor a
Pearson III variable has. Far out, the probability comes from the cumulants of the sum by a saddlepoint: r* of Barndorff-Nielsen (J. R.
Statist. Soc. B 52, 1990), which agrees with Lugannani and Rice (Adv. Appl. Prob. 12, 1980).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Booleans, Floats, Integers
from imuwb.statistics.distributions import scipy, student_score

FEWEST, MOST = 1.0, 1e6  #: degrees of freedom
FAR = 2.0  #: score above which the tail of the sum counts; no smaller one is a finding
NORMAL = 1e6  #: half of the degrees of freedom, above which the logarithm of a square counts as normal
ROUNDS, CLOSE = 100, 1e-9  #: of the search for a saddlepoint; share of the standard deviation at which it ends


@dataclass(frozen=True, eq=False, slots=True)
class Errors:
    """Sums of errors of logs: of each log half the logarithm of a chi-square variable."""

    weight: Floats  #: (r,) of a log in a sum
    half: Floats  #: (r,) half of its degrees of freedom; inf: its error is normal
    owner: Integers  #: (r,) number of the sum, from 0

    def of(self, kept: Booleans) -> Errors:
        """Return some of the sums."""
        rows = kept[self.owner]
        return Errors(self.weight[rows], self.half[rows], (np.cumsum(kept) - 1)[self.owner[rows]])


def score(size: Floats, variance: Floats, error: Floats, errors: Callable[[Booleans], Errors]) -> Floats:
    """Return the standard normal values that are as improbable as differences.

    First as if the variances were known, then as Student variables: a variance that is estimated from few sensors makes far values
    more probable. In a family of six, 5 standard deviations are as improbable as 2.4 of a known variance.

    Args:
        size: (k,) differences; their expectation is 0.
        variance: (k,) their variances, as they are estimated.
        error: (k,) sampling variances of ``variance``; the degrees of freedom are Satterthwaite's.
        errors: returns those of some of the differences; it is asked for the far ones alone.
    """
    scores = size / np.sqrt(variance)
    tail = np.abs(scores) > FAR
    if tail.any():
        scores[tail] = in_tails(scores[tail], variance[tail], errors(tail))
    return student_score(scores, freedom(variance, error))


def in_tails(scores: Floats, variance: Floats, errors: Errors) -> Floats:
    """Return the standard normal values that are as improbable as sums of errors of logs and of a normal variable.

    The probabilities are right to 5 % from one degree of freedom on, down to 1e-9.

    Args:
        scores: (k,) values of the sums over their standard deviations, not near 0.
        variance: (k,) of the sums; what the errors do not explain is normal.
        errors: of k sums.
    """
    turned = np.sign(scores)
    value = np.abs(scores) * np.sqrt(variance)
    rows = errors.half < NORMAL
    half, owner = errors.half[rows], errors.owner[rows]
    weight = errors.weight[rows] * turned[owner] / 2

    def total(parts: Floats) -> Floats:
        return np.bincount(owner, parts, value.size).astype(np.float64)

    psi, start = scipy.special.digamma(half), scipy.special.gammaln(half)
    rest = np.maximum(variance - total(weight**2 * scipy.special.polygamma(1, half)), 0.0)

    def slopes(t: Floats) -> tuple[Floats, Floats]:
        at = half + weight * t[owner]
        first = total(weight * (scipy.special.digamma(at) - psi)) + rest * t
        return first, total(weight**2 * scipy.special.polygamma(1, at)) + rest

    end = np.full(value.size, np.inf)
    falling = weight < 0
    np.minimum.at(end, owner[falling], half[falling] / -weight[falling])
    t, second = _saddlepoint(slopes, value, variance, end)
    along = weight * t[owner]
    log = total(scipy.special.gammaln(half + along) - start - along * psi) + rest * t**2 / 2
    root = np.sqrt(2 * np.maximum(t * value - log, CLOSE))
    return turned * (root + np.log(t * np.sqrt(second) / root) / root)


def _saddlepoint(
    slopes: Callable[[Floats], tuple[Floats, Floats]], value: Floats, variance: Floats, end: Floats
) -> tuple[Floats, Floats]:
    """Return where the first derivative of a cumulant function is a value above 0, and its second derivative there.

    The first derivative rises from 0 at 0 without limit towards ``end``: Newton's steps, kept between the known sides.
    """
    low, high = np.zeros_like(value), end
    t = np.minimum(value / variance, end / 2)
    for _ in range(ROUNDS):
        first, second = slopes(t)
        away = first - value
        if np.all(np.abs(away) <= CLOSE * np.sqrt(variance)):
            break
        low, high = np.where(away < 0, t, low), np.where(away > 0, t, high)
        new = t - away / second
        t = np.where((new > low) & (new < high), new, np.where(np.isfinite(high), (low + high) / 2, 2 * t))
    return t, slopes(t)[1]


def freedom(variance: Floats, error: Floats) -> Floats:
    """Return Satterthwaite's degrees of freedom of estimated variances from their sampling variances."""
    known = np.maximum(error, 2 * variance**2 / MOST)
    return np.clip(2 * variance**2 / known, FEWEST, MOST)
