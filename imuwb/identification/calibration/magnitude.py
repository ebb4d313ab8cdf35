"""Calibration of accelerometers from positions of unknown attitudes.

The specific force on a still sensor has the magnitude of gravity in every attitude.

Without known attitudes the frame of the case is not observable. The frame of the result has its x axis along the x
accelerometer, and its y axis in the plane of the x and y accelerometers. In this frame measured = A force + b with a lower
triangular A: three scale factors and three cross-couplings (x into y, x and y into z). The estimated parameters make
|A⁻¹ (measured - b)| = g.
"""

from collections.abc import Sequence

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.calibration.axis_calibration import AxisCalibration
from imuwb.identification.calibration.least_squares import LinearFit, RowNoise, fit_linear, is_determined
from imuwb.identification.calibration.means import Means, along
from imuwb.identification.calibration.positions import PositionCalibration
from imuwb.statistics import Estimate

FEWEST = 9  #: positions: one for each parameter
CLOSE = 1e-12  #: relative change of the parameters at which the iteration ends
MOST_TURNS = 60  #: largest number of iterations
#: ratio of smallest to largest singular value of the design, below which the positions are too close to each other
WEAKEST = 0.02
_LOWER = np.tril_indices(3)


def without_attitudes(
    means: Means, gravity: float, level: float, *, raw: bool = False, samples: Sequence[Floats] = ()
) -> PositionCalibration:
    """Return bias, scale factors and the three observable cross-couplings.

    Args:
        means: means of the accelerometers in P positions, at least 9, spread over all directions.
        gravity: m/s².
        level: confidence level of the intervals.
        raw: whether the means are in counts or volts.
        samples: the samples of each position, (n, 3), which separate the sway of a hand from noise; empty: the noise that ``means`` states.

    Raises:
        ValueError: too few positions, or positions that do not determine the parameters.
    """
    if len(means.value) < FEWEST:
        raise ValueError(
            f"{len(means.value)} positions; without known attitudes there are nine parameters, which need {FEWEST} positions or more"
        )
    matrix, bias = _start(means.value, gravity, raw=raw)
    matrix, bias, fit = _fitted(means, matrix, bias, gravity)
    if samples:
        means = along(samples, _linearised(means, matrix, bias, gravity)[0][:, :3], means)
        matrix, bias, fit = _fitted(means, matrix, bias, gravity)
    force: Floats = np.asarray(np.linalg.solve(matrix, (means.value - bias).T).T, dtype=np.float64)
    return _result(means, fit, matrix, bias, force, gravity, level)


def _fitted(means: Means, matrix: Floats, bias: Floats, gravity: float) -> tuple[Floats, Floats, LinearFit]:
    """Return gains and bias that make the magnitude that of gravity, and the fit of their last change."""
    for _ in range(MOST_TURNS):
        design, y, variance = _linearised(means, matrix, bias, gravity)
        if not _spread(design):
            raise ValueError(
                "the positions point in too few directions to determine nine parameters; "
                "turn the sensor so that each axis points up, down and obliquely"
            )
        freedom = np.full(len(y), float(means.freedom.sum()))
        noise = RowNoise(variance, np.zeros(len(y), dtype=np.int64), freedom)
        fit = fit_linear(design, y, noise, np.ones(len(y)), always=False)
        matrix, bias, change = _moved(matrix, bias, fit.value, gravity)
        if change < CLOSE:
            return matrix, bias, fit
    raise ValueError(
        "no parameters give the magnitude of gravity in every position; check that the sensor is still in each and that the unit is right"
    )


def _start(value: Floats, gravity: float, *, raw: bool) -> tuple[Floats, Floats]:
    """Return a first gain matrix and bias: 1 and 0 in SI, from the extreme readings in counts or volts."""
    if not raw:
        return np.eye(3), np.zeros(3)
    low, high = value.min(axis=0), value.max(axis=0)
    return np.diag((high - low) / (2 * gravity)), (high + low) / 2


def _linearised(means: Means, matrix: Floats, bias: Floats, gravity: float) -> tuple[Floats, Floats, Floats]:
    """Return the design, (P, 9): bias, then A by rows; gravity minus the norm of the force, (P,); its variance, (P,)."""
    inverse = np.linalg.inv(matrix)
    force = (means.value - bias) @ inverse.T
    size = np.linalg.norm(force, axis=1)
    along = force / size[:, None] @ inverse  # change of |force| with each reading
    slope = np.concatenate([along, along[:, _LOWER[0]] * force[:, _LOWER[1]]], axis=1)
    return slope, size - gravity, (along**2 * means.variance).sum(axis=1)


def _spread(design: Floats) -> bool:
    if not np.isfinite(design).all() or not is_determined(design):
        return False
    singular = np.linalg.svd(design / np.linalg.norm(design, axis=0), compute_uv=False)
    return bool(singular[-1] > WEAKEST * singular[0])


def _moved(matrix: Floats, bias: Floats, change: Floats, gravity: float) -> tuple[Floats, Floats, float]:
    step = np.zeros((3, 3))
    step[_LOWER] = change[3:]
    size = float(np.abs(np.diag(matrix)).max())
    relative = max(float(np.abs(step).max()) / size, float(np.abs(change[:3]).max()) / (size * gravity))
    return matrix + step, bias + change[:3], relative


def _result(
    means: Means, fit: LinearFit, matrix: Floats, bias: Floats, force: Floats, gravity: float, level: float
) -> PositionCalibration:
    at = {(int(i), int(j)): 3 + k for k, (i, j) in enumerate(zip(*_LOWER, strict=True))}

    def estimate(place: int, value: float) -> Estimate:
        e = fit.estimate(place, level)  # of the last change, near 0; its interval is that of the parameter
        half = (e.upper - e.lower) / 2
        return Estimate(value, value - half, value + half, e.sigma)

    axes = tuple(
        AxisCalibration(
            estimate(i, float(bias[i])),
            estimate(at[i, i], float(matrix[i, i]) - 1),
            None,
            tuple(estimate(at[i, j], float(matrix[i, j])) if (i, j) in at else None for j in range(3) if j != i),  # type: ignore[arg-type]
        )
        for i in range(3)
    )
    size = np.linalg.norm(force, axis=1, keepdims=True)
    true = force / size * gravity
    residual = means.value - bias - true @ matrix.T
    free = np.array([0, 1, 2, *(3 + 3 * _LOWER[0] + _LOWER[1])])
    covariance = np.zeros((12, 12))
    covariance[np.ix_(free, free)] = fit.covariance
    sigma = np.sqrt(means.variance)
    return PositionCalibration(axes, true, residual, sigma, None, fit.extra_freedom, fit.probability, covariance)  # type: ignore[arg-type]
