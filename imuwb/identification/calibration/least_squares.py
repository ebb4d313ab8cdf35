"""Least squares with two sources of error: the known noise of each row, and an extra error estimated from the residuals."""

from dataclasses import dataclass

import numpy as np
from scipy import optimize, special

from imuwb.arrays import Floats, Integers
from imuwb.identification.calibration.axis_calibration import student_estimate
from imuwb.statistics import Estimate

CHANCE = 0.2  #: probability of the residuals below which an extra error is estimated; a smaller limit costs coverage
WEAK = 1e-7  #: ratio of smallest to largest singular value, below which a design with columns of length 1 is singular
RANGE = 12.0  #: decades below the variance of the residuals, in which the extra variance is searched


@dataclass(frozen=True, eq=False, slots=True)
class LinearFit:
    """The parameters of y = X p + noise + extra error."""

    value: Floats  #: (m,)
    covariance: Floats  #: (m, m)
    freedom: Floats  #: (m,) degrees of freedom of each parameter's variance
    residual: Floats  #: (n,)
    extra: float  #: variance of the extra error in a row whose pattern is 1
    extra_freedom: float  #: number of rows minus number of parameters
    probability: float  #: probability that noise alone makes residuals as large as these

    def estimate(self, place: int, level: float, factor: float = 1.0) -> Estimate:
        """Return the parameter number ``place`` times a factor, with its interval."""
        variance = float(self.covariance[place, place])
        return student_estimate(
            factor * float(self.value[place]), factor**2 * variance, float(self.freedom[place]), level
        )


def is_determined(design: Floats) -> bool:
    """Return whether the columns of a design, (n, m), are linearly independent."""
    if len(design) < design.shape[1]:
        return False
    size = np.linalg.norm(design, axis=0)
    if not (size > 0).all():
        return False
    singular = np.linalg.svd(design / size, compute_uv=False)
    return bool(singular[-1] > WEAK * singular[0])


@dataclass(frozen=True, eq=False, slots=True)
class RowNoise:
    """The variances of n rows, and how well they are known."""

    variance: Floats  #: (n,)
    source: Integers  #: (n,) rows with the same number share one estimate of the variance
    freedom: Floats  #: (n,) degrees of freedom of that estimate


def fit_linear(design: Floats, y: Floats, noise: RowNoise, pattern: Floats | None, *, always: bool) -> LinearFit:
    """Return the weighted least-squares fit.

    Row i has the variance ``noise.variance[i] + extra * pattern[i]``. The extra variance maximises the restricted likelihood.
    Degrees of freedom are Satterthwaite's approximation for the sum of both variances.

    Args:
        design: (n, m).
        y: (n,).
        noise: variances of the rows.
        pattern: (n,) relative size of the extra variance in each row, 0 or more; None: no extra error.
        always: estimate the extra error even if the residuals are no larger than the noise.

    Raises:
        ValueError: the rows do not determine the parameters.
    """
    if not is_determined(design):
        raise ValueError(f"{design.shape[1]} parameters are not determined by {len(design)} rows")
    variance = np.maximum(noise.variance, np.finfo(float).tiny * 1e20)
    rest = len(y) - design.shape[1]
    _, residual = _solved(design, y, variance)
    chance = float(special.chdtrc(rest, float((residual**2 / variance).sum()))) if rest else 1.0
    wanted = pattern is not None and rest > 0 and pattern.any() and (always or chance < CHANCE)
    extra = _restricted(design, y, variance, pattern) if wanted and pattern is not None else 0.0
    total = variance + (0.0 if pattern is None else extra * pattern)
    value, residual = _solved(design, y, total)
    covariance: Floats = np.asarray(np.linalg.inv(design.T @ (design / total[:, None])), dtype=np.float64)
    changing = _uncertainty(design, covariance, total, variance, noise)
    if wanted and pattern is not None:
        changing = changing + _extra_uncertainty(design, covariance, total, pattern)
    degrees = np.full(len(covariance), np.inf)  # infinite if both variances are known exactly
    np.divide(2 * np.diag(covariance) ** 2, changing, out=degrees, where=changing > 0)
    return LinearFit(value, covariance, np.clip(degrees, 1.0, 1e6), residual, extra, float(rest), chance)


def _solved(design: Floats, y: Floats, variance: Floats) -> tuple[Floats, Floats]:
    """Return the weighted least-squares parameters and the residuals."""
    root = np.sqrt(variance)
    value: Floats = np.asarray(np.linalg.lstsq(design / root[:, None], y / root, rcond=None)[0], dtype=np.float64)
    return value, y - design @ value


def _restricted(design: Floats, y: Floats, variance: Floats, pattern: Floats) -> float:
    """Return the extra variance that maximises the restricted likelihood (REML)."""
    _, residual = _solved(design, y, np.ones_like(y))
    top = float((residual**2).sum()) / max(float(pattern.mean()), 1e-12) + float(variance.max())

    def cost(extra: float) -> float:
        total = variance + extra * pattern
        _, left = _solved(design, y, total)
        information = design.T @ (design / total[:, None])
        return float(np.log(total).sum() + np.linalg.slogdet(information)[1] + (left**2 / total).sum())

    def cost_at(decade: float) -> float:
        return cost(top * 10**decade)

    decade = optimize.minimize_scalar(cost_at, bounds=(-RANGE, 1.0), method="bounded", options={"xatol": 1e-4})
    best = top * 10 ** float(decade.x)
    return best if cost(best) < cost(0.0) else 0.0


def _uncertainty(design: Floats, covariance: Floats, total: Floats, variance: Floats, noise: RowNoise) -> Floats:
    """Return the variance of each parameter's variance that comes from the uncertain variance of the noise, (m,)."""
    effect = (covariance @ design.T / total) ** 2 * variance  # (m, n): effect of a relative change of a row's variance
    variances = np.zeros(len(covariance))
    for source in np.unique(noise.source):
        rows = noise.source == source
        variances += effect[:, rows].sum(axis=1) ** 2 * 2 / float(noise.freedom[rows].min())
    return variances


def _extra_uncertainty(design: Floats, covariance: Floats, total: Floats, pattern: Floats) -> Floats:
    """Return the variance of each parameter's variance that comes from the uncertain extra variance, (m,)."""
    inverse = np.diag(1 / total)
    project = inverse - inverse @ design @ covariance @ design.T @ inverse
    weighted = project * pattern
    information = float(np.trace(weighted @ weighted)) / 2
    effect = (covariance @ design.T / total) ** 2 @ pattern
    return effect**2 / max(information, np.finfo(float).tiny)
