"""Does a coefficient depend on temperature? A score test against one value at all temperatures.

Each temperature's likelihood is climbed with the coefficient held at the common value, the other terms free: its slope there,
over the root of its information, is a standardised difference. Squares of coefficients that few
cosines tell of (B, and K above all) scatter as a chi-square of few degrees does, so the statistic's distribution is drawn from
those, seeded; for N, with thousands of degrees, it is chi-square itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.coefficient import READ_OUT, interval
from imuwb.identification.likelihood.fit import TERMS
from imuwb.statistics import Coefficient
from imuwb.statistics.distributions import chi_square_quantile, chi_square_tail

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.temperature.set_point import SetPoint

    Floats = NDArray[np.float64]

ROUNDS = 12
FAINT = 1e-4  #: standard errors; a square below is 0
CLOSE = 0.01  #: standard errors of the common square
SURE = 2000.0  #: degrees of freedom, from which on a square is as good as normal
LEVEL = 0.95  #: of the interval of N at all temperatures
DRAWS, SEED = 20_000, 20_130_807


@dataclass(frozen=True, eq=False, slots=True)
class Dependence:
    """A test of "the same at all temperatures"."""

    temperatures: int
    statistic: float | None
    distribution: str
    critical: float | None  #: at ``size``
    p_value: float | None
    size: float  #: of the test: how often it errs where nothing depends
    depends: bool | None  #: None, as the statistic: there is no sure trace of what could depend
    common: Coefficient | None = None  #: to all temperatures, were it one value; None for what is no coefficient


def heterogeneity(values: Floats, sigmas: Floats, size: float = 0.05) -> Dependence | None:
    """Test whether estimates with normal errors are one value; None for fewer than two.

    Args:
        values: (k,)
        sigmas: (k,) standard errors.
        size: of the test.
    """
    if values.size < 2:  # noqa: PLR2004 - nothing to compare
        return None
    weight = 1 / sigmas**2
    statistic = float(weight @ (values - weight @ values / weight.sum()) ** 2)
    return by_chi_square(values.size, statistic, size)


def depends(
    points: Sequence[SetPoint], letter: str, pooled: Coefficient | None = None, *, size: float = 0.05
) -> Dependence | None:
    """Test whether a coefficient is the same at all temperatures; None where there is one temperature.

    Args:
        points: one of each temperature.
        letter: Q, N, B or K.
        pooled: what all temperatures together say of it; without a value there is nothing to test. None: not asked.
        size: of the test.
    """
    if len(points) < 2:  # noqa: PLR2004 - nothing to compare
        return None
    if pooled is not None and pooled.value is None:
        text = "no sure trace of it at all temperatures together"
        return Dependence(len(points), None, text, None, None, size, None, pooled)
    common, slope, information = _common(points, list(TERMS).index(letter))
    if common <= 0:
        return None
    total = float(information.sum())
    found = pooled or Coefficient(common**0.5, *interval(common, total**-0.5, LEVEL), at=READ_OUT[letter])
    away = slope / np.sqrt(information)
    statistic = float(away @ away - (away @ np.sqrt(information)) ** 2 / total)
    freedom = 2 * common**2 * information
    if freedom.min() > SURE:
        return by_chi_square(len(points), statistic, size, found)
    drawn = _drawn(freedom, information)
    p_value = float((1 + np.count_nonzero(drawn >= statistic)) / (1 + DRAWS))
    critical = float(np.quantile(drawn, 1 - size))
    text = f"drawn from scaled chi-squares of {freedom.min():.3g} to {freedom.max():.3g} degrees of freedom"
    return Dependence(len(points), statistic, text, critical, p_value, size, p_value < size, found)


def by_chi_square(count: int, statistic: float, size: float, common: Coefficient | None = None) -> Dependence:
    """Return the test of a statistic that is chi-square of ``count`` - 1 degrees of freedom where nothing depends on temperature."""
    p_value = float(chi_square_tail(statistic, count - 1))
    critical = float(chi_square_quantile(1 - size, count - 1))
    return Dependence(count, statistic, f"chi-square({count - 1})", critical, p_value, size, p_value < size, common)


def _drawn(freedom: Floats, information: Floats) -> Floats:
    """Return the statistic of many sets of scaled chi-squares about one value."""
    rng = np.random.default_rng(SEED)
    away = (rng.chisquare(freedom, (DRAWS, freedom.size)) / freedom - 1) * np.sqrt(freedom / 2)
    return np.sum(away**2, axis=1) - (away @ np.sqrt(information)) ** 2 / information.sum()


def _common(points: Sequence[SetPoint], term: int) -> tuple[float, Floats, Floats]:
    """Return the square that suits all temperatures best, and each one's slope and information there; 0: it has none."""
    sizes = np.array([_squares(point)[term] for point in points])
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
    found = np.array([_score(point, _squares(point), term, square) for point in points])
    return found[:, 0], found[:, 1]


def _squares(point: SetPoint) -> Floats:
    return np.array([(point.coefficients[letter].value or 0.0) ** 2 for letter in TERMS])


def _score(point: SetPoint, start: Floats, term: int, held: float) -> tuple[float, float]:
    """Return the slope of the log likelihood by a term's square, the others at their likeliest, and its information."""
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
