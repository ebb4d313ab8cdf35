"""Accelerometers from positions whose attitudes are known: bias, scale factors and cross-couplings by least squares.

What does not stand as it is said to stand, a cube's face or a hand, tilts gravity into the level axes; residuals tell by how
much, so that cross-couplings have intervals that know of it. The upright axis feels it to second order, which is allowed for.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.calibration.estimate import AxisCalibration, Estimate, estimate
from imuwb.identification.calibration.faces import faces
from imuwb.identification.calibration.least_squares import LinearFit, Noise, fit_linear, is_determined

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from imuwb.identification.calibration.means import Means

    Floats = NDArray[np.float64]

BENT = 0.05  #: of the non-linear column that the others must leave over
#: times the fourth power of the tilt: the variance of what an upright part lacks. 2 were enough if the tilt were known and
#: its square not skewed; coverage with faces 0.5° off takes more (tests/studies/calibration.md)
SHORTENED = 6.0


@dataclass(frozen=True, eq=False, slots=True)
class PositionCalibration:
    """Accelerometers from P positions."""

    axes: tuple[AxisCalibration, AxisCalibration, AxisCalibration]
    force: Floats  #: (P, 3) m/s², true, as the attitudes have it or as the fit finds it
    residual: Floats  #: (P, 3) mean less what the parameters make of the force, in the unit of the samples
    sigma: Floats  #: (P, 3) of the means' noise, likewise
    misplacement: float | None  #: rad, rms of each of two tilts of a position; None: not told
    freedom: float  #: rows beyond the parameters
    probability: float  #: of residuals as large as these by noise alone
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class PrintedCalibration:
    """One axis by Hassaballa's eq. 3 to 6, from two means alone."""

    up: float  #: mean with the axis up
    down: float
    bias: Estimate  #: eq. 5
    scale_factor: Estimate  #: eq. 6


def as_printed(
    means: Means, standing: Sequence[tuple[int, int]], gravity: float, level: float
) -> tuple[PrintedCalibration, ...]:
    """Return bias and scale factor of each axis from its up and its down alone (Hassaballa, eq. 3 to 6)."""
    found: list[PrintedCalibration] = []
    for axis in range(3):
        ends: list[tuple[float, float]] = []
        for sign in (1, -1):
            rows = [p for p, face in enumerate(standing) if face == (axis, sign)]
            ends.append(
                (float(means.value[rows, axis].mean()), float(means.variance[rows, axis].sum()) / len(rows) ** 2)
            )
        (up, up_variance), (down, down_variance) = ends
        variance, freedom = (up_variance + down_variance) / 4, float(means.freedom[axis])
        bias = estimate((up + down) / 2, variance, freedom, level)
        scale = estimate((up - down - 2 * gravity) / (2 * gravity), variance / gravity**2, freedom, level)
        found.append(PrintedCalibration(up, down, bias, scale))
    return tuple(found)


def six_position(
    means: Means,
    names: Sequence[str],
    gravity: float,
    level: float,
    *,
    raw: bool = False,
    misplacement: float | None = None,
) -> tuple[PositionCalibration, tuple[tuple[int, int], ...]]:
    """Return bias, scale factor and all cross-couplings from the six faces of a cube, and which face each position is.

    Args:
        means: of the accelerometers, P positions, each face at least once, in any order.
        names: of the positions.
        gravity: m/s².
        level: of the intervals.
        raw: in counts or volts.
        misplacement: rad, rms tilt of a face; None: from the residuals.

    Raises:
        ValueError: faces that are missing, or a position on none.
    """
    standing = tuple(faces(means.value, names, raw=raw))
    force = np.zeros_like(means.value)
    for row, (axis, sign) in zip(force, standing, strict=True):
        row[axis] = sign * gravity
    return known_attitudes(means, force, level, misplacement=misplacement), standing


def known_attitudes(
    means: Means, force: Floats, level: float, *, full_range: float | None = None, misplacement: float | None = None
) -> PositionCalibration:
    """Return bias, scale factor and cross-couplings, and the non-linear scale factor where positions part it from the linear.

    Args:
        means: of the accelerometers.
        force: (P, 3) m/s², true.
        level: of the intervals.
        full_range: m/s², of which the non-linear part is a share; None: it is left out.
        misplacement: rad, rms tilt of a position; None: from the residuals.

    Raises:
        ValueError: the positions leave parameters open.
    """
    designs = [_design(force, axis, full_range) for axis in range(3)]
    linear = [d[:, :4] for d in designs]
    if not is_determined(linear[0]):
        message = "these positions leave parameters open; each axis needs to point up, down and across"
        raise ValueError(message)
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
    if tilt:  # Tilted by two angles of that rms, the upright part is shorter by its square in the mean, and scatters by as much.
        fit = fitted(tilt**2)
    axes = tuple(_axis(fit, axis * columns, bent, level) for axis in range(3))
    residual = fit.residual.reshape(3, positions).T
    return PositionCalibration(axes, force, residual, np.sqrt(means.variance), tilt, fit.extra_freedom, fit.probability)  # type: ignore[arg-type]


def noise_of(means: Means, known: Floats | float = 0.0) -> Noise:
    """Return the noise of means, axis by axis, besides a variance that is known."""
    positions = len(means.value)
    variance = means.variance.T.ravel()
    source = np.repeat(np.arange(3), positions)
    # What is known adds no doubt: a sum's degrees of freedom, by Satterthwaite.
    share = variance / np.maximum(variance + known, np.finfo(float).tiny)
    return Noise(variance + known, source, np.repeat(means.freedom, positions) / np.maximum(share, 1e-3) ** 2)


def _design(force: Floats, axis: int, full_range: float | None) -> Floats:
    others = [k for k in range(3) if k != axis]
    columns = [np.ones(len(force)), force[:, axis], force[:, others[0]], force[:, others[1]]]
    if full_range is not None:
        columns.append(force[:, axis] * np.abs(force[:, axis]) / full_range)
    return np.stack(columns, axis=1)


def _bends(design: Floats) -> bool:
    """Return whether the last column is well apart from the others, with rows to spare."""
    if len(design) <= design.shape[1]:
        return False
    last = design[:, -1]
    left = last - design[:, :-1] @ np.linalg.lstsq(design[:, :-1], last, rcond=None)[0]
    return float(np.linalg.norm(left)) > BENT * float(np.linalg.norm(last))


def _gain(means: Means, force: Floats) -> Floats:
    """Return about how much each axis shows of a force, (3,), in the unit of the samples."""
    centered, moved = means.value - means.value.mean(axis=0), force - force.mean(axis=0)
    return np.linalg.norm(centered, axis=0) / np.linalg.norm(moved, axis=0)


def _tilted(force: Floats, gain: Floats) -> Floats:
    """Return the variance that tilts of 1 rad rms give each mean, (P, 3)."""
    size = (force**2).sum(axis=1, keepdims=True)
    level = np.maximum(size - force**2, 0.0)
    level[level < 1e-9 * size.max()] = 0.0
    return gain**2 * level


def _axis(fit: LinearFit, first: int, bent: bool, level: float) -> AxisCalibration:  # noqa: FBT001 - a column, there or not
    gain = fit.estimate(first + 1, level)
    scale = Estimate(gain.value - 1, gain.sigma, gain.lower - 1, gain.upper - 1)
    cross = (fit.estimate(first + 2, level), fit.estimate(first + 3, level))
    return AxisCalibration(fit.estimate(first, level), scale, fit.estimate(first + 4, level) if bent else None, cross)
