"""The linear problem of an Allan curve: squares of coefficients from correlated Allan variances."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import linalg, optimize

from imuwb.arrays import Floats, Integers
from imuwb.identification.allan_variance.moments import Moments, equivalent_degrees_of_freedom, moments
from imuwb.identification.allan_variance.overlapping import AllanDeviation
from imuwb.identification.spectral.lines import Line
from imuwb.statistics.distributions import chi_square_tail, pearson3_quantile
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, RateRamp, WhiteNoise

PROCESSES = {"Q": Quantization, "N": WhiteNoise, "B": FlickerNoise, "K": RandomWalk, "R": RateRamp}
LETTERS = tuple(PROCESSES)
ROUNDS = 6
LEAST_EIGENVALUE = 1e-9  #: floor of the eigenvalues of a correlation matrix


def _thinned_by_gaps(curve: AllanDeviation, chosen: Integers, n: int) -> Floats:
    """Return by what factor (1 or more) gaps widen the scatter of each Allan variance, compared with n samples."""
    whole = [
        equivalent_degrees_of_freedom(int(m), n, int(a))
        for m, a in zip(curve.factor[chosen], curve.noise_type[chosen], strict=True)
    ]
    if (curve.terms[chosen] >= n + 1 - 2 * curve.factor[chosen]).all():
        return np.ones(chosen.size)
    return np.sqrt(np.maximum(np.array(whole) / curve.degrees_of_freedom[chosen], 1.0))


@dataclass(frozen=True, eq=False, slots=True)
class Problem:
    """Allan variances to be explained: design @ (Q², N², B², K², R²) + periodic lines."""

    dt: float
    tau: Floats  #: (k,)
    variance: Floats  #: (k,) without the part of the lines
    design: Floats  #: (k, 5)
    by_lines: Floats  #: (k,) part of the lines
    of_lines: Floats  #: (k, k) covariance from the uncertainty of the lines' amplitudes
    moments: Moments

    @staticmethod
    def of(curve: AllanDeviation, chosen: Integers, lines: Sequence[Line]) -> Problem:
        """Return the problem of a curve's chosen points, with the part of the lines taken off."""
        factor, tau = curve.factor[chosen], curve.averaging_time[chosen]
        n = int(curve.terms[0]) + 2 * int(curve.factor[0]) - 1
        factor_fits = factor <= n // 2
        chosen, factor, tau = chosen[factor_fits], factor[factor_fits], tau[factor_fits]
        variance = curve.deviation[chosen] ** 2
        if not variance.all():
            raise ValueError("the Allan variance is 0, so the channel is constant; check that the sensor is connected")
        units = [PROCESSES[letter](1.0) for letter in LETTERS]
        design = np.stack([unit.allan_variance(tau, curve.dt) for unit in units], axis=1)
        of_lines, by_lines = np.zeros((tau.size, tau.size)), np.zeros(tau.size)
        for line in lines:
            part = line.process(curve.dt).allan_variance(tau, curve.dt)
            variance, by_lines = variance - part, by_lines + part
            of_lines += np.outer(part, part) * (line.power_sigma / line.amplitude.value**2) ** 2
        known = moments(tuple(int(m) for m in factor), n).scaled(_thinned_by_gaps(curve, chosen, n))
        return Problem(curve.dt, tau, variance, design, by_lines, of_lines, known)

    def since(self, first: int) -> Problem:
        """Return the problem without its ``first`` shortest averaging times."""
        rest = slice(first, None)
        tau, variance, design, by_lines = (part[rest] for part in (self.tau, self.variance, self.design, self.by_lines))
        m = self.moments
        kept = Moments(m.factor[rest], m.squares[rest, rest], m.linear[rest, rest])
        return Problem(self.dt, tau, variance, design, by_lines, self.of_lines[rest, rest], kept)

    def covariance(self, squared: Floats) -> Floats:
        """Return the covariance of the variances if these coefficients are true."""
        return self.moments.covariance(squared[:4], float(np.sqrt(squared[4])), self.dt) + self.of_lines

    def whiten(self, squared: Floats, columns: Floats) -> Floats:
        """Return the columns whitened: if these coefficients are true, the errors are independent and of size 1."""
        return whitener(self.covariance(squared)) @ columns

    def misfit(self, squared: Floats) -> tuple[float, float]:
        """Return chi-square of the residual, and minus twice its Gaussian log likelihood."""
        whiten = whitener(self.covariance(squared))
        chi2 = float(np.sum((whiten @ (self.variance - self.design @ squared)) ** 2))
        return chi2, chi2 - 2 * float(np.linalg.slogdet(whiten)[1])

    def strangeness(self, squared: Floats) -> float:
        """Return the probability that chance puts at least one point so far above or below the sum.

        Chi-square of the residual cannot show that. With few degrees of freedom, a variance of a hundredth of the expected one is
        less than one standard deviation away; its chi-square law shows how improbable it is.
        """
        expected = self.design @ squared + self.by_lines
        freedom = 2 * expected**2 / np.diag(self.covariance(squared)).clip(1e-300)
        ratio = (self.variance + self.by_lines) / expected * freedom
        tails = 2 * np.minimum(below := chi_square_tail(ratio, freedom), 1 - below)
        return float(min(tails.min() * tails.size, 1.0))

    def solve(self, active: Sequence[int], held: Floats | None = None, rounds: int = ROUNDS) -> tuple[Floats, Floats]:
        """Return the non-negative squares of the active terms (0 elsewhere), and the covariance of the active ones.

        Args:
            active: indices of the free terms.
            held: (5,) squares of terms that are in the sum but not free.
            rounds: largest number of repetitions of the fit; each takes the covariance of the fit before.

        Raises:
            ValueError: no active term.
        """
        if not active:  # the solver crashes on a matrix without columns
            raise ValueError("a fit needs at least one term")
        squared = np.zeros(5)
        held = np.zeros(5) if held is None else held
        variance = self.variance - self.design @ held
        weight = 1 / self.variance.clip(np.abs(self.variance).max() * 1e-12)
        scaled = self.design[:, active] * weight[:, None]
        squared[list(active)] = optimize.nnls(scaled, variance * weight)[0]
        columns = self.design[:, active]
        information = np.eye(len(active))
        for _ in range(rounds):
            white = self.whiten(squared + held, columns)
            size = np.linalg.norm(white, axis=0)
            fitted = optimize.nnls(white / size, self.whiten(squared + held, variance))[0] / size
            before = squared[list(active)]
            squared[list(active)] = fitted
            information = white.T @ white
            if np.allclose(before, fitted, rtol=1e-5, atol=0):
                break
        return squared, scaled_inverse(information)

    def added(self, squared: Floats, active: Sequence[int], extra: int) -> FreeSquare:
        """Return the free estimate of one more term's square, and its scatter if ``squared`` is true."""
        columns = self.design[:, [*active, extra]]
        covariance = self.covariance(squared)
        whiten = whitener(covariance)
        white = whiten @ columns
        size = np.linalg.norm(white, axis=0)
        inverse = np.asarray(linalg.pinvh((white / size).T @ (white / size)))
        weights = (inverse @ (white / size).T @ whiten)[-1] / size[-1]
        # Each Allan variance is about a scaled chi-square, whose third cumulant is 8 E³ / edf² = 2 var² / E.
        expected = self.design @ squared
        scatter = np.diag(covariance)
        sigma = float(np.sqrt(inverse[-1, -1]) / size[-1])
        third = np.divide(2 * weights**3 * scatter**2, expected, out=np.zeros_like(expected), where=expected > 0)
        skewness = float(third.sum()) / sigma**3
        return FreeSquare(float(weights @ self.variance), sigma, skewness)


