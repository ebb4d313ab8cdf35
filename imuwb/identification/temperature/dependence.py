"""A score test of whether a coefficient depends on temperature, or has one value at all temperatures.

At each temperature the likelihood is maximised with the coefficient held at the common value and the other terms free. Its slope
there, divided by the root of its information, is a standardised difference. If few cosine coefficients determine the square of
a coefficient (B, and above all K), the square scatters as a chi-square with few degrees of freedom. The distribution of the
statistic is then simulated from such chi-squares, with a fixed seed; for N, with thousands of degrees, it is chi-square.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.likelihood.fit import TERMS
from imuwb.identification.temperature.set_point import SetPoint
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_quantile, chi_square_tail

ROUNDS = 12  #: largest number of rounds of the search for the common value
FAINT = 1e-4  #: standard errors; a smaller square is 0
CLOSE = 0.01  #: standard errors of the common square, at which the search ends
SURE = 2000.0  #: degrees of freedom, from which a square is normal enough
LEAST = 1.0  #: degrees of freedom; a square with fewer says nothing about a dependence
LEVEL = 0.95  #: confidence level of the interval of the common value
DRAWS, SEED = 20_000, 20_130_807  #: number of draws, and seed, of the simulation


@dataclass(frozen=True, eq=False, slots=True)
class Dependence:
    """A test that a quantity is the same at all temperatures."""

    statistic: float | None  #: None: there is too little evidence of the coefficient, so nothing to test
    distribution: str  #: distribution of the statistic if nothing depends on temperature
    critical: float | None  #: the statistic exceeds it with probability ``size`` if nothing depends on temperature
    p_value: float | None
    size: float  #: probability of a false alarm
    depends: bool | None  #: None if there is no statistic
    common: Coefficient | None = None  #: value common to all temperatures; None for other quantities

    def __repr__(self) -> str:
        """Return the verdict, in one line."""
        if self.p_value is None:
            return self.distribution
        return f"{'depends on temperature' if self.depends else 'the same at all temperatures'}, p = {self.p_value:.2g}"


def heterogeneity(values: Floats, sigmas: Floats, size: float = 0.05) -> Dependence | None:
    """Test whether estimates with normal errors have one value; None for fewer than two.

    Args:
        values: (k,) estimates.
        sigmas: (k,) standard errors.
        size: probability of a false alarm.
    """
    if values.size < 2:  # noqa: PLR2004 - nothing to compare
        return None
    weight = 1 / sigmas**2
    statistic = float(weight @ (values - weight @ values / weight.sum()) ** 2)
    return by_chi_square(values.size, statistic, size)


def depends(
    points: Sequence[SetPoint], letter: str, pooled: Coefficient | None = None, *, size: float = 0.05
) -> Dependence | None:
    """Test whether a coefficient is the same at all temperatures; None for a single temperature.

    Args:
        points: one for each temperature.
        letter: Q, N, B or K.
        pooled: the coefficient from all temperatures together; without a value there is nothing to test. None: not estimated.
        size: probability of a false alarm.
    """
    if len(points) < 2:  # noqa: PLR2004 - nothing to compare
        return None
    if pooled is not None and pooled.value is None:
        text = "no evidence of the coefficient at all temperatures together"
        return Dependence(None, text, None, None, size, None, pooled)
    common, slope, information = _common(points, list(TERMS).index(letter))
    if common <= 0:
        return None
    total = float(information.sum())
    value = pooled or Coefficient(common**0.5, *interval(common, total**-0.5, LEVEL), at=READ_OUT[letter])
    away = slope / np.sqrt(information)
    statistic = float(away @ away - (away @ np.sqrt(information)) ** 2 / total)
    freedom = 2 * common**2 * information
    if np.count_nonzero(freedom >= LEAST) < 2:  # noqa: PLR2004 - a comparison needs two
        text = f"too little evidence of the coefficient: {freedom.max():.2g} degrees of freedom at most"
        return Dependence(None, text, None, None, size, None, value)
    if freedom.min() > SURE:
        return by_chi_square(len(points), statistic, size, value)
    drawn = _drawn(freedom, information)
    p_value = float((1 + np.count_nonzero(drawn >= statistic)) / (1 + DRAWS))
    critical = float(np.quantile(drawn, 1 - size))
    text = f"simulated from scaled chi-squares of {freedom.min():.3g} to {freedom.max():.3g} degrees of freedom"
    return Dependence(statistic, text, critical, p_value, size, p_value < size, value)


def by_chi_square(count: int, statistic: float, size: float, common: Coefficient | None = None) -> Dependence:
    """Return the test of a statistic whose distribution is chi-square with ``count`` - 1 degrees of freedom."""
    p_value = float(chi_square_tail(statistic, count - 1))
    critical = float(chi_square_quantile(1 - size, count - 1))
    return Dependence(statistic, f"chi-square({count - 1})", critical, p_value, size, p_value < size, common)


def _drawn(freedom: Floats, information: Floats) -> Floats:
    """Return simulated statistics, (draws,), of scaled chi-squares with one common value."""
    rng = np.random.default_rng(SEED)
    away = (rng.chisquare(freedom, (DRAWS, freedom.size)) / freedom - 1) * np.sqrt(freedom / 2)
    return np.sum(away**2, axis=1) - (away @ np.sqrt(information)) ** 2 / information.sum()


def _common(points: Sequence[SetPoint], term: int) -> tuple[float, Floats, Floats]:
    """Return the likeliest common square, and each temperature's slope and information there; 0 if there is none."""
    sizes = np.array([point.squared[term] for point in points])
    common = float(np.median(sizes[sizes > 0])) if (sizes > 0).any() else 0.0
    slope, information = _scores(points, term, common)
    for _ in range(ROUNDS):
        following = max(common + float(slope.sum() / information.sum()), common / 10)
        if following < FAINT * information.sum() ** -0.5:
            return 0.0, slope, information
        done = abs(following - common) * float(information.sum()) ** 0.5 < CLOSE
        common = following
        slope, information = _scores(points, term, common)
        if done:
            break
    return common, slope, information


def _scores(points: Sequence[SetPoint], term: int, square: float) -> tuple[Floats, Floats]:
    scores = np.array([_score(point, point.squared, term, square) for point in points])
    return scores[:, 0], scores[:, 1]


def _score(point: SetPoint, start: Floats, term: int, held: float) -> tuple[float, float]:
    """Return the log likelihood's derivative by a term's square, with the other terms likeliest, and its information."""
    others = [t for t, letter in enumerate(TERMS) if t != term and letter not in point.absent]
    at = point.problem.solve(others, ramp=point.ramped, start=start, held=np.eye(start.size)[term] * held).squared
    slope, information = point.problem.slope(at, ramp=point.ramped)
    free = [t for t in others if at[t] > 0]
    along = information[term, term]
    if free:
        across = information[np.ix_(free, free)]
        size = np.sqrt(across.diagonal())
        solved = np.linalg.lstsq(across / np.outer(size, size), information[free, term] / size, rcond=1e-13)[0] / size
        along -= solved @ information[free, term]
    return float(slope[term]) / point.inflation, float(along) / point.inflation
