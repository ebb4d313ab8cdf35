"""Gyros from still positions: bias and g-sensitivity; scale factors need a rate table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from imuwb.identification.calibration.estimate import AxisCalibration, Estimate, estimate
from imuwb.identification.calibration.least_squares import fit_linear, is_determined
from imuwb.identification.calibration.positions import noise_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from imuwb.identification.calibration.means import Means

    Floats = NDArray[np.float64]

EARTH_RATE = 7.292_115e-5  #: rad/s (WGS 84)
MIDDLE = 0.5**0.5  #: sine and cosine of a latitude that is not known


def static_gyros(
    means: Means, force: Floats, gravity: float, level: float, latitude: float | None
) -> tuple[tuple[AxisCalibration, AxisCalibration, AxisCalibration], Floats]:
    """Return bias and g-sensitivity of the gyros, and the residuals of their means, (P, 3).

    The vertical part of the earth's rate looks like a g-sensitivity of an axis to its own force, and is taken off with the
    latitude; without it, it widens those intervals as at 45°. Its horizontal part depends on headings, which are taken to be
    random. What else changes from position to position, such as the bias with time, the residuals tell.

    Args:
        means: of the gyros, P positions.
        force: (P, 3) m/s², true.
        gravity: m/s².
        level: of the intervals.
        latitude: rad; None: not known.

    Raises:
        ValueError: fewer than four attitudes that differ.
    """
    design = np.concatenate([np.ones((len(force), 1)), force / gravity], axis=1)
    if not is_determined(design):
        message = f"{len(force)} positions leave bias and g-sensitivity of the gyros open; they take four that differ"
        raise ValueError(message)
    up = force / gravity
    vertical = 0.0 if latitude is None else EARTH_RATE * float(np.sin(latitude))
    y = means.value - vertical * up
    positions = len(force)
    whole = np.zeros((3 * positions, 12))
    for axis in range(3):
        whole[axis * positions : (axis + 1) * positions, 4 * axis : 4 * axis + 4] = design
    across = EARTH_RATE * (MIDDLE if latitude is None else float(np.cos(latitude)))
    heading = across**2 / 2 * np.clip(1 - up**2, 0.0, 1.0)
    fit = fit_linear(whole, y.T.ravel(), noise_of(means, heading.T.ravel()), np.ones(3 * positions), always=False)
    unknown = (EARTH_RATE * MIDDLE / gravity) ** 2 if latitude is None else 0.0

    def sensitivity(axis: int, other: int) -> Estimate:
        e = fit.estimate(4 * axis + 1 + other, level, 1 / gravity)
        if other != axis or not unknown:
            return e
        return estimate(e.value, e.sigma**2 + unknown, float(fit.freedom[4 * axis + 1 + other]), level)

    axes = tuple(
        AxisCalibration(
            fit.estimate(4 * i, level),
            None,
            g_sensitivity=(sensitivity(i, 0), sensitivity(i, 1), sensitivity(i, 2)),
        )
        for i in range(3)
    )
    return axes, fit.residual.reshape(3, positions).T  # type: ignore[return-value]