def scaled_inverse(information: Floats) -> Floats:
    """Return the pseudo-inverse of a matrix with rows of very different size: squares of Q and of K differ by 1e17."""
    size = np.sqrt(np.diag(information))
    size = np.where(size > 0, size, 1.0)
    return np.asarray(linalg.pinvh(information / np.outer(size, size))) / np.outer(size, size)


@dataclass(frozen=True, slots=True)
class FreeSquare:
    """A term's square, which may be negative here, and the scatter of such an estimate."""

    value: float
    sigma: float
    skewness: float

    def quantile(self, probability: float) -> float:
        """Return the error, in sigmas, that the estimate stays below with this probability (Pearson III)."""
        skewness = float(np.clip(self.skewness, 0.0, 4.0))
        return pearson3_quantile(probability, skewness)


def whitener(covariance: Floats) -> Floats:
    """Return W with W covariance W' = 1.

    Far from the truth, points may be so strongly correlated that rounding shows, so the least eigenvalue has a floor.
    """
    size = np.sqrt(np.diag(covariance))
    size = np.where(size > 0, size, size.max() or 1.0)  # a ramp alone does not scatter
    values, vectors = linalg.eigh(covariance / np.outer(size, size))
    return (vectors / np.sqrt(np.maximum(values, LEAST_EIGENVALUE))).T / size
