"""The choice of a filter: made on some outages, judged on the others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.replay.scoring.scores import Scores

FOLDS = 5  #: blocks of the cross-validation
FREEDOM = 4.0  #: degrees of freedom of the errors' distribution; a few outages of large errors do not decide alone


@dataclass(frozen=True, slots=True)
class FilterCandidate:
    """One filter of a choice."""

    model: str
    log_likelihood: float  #: of an outage's error at its end, under the filter's own covariance; mean over outages
    median_end: float  #: m
    folds: int  #: number of folds for which this filter is the best one in all other folds


@dataclass(frozen=True, slots=True)
class Choice:
    """Filters in order of their likelihood, and the performance of the choice in outages that were not used for it."""

    duration: float  #: s
    candidates: tuple[FilterCandidate, ...]
    folds: int
    unseen_log_likelihood: float  #: mean over outages; each fold uses the filter chosen in the other folds
    unseen_median_end: float  #: m; median over outages; each fold uses the filter chosen in the other folds

    @property
    def chosen(self) -> str:
        """Return the name of the filter with the largest likelihood."""
        return self.candidates[0].model

    def __str__(self) -> str:
        """Return the chosen filter in a line."""
        best = self.candidates[0]
        return (
            f"Choice for outages of {self.duration:g} s: {best.model}, log-likelihood {best.log_likelihood:.2f}, "
            f"best in {best.folds} of {self.folds} folds"
        )


def choose(scores: Mapping[str, Scores], duration: float) -> Choice | None:
    """Return the choice of a filter by cross-validation over blocks of outages; None if outages or filters are too few.

    An outage that overlaps a block does not take part in the choice for this block.

    Args:
        scores: filter -> its scores, of the same outages for all filters, in order of time.
        duration: s.
    """
    start = next(iter(scores.values())).start
    if len(scores) < 2 or start.size < 2 * FOLDS:  # noqa: PLR2004 - a choice needs two
        return None
    likelihood = {name: log_likelihood(s) for name, s in scores.items()}
    wins = dict.fromkeys(scores, 0)
    unseen: list[Floats] = []
    errors: list[Floats] = []
    for block in np.array_split(np.arange(start.size), FOLDS):
        others = (start + duration <= start[block[0]]) | (start >= start[block[-1]] + duration)
        if not others.any():
            return None
        best = max(scores, key=lambda name: float(likelihood[name][others].mean()))
        wins[best] += 1
        unseen.append(likelihood[best][block])
        errors.append(scores[best].horizontal[block, -1])
    candidates = [
        FilterCandidate(name, float(likelihood[name].mean()), float(np.median(s.horizontal[:, -1])), wins[name])
        for name, s in scores.items()
    ]
    candidates.sort(key=lambda c: -c.log_likelihood)
    return Choice(
        duration, tuple(candidates), FOLDS, float(np.concatenate(unseen).mean()), float(np.median(np.concatenate(errors)))
    )  # fmt: skip


def log_likelihood(scores: Scores, at: Sequence[float] = (np.inf,)) -> Floats:
    """Return the log-likelihood of each outage's horizontal error, (s,), mean over some times; by default at its end.

    The errors have Student's distribution in two dimensions, with the covariance of the scores: that of the filter and of the
    reference.

    Args:
        scores: of the outages.
        at: s since the start of an outage.
    """
    marks = [int(np.argmin(np.abs(scores.elapsed - min(second, scores.elapsed[-1])))) for second in at]
    covariance, nees = scores.covariance[:, marks], scores.nees[:, marks]
    determinant = covariance[..., 0, 0] * covariance[..., 1, 1] - covariance[..., 0, 1] ** 2
    # The scale matrix of the distribution is (FREEDOM - 2)/FREEDOM times its covariance.
    shrink = (FREEDOM - 2) / FREEDOM
    terms = (
        -np.log(determinant) / 2 - np.log(shrink) - np.log(2 * np.pi)
        - (FREEDOM + 2) / 2 * np.log1p(nees / (shrink * FREEDOM))
    )  # fmt: skip
    return terms.mean(axis=1)
