"""Gyros from still positions: bias and g-sensitivity. Scale factors need a rate table."""

import numpy as np

from imuwb.arrays import Floats
from imuwb.geodesy.earth import EARTH_RATE
from imuwb.identification.calibration.axis_calibration import AxisCalibration, student_estimate
from imuwb.identification.calibration.least_squares import LinearFit, fit_linear, is_determined
from imuwb.identification.calibration.means import Means
from imuwb.identification.calibration.positions import noise_of
from imuwb.statistics import Estimate

MIDDLE = 0.5**0.5  #: sine and cosine of 45°, for a latitude that is not known


def static_gyros(
    means: Means, force: Floats, gravity: float, level: float, latitude: float | None
) -> tuple[tuple[AxisCalibration, AxisCalibration, AxisCalibration], Floats]:
    """Return bias and g-sensitivity of the gyros, and the residuals of their means, (P, 3).

    The vertical part of the earth's rate looks like the g-sensitivity of an axis to its own specific force. It is subtracted if
    the latitude is known; if not, it widens the intervals of these g-sensitivities, as at a latitude of 45°. The horizontal part
    depends on the headings, which are assumed to be random. Other changes between positions, such as a drift of the bias, are
    estimated from the residuals.

    Args:
        means: means of the gyros in P positions.
        force: (P, 3) m/s², true specific force.
        gravity: m/s².
        level: confidence level of the intervals.
        latitude: rad; None: not known.

    Raises:
        ValueError: fewer than four different attitudes.
    """
    fit = static_fit(means, force / gravity, latitude)
    unknown = (EARTH_RATE * MIDDLE / gravity) ** 2 if latitude is None else 0.0
    x, y, z = (_axis(fit, axis, gravity, level, unknown) for axis in range(3))
    return (x, y, z), fit.residual.reshape(3, len(force)).T


def static_fit(means: Means, up: Floats, latitude: float | None) -> LinearFit:
    """Return the fit of bias and sensitivity to up, (x, y, z), of each gyro in turn: 12 parameters.

    Args:
        means: means of the gyros in P positions.
        up: (P, 3) direction of up in the frame of the result.
        latitude: rad; None: not known.

    Raises:
        ValueError: fewer than four different attitudes.
    """
    positions = len(up)
    design = np.concatenate([np.ones((positions, 1)), up], axis=1)
    if not is_determined(design):
        raise ValueError(
            f"{positions} positions do not determine bias and g-sensitivity of the gyros; at least four different attitudes do"
        )
    vertical = 0.0 if latitude is None else EARTH_RATE * float(np.sin(latitude))
    across = EARTH_RATE * (MIDDLE if latitude is None else float(np.cos(latitude)))
    headings = across**2 / 2 * np.clip(1 - up**2, 0.0, 1.0)
    whole = np.zeros((3 * positions, 12))
    for axis in range(3):
        whole[axis * positions : (axis + 1) * positions, 4 * axis : 4 * axis + 4] = design
    y = (means.value - vertical * up).T.ravel()
    return fit_linear(whole, y, noise_of(means, headings.T.ravel()), np.ones(3 * positions), always=False)


def _axis(fit: LinearFit, axis: int, gravity: float, level: float, unknown: float) -> AxisCalibration:
    """Return one axis of the fit; ``unknown`` is the variance of the earth's vertical rate as a g-sensitivity."""

    def sensitivity(other: int) -> Estimate:
        place = 4 * axis + 1 + other
        more = unknown if other == axis else 0.0
        variance = float(fit.covariance[place, place]) / gravity**2 + more
        return student_estimate(float(fit.value[place]) / gravity, variance, float(fit.freedom[place]), level)

    return AxisCalibration(
        fit.estimate(4 * axis, level), None, g_sensitivity=(sensitivity(0), sensitivity(1), sensitivity(2))
    )
