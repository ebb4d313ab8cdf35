"""The likelihood of a sum of processes, given a record's cosine coefficients.

The coefficients are Gaussian, and their covariance is linear in the squares of the processes' sizes. The lowest coefficients have
a joint covariance; those of a bin are independent and have one density (Whittle). Fisher scoring finds the squares, which are not
negative. A ramp is estimated too (restricted likelihood: the part of the lowest coefficients that the ramp explains does not
count as scatter).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import optimize

from imuwb.arrays import Floats, Integers
from imuwb.identification.likelihood.cosine_spectrum import CosineSpectrum
from imuwb.identification.likelihood.score import LEAST_SHARE, add_bins, add_low
from imuwb.stochastic import Process

ROUNDS = 60
CLOSE = 1e-4  #: change of the deviance at which scoring ends
FAINT = 1e-3  #: share of the rough estimate, at which a term that was absent starts


@dataclass(frozen=True, eq=False, slots=True)
class Solution:
    """The likeliest squares of some terms."""

    squared: Floats  #: (t,) squares of all terms, 0 for a term that is left out
    deviance: float  #: -2 log likelihood
    information: Floats  #: (t, t) Fisher's, of the squares
    ramp: float  #: unit/s; 0 where no ramp is estimated
    ramp_sigma: float  #: unit/s


@dataclass(frozen=True, eq=False, slots=True)
class LikelihoodProblem:
    """Cosine coefficients of one record or of several, with the covariances and densities of t processes of size 1."""

    low: Floats  #: (l,) lowest coefficients
    trend: Floats  #: (l,) lowest coefficients of a ramp of 1 unit/s
    parts: Floats  #: (t, l, w) covariances of each of the lowest coefficients with those of its own record
    frequency: Floats  #: (k,) Hz, of the bins
    power: Floats  #: (k,) mean squares
    count: Floats  #: (k,) coefficients in each bin
    design: Floats  #: (k, t) densities
    ramp: float  #: unit/s, taken off the samples before the transform
    edges: Integers  #: (r + 1,) first of the lowest coefficients of each of r records, and their number

    @staticmethod
    def of(spectrum: CosineSpectrum, processes: Sequence[Process]) -> LikelihoodProblem:
        """Return the problem of a spectrum; ``processes`` are those that may be present, each of size 1."""
        return LikelihoodProblem(
            spectrum.low, spectrum.trend(), np.stack([spectrum.covariance(p) for p in processes]), spectrum.frequency,
            spectrum.power, spectrum.count.astype(np.float64), np.stack([spectrum.density(p) for p in processes], axis=1),
            spectrum.ramp, np.array([0, spectrum.low.size]),
        )  # fmt: skip

    def below(self, frequency: float) -> LikelihoodProblem:
        """Return the problem without the bins above a frequency, Hz."""
        kept = self.frequency <= frequency
        return replace(
            self,
            frequency=self.frequency[kept],
            power=self.power[kept],
            count=self.count[kept],
            design=self.design[kept],
        )

    def solve(
        self,
        active: Sequence[int],
        *,
        ramp: bool = True,
        start: Floats | None = None,
        held: Floats | None = None,
        close: float = CLOSE,
    ) -> Solution:
        """Return the likeliest squares of the active terms.

        Args:
            active: indices of the free terms.
            ramp: whether a ramp is estimated too.
            start: (t,) squares to begin with.
            held: (t,) squares of terms that are in the sum but not free.
            close: change of the deviance at which scoring ends.
        """
        free = list(active)
        held = np.zeros(self.design.shape[1]) if held is None else held
        squared = self._start(free) + held
        if start is not None:  # a term that was absent may be needed when another is held
            squared[free] = np.where(start[free] > 0, start[free], FAINT * squared[free])
        now = self._score(squared, ramp=ramp)
        for _ in range(ROUNDS):
            rows = np.ix_(free, free)
            target = now.target[free] - now.information[np.ix_(free, range(held.size))] @ held
            wanted = held.copy()
            wanted[free] += nonnegative(now.information[rows], target)
            step, new = 1.0, self._score(wanted, ramp=ramp)
            while not new.deviance <= now.deviance + 1e-9 * abs(now.deviance) and step > 1e-3:  # noqa: PLR2004 - a thousandth
                step /= 2
                new = self._score(squared + step * (wanted - squared), ramp=ramp)
            squared = squared + step * (wanted - squared)
            done = abs(now.deviance - new.deviance) <= close
            now = new
            if done:
                break
        return Solution(squared, now.deviance, now.information, now.ramp + self.ramp * ramp, now.ramp_sigma)

    def deviance(self, squared: Floats, *, ramp: bool = False) -> float:
        """Return -2 log likelihood of these squares."""
        return self._score(squared, ramp=ramp).deviance

    def slope(self, squared: Floats, *, ramp: bool = False) -> tuple[Floats, Floats]:
        """Return the derivative of the log likelihood with respect to the squares, (t,), and Fisher's information, (t, t)."""
        now = self._score(squared, ramp=ramp)
        return now.target - now.information @ squared, now.information

    def _start(self, free: list[int]) -> Floats:
        weight = np.sqrt(self.count) / self.power.clip(self.power.max() * LEAST_SHARE)
        columns = self.design[:, free] * weight[:, None]
        size = np.linalg.norm(columns, axis=0)
        squared = np.zeros(self.design.shape[1])
        squared[free] = optimize.nnls(columns / size, self.power * weight)[0] / size
        if not squared.any():
            squared[free] = self.power.mean() / self.design[:, free].mean(axis=0) / len(free)
        return squared

    def _score(self, squared: Floats, *, ramp: bool) -> _Score:
        information, target = np.zeros((squared.size, squared.size)), np.zeros(squared.size)
        bins = add_bins(squared, self.power, self.count, self.design, information, target)
        low, slope, sigma = add_low(
            squared, self.low, self.trend, self.parts, self.edges, self.ramp, ramp, information, target
        )
        return _Score(bins + low, information, target, slope, sigma)


@dataclass(frozen=True, eq=False, slots=True)
class _Score:
    """Deviance, Fisher information I, and target b: the squares p with I p = b are the next step."""

    deviance: float
    information: Floats
    target: Floats
    ramp: float
    ramp_sigma: float


def nonnegative(information: Floats, target: Floats, rank: float = 1e-13) -> Floats:
    """Return the p >= 0 that makes p'Ip/2 - p'b least; smaller eigenvalues than ``rank`` times the largest count as 0."""
    size = np.sqrt(information.diagonal()).clip(1e-150)
    values, vectors = np.linalg.eigh(information / (size[:, None] * size))
    kept = values > values[-1] * rank
    root = (vectors[:, kept] * np.sqrt(values[kept])).T
    right = (vectors[:, kept] / np.sqrt(values[kept])).T @ (target / size)
    return optimize.nnls(root, right)[0] / size
