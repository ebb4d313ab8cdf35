"""Which filter to take: chosen on some outages, judged on others that it has not been chosen on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from imuwb.log import Floats
    from imuwb.replay.scores import Scores

FOLDS = 5
AT = (5, 10, 20, 30, 60)  #: s into an outage, at which errors count


@dataclass(frozen=True, slots=True)
class Candidate:
    """One filter of a choice."""

    model: str
    log_likelihood: float  #: of an outage's errors under the filter's own covariance, mean over outages and seconds
    median_end: float  #: m
    folds: int  #: in which it is the best on the other folds


@dataclass(frozen=True, slots=True)
class Choice:
    """Filters in the order of how likely they make the errors, and what choosing so is worth."""

    duration: float  #: s
    candidates: tuple[Candidate, ...]
    folds: int
    unseen_log_likelihood: float  #: of the filter chosen on the other folds, in each fold; mean
    unseen_median_end: float  #: m, likewise

    @property
    def chosen(self) -> str:
        """Return the likeliest filter's name."""
        return self.candidates[0].model


def choose(found: Mapping[str, Scores], duration: float) -> Choice | None:
    """Return the choice among filters by cross-validation over blocks of outages; None where there are too few.

    An outage that overlaps a block is not used to choose for it.

    Args:
        found: filter -> its scores; all of the same outages, in order of time.
        duration: s.
    """
    start = next(iter(found.values())).start
    if len(found) < 2 or start.size < 2 * FOLDS:  # noqa: PLR2004 - a choice needs two
        return None
    likelihood = {name: log_likelihood(s) for name, s in found.items()}
    blocks = np.array_split(np.arange(start.size), FOLDS)
    wins = dict.fromkeys(found, 0)
    unseen: list[Floats] = []
    errors: list[Floats] = []
    for block in blocks:
        others = (start + duration <= start[block[0]]) | (start >= start[block[-1]] + duration)
        if not others.any():
            return None
        best = max(found, key=lambda name: float(likelihood[name][others].mean()))
        wins[best] += 1
        unseen.append(likelihood[best][block])
        errors.append(found[best].horizontal[block, -1])
    candidates = [
        Candidate(name, float(likelihood[name].mean()), float(np.median(s.horizontal[:, -1])), wins[name])
        for name, s in found.items()
    ]
    candidates.sort(key=lambda c: -c.log_likelihood)
    return Choice(
        duration, tuple(candidates), FOLDS, float(np.concatenate(unseen).mean()), float(np.median(np.concatenate(errors)))
    )  # fmt: skip


def log_likelihood(found: Scores) -> Floats:
    """Return how likely a filter's covariance makes its horizontal errors: the mean over some seconds, by outage."""
    at = [int(np.argmin(np.abs(found.elapsed - second))) for second in AT if second <= found.elapsed[-1]]
    covariance = found.covariance[:, at]
    determinant = covariance[..., 0, 0] * covariance[..., 1, 1] - covariance[..., 0, 1] ** 2
    return (-found.nees[:, at] / 2 - np.log(determinant) / 2 - np.log(2 * np.pi)).mean(axis=1)
