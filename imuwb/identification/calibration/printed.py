"""Bias and scale factor of an accelerometer as Hassaballa prints them: from two means only, with the axis up and down."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from imuwb.identification.calibration.axis_calibration import student_estimate
from imuwb.identification.calibration.means import Means
from imuwb.identification.calibration.positions import SHORTENED, PositionCalibration
from imuwb.statistics import Estimate


@dataclass(frozen=True, slots=True)
class PrintedCalibration:
    """The calibration of one axis by Hassaballa's eq. 3 to 6, from two means only."""

    up: float  #: mean with the axis up
    down: float  #: mean with the axis down
    bias: Estimate  #: eq. 5
    scale_factor: Estimate  #: eq. 6


def as_printed(
    means: Means, standing: Sequence[tuple[int, int]], gravity: float, level: float, fit: PositionCalibration
) -> tuple[PrintedCalibration, ...]:
    """Return bias and scale factor of each axis from its up and down positions only (Hassaballa, eq. 3 to 6).

    The equations have no tilt. A tilt that was given or found is in the intervals: it shortens gravity along the axis by half its
    square, and gravity across the axis enters by the couplings.

    Args:
        means: means of the accelerometers.
        standing: axis and sign of each position.
        gravity: m/s².
        level: confidence level of the intervals.
        fit: calibration from all six faces: its tilt and its couplings.
    """
    tilt = fit.misplacement or 0.0
    calibrations: list[PrintedCalibration] = []
    for axis in range(3):
        ends: list[tuple[float, float, int]] = []
        for sign in (1, -1):
            rows = [p for p, face in enumerate(standing) if face == (axis, sign)]
            noise = float(means.variance[rows, axis].sum()) / len(rows) ** 2
            ends.append((float(means.value[rows, axis].mean()), noise, len(rows)))
        (up, up_noise, ups), (down, down_noise, downs) = ends
        size = (up - down) / 2  # gravity in the unit of the samples
        across = sum(0.0 if c is None else c.value**2 for c in fit.axes[axis].cross_coupling) * gravity**2
        each = SHORTENED * (size * tilt**2) ** 2 + across * tilt**2  # variance that the tilt of one position causes
        noise, tilted = (up_noise + down_noise) / 4, each * (1 / ups + 1 / downs) / 4
        total = noise + tilted
        freedom = float(means.freedom[axis]) * (total / noise) ** 2 if noise else np.inf
        bias = student_estimate((up + down) / 2, total, freedom, level)
        # On average both means are shorter by the square of the tilt.
        shorter = (size * tilt**2) ** 2
        scale = student_estimate(
            (up - down - 2 * gravity) / (2 * gravity), (total + shorter) / gravity**2, freedom, level
        )
        calibrations.append(PrintedCalibration(up, down, bias, scale))
    return tuple(calibrations)
