"""Calibration of accelerometers from positions of known attitudes: bias, scale factors and cross-couplings by least squares.

A position that is not exactly at its stated attitude tilts gravity into the horizontal axes. The size of these tilts is
estimated from the residuals and widens the intervals of the cross-couplings. The vertical axis is shortened by their square.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.arrays import Floats
from imuwb.identification.calibration.axis_calibration import AxisCalibration
from imuwb.identification.calibration.faces import faces
from imuwb.identification.calibration.least_squares import LinearFit, RowNoise, fit_linear, is_determined
from imuwb.identification.calibration.means import Means

BENT = 0.05  #: least share of the non-linear column's length that remains when the other columns are projected out
#: variance of the vertical part's shortening, over the fourth power of the tilt. The factor is 2 for a known tilt and a
#: symmetric distribution; coverage with faces 0.5° off needs more (tests/studies/calibration.md).
SHORTENED = 6.0


@dataclass(frozen=True, eq=False, slots=True)
class PositionCalibration:
    """The calibration of the accelerometers from P positions."""

    axes: tuple[AxisCalibration, AxisCalibration, AxisCalibration]
    force: Floats  #: (P, 3) m/s², true specific force, from the attitudes or from the fit
    residual: Floats  #: (P, 3) mean minus the fit's value, in the unit of the samples
    sigma: Floats  #: (P, 3) standard deviation of the means' noise, in the unit of the samples
    misplacement: float | None  #: rad, rms of each of a position's two tilts; None: not estimated
    freedom: float  #: number of rows minus number of parameters
    probability: float  #: probability that noise alone makes residuals as large as these
    #: (12, 12) covariance of the three biases and of the gains by rows, in the unit of the samples; None: attitudes are given
    covariance: Floats | None = None

    def __repr__(self) -> str:
        """Return one line for each axis."""
        return "\n".join(f"accel {k}: {axis}" for k, axis in zip("xyz", self.axes, strict=True))


def six_position(
    means: Means,
    names: Sequence[str],
    gravity: float,
    level: float,
    *,
    raw: bool = False,
    misplacement: float | None = None,
) -> tuple[PositionCalibration, tuple[tuple[int, int], ...]]:
    """Return bias, scale factor and all cross-couplings from the six faces of a cube, and the face of each position.

    Args:
        means: means of the accelerometers in P positions, each face at least once, in any order.
        names: names of the positions.
        gravity: m/s².
        level: confidence level of the intervals.
        raw: whether the means are in counts or volts.
        misplacement: rad, rms tilt of a face; None: estimated from the residuals.

    Raises:
        ValueError: a face is missing, or a position is on none.
    """
    standing = tuple(faces(means.value, names, raw=raw))
    force = np.zeros_like(means.value)
    for row, (axis, sign) in zip(force, standing, strict=True):
        row[axis] = sign * gravity
    return known_attitudes(means, force, level, misplacement=misplacement), standing


def known_attitudes(
    means: Means, force: Floats, level: float, *, full_range: float | None = None, misplacement: float | None = None
) -> PositionCalibration:
    """Return bias, scale factor, cross-couplings and, if the positions determine it, the non-linear scale factor.

    Args:
        means: means of the accelerometers.
        force: (P, 3) m/s², true specific force.
        level: confidence level of the intervals.
        full_range: m/s², range that defines the non-linear part; None: no non-linear part.
        misplacement: rad, rms tilt of a position; None: estimated from the residuals.

    Raises:
        ValueError: the positions do not determine the parameters.
    """
    designs = [_design(force, axis, full_range) for axis in range(3)]
    linear = [d[:, :4] for d in designs]
    if not is_determined(linear[0]):
        raise ValueError(
            "the positions do not determine the parameters; each axis needs to point up, down and horizontally"
        )
    bent = full_range is not None and all(_bends(d) for d in designs)
    used = designs if bent else linear
    positions, columns = len(force), used[0].shape[1]
    design = np.zeros((3 * positions, 3 * columns))
    for axis, part in enumerate(used):
        design[axis * positions : (axis + 1) * positions, axis * columns : (axis + 1) * columns] = part
    gain = _gain(means, force)
    across, along = _tilted(force, gain).T.ravel(), (gain * force).T.ravel()

    def fitted(shorter: float) -> LinearFit:
        known = SHORTENED * (shorter * along) ** 2 + (0.0 if misplacement is None else misplacement**2 * across)
        pattern = across if misplacement is None else None
        seen = design * np.tile(np.where(np.arange(columns) == 0, 1.0, 1 - shorter), 3)
        return fit_linear(seen, means.value.T.ravel(), noise_of(means, known), pattern, always=True)

    fit = fitted(0.0)
    tilt = fit.extra**0.5 if misplacement is None and fit.extra_freedom else misplacement
    # Two tilts of that rms shorten the vertical part by the square of the rms on average; the shortening scatters as much.
    if tilt:
        fit = fitted(tilt**2)
    axes = tuple(_axis(fit, axis * columns, bent, level) for axis in range(3))
    residual = fit.residual.reshape(3, positions).T
    return PositionCalibration(axes, force, residual, np.sqrt(means.variance), tilt, fit.extra_freedom, fit.probability)  # type: ignore[arg-type]


def noise_of(means: Means, known: Floats | float = 0.0) -> RowNoise:
    """Return the noise of means, axis by axis, plus a variance that is known exactly."""
    positions = len(means.value)
    variance = means.variance.T.ravel()
    source = np.repeat(np.arange(3), positions)
    # The known variance has no uncertainty: degrees of freedom of the sum by Satterthwaite.
    share = variance / np.maximum(variance + known, np.finfo(float).tiny)
    return RowNoise(variance + known, source, np.repeat(means.freedom, positions) / np.maximum(share, 1e-3) ** 2)


def _design(force: Floats, axis: int, full_range: float | None) -> Floats:
    others = [k for k in range(3) if k != axis]
    columns = [np.ones(len(force)), force[:, axis], force[:, others[0]], force[:, others[1]]]
    if full_range is not None:
        columns.append(force[:, axis] * np.abs(force[:, axis]) / full_range)
    return np.stack(columns, axis=1)


def _bends(design: Floats) -> bool:
    """Return whether the last column is well separated from the others, and there are more rows than columns."""
    if len(design) <= design.shape[1]:
        return False
    last = design[:, -1]
    left = last - design[:, :-1] @ np.linalg.lstsq(design[:, :-1], last, rcond=None)[0]
    return float(np.linalg.norm(left)) > BENT * float(np.linalg.norm(last))


def _gain(means: Means, force: Floats) -> Floats:
    """Return the approximate gain of each axis, (3,), in the unit of the samples per m/s²."""
    centered, moved = means.value - means.value.mean(axis=0), force - force.mean(axis=0)
    return np.linalg.norm(centered, axis=0) / np.linalg.norm(moved, axis=0)


def _tilted(force: Floats, gain: Floats) -> Floats:
    """Return the variance of each mean that tilts of 1 rad rms cause, (P, 3)."""
    size = (force**2).sum(axis=1, keepdims=True)
    level = np.maximum(size - force**2, 0.0)
    level[level < 1e-9 * size.max()] = 0.0
    return gain**2 * level


def _axis(fit: LinearFit, first: int, bent: bool, level: float) -> AxisCalibration:  # noqa: FBT001 - whether a column is there
    scale = fit.estimate(first + 1, level).shifted(-1.0)
    cross = (fit.estimate(first + 2, level), fit.estimate(first + 3, level))
    return AxisCalibration(fit.estimate(first, level), scale, fit.estimate(first + 4, level) if bent else None, cross)
